"""What takes pictures from an inbox into jobs, and a power that goes at any change of a file while it does."""

from __future__ import annotations

import errno
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from daemon.config import Options, Settings, load_settings
from daemon.errors import DiskFull, DiskTrouble
from daemon.intake.rank import rank
from daemon.jobs.allotment import Allotment
from daemon.jobs.arrivals import Arrivals
from daemon.jobs.desk import Desk
from daemon.jobs.folder import JobFolders
from daemon.jobs.journal import Journal
from daemon.jobs.station import Station


class Intake:
    """An inbox, a state folder, and what takes pictures from the one to the other."""

    def __init__(
        self, root: Path, intake: str = "", *, free: Callable[[Path], int] = lambda folder: 10**12, pages: int = 1
    ) -> None:
        """pages: that each picture has."""
        self.inbox, file = root / "inbox", root / "linedrawd.toml"
        self.inbox.mkdir(exist_ok=True)
        file.write_text(f"[intake]\n{intake}\n")
        self.settings: Settings = load_settings(Options(config=file, state_dir=root), environment={"HOME": str(root)})
        self.journal = Journal(root / "journal.sqlite")
        self.folders = JobFolders(root / "jobs")
        order = self.settings.intake.order
        self.desk = Desk(
            self.journal,
            self.folders,
            say=_silent,
            show=_silent,
            rank=lambda name: rank(name, order),
        )
        self.station = Station(self.desk, "plotter", show=_silent, asks_for_sheets=False)
        self.allotment = Allotment(self.desk)
        self.arrivals = Arrivals(self.desk, self.settings, free=free, pages=lambda picture: pages)

    def take(self, name: str = "house.png", side: str | None = "house.toml") -> None:
        self.arrivals.take(self.inbox / name, self.inbox / side if side else None)

    def recover(self) -> None:
        self.arrivals.recover({"": self.inbox})
        self.desk.recover()

    def states(self) -> list[str]:
        return [job.state.value for job in self.journal.jobs()]


def _when_there_is_room(intake: Intake, take: Callable[[Intake], None]) -> None:
    """The daemon that has met the full disk goes on; nothing is left to its next start."""
    intake.arrivals.finish()
    if [path for path in intake.inbox.iterdir() if path.suffix != ".toml" and not path.name.startswith(".")]:
        take(intake)
    known = {job.id for job in intake.journal.jobs()}
    assert known == {path.name for path in intake.folders.root.iterdir()}


def _silent(*_: Any, **__: Any) -> None:
    pass


class Cut(BaseException):
    """The power goes."""


class Cuts:
    """Counts the changes of files and of the journal; the one that is set for it does not happen any more."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, *, other_disk: bool, full: bool = False) -> None:
        """other_disk: the inbox lies on another one than the jobs. full: only the disk is, for this one change."""
        self._left, self._full = -1, full
        rename = Path.rename

        def across(path: Path, target: Path) -> Path:
            if "inbox" in path.parts and "jobs" in Path(target).parts:
                raise OSError(errno.EXDEV, "Invalid cross-device link")
            return rename(path, target)

        monkeypatch.setattr(Path, "rename", self._counted(across if other_disk else rename))
        # What is taken away needs no room.
        for name in ("mkdir", "hardlink_to") if full else ("unlink", "mkdir", "hardlink_to"):
            monkeypatch.setattr(Path, name, self._counted(getattr(Path, name)))
        monkeypatch.setattr(os, "fsync", self._counted(lambda descriptor: None))
        for record in ("add", "adopt", "step"):
            monkeypatch.setattr(Journal, record, self._counted(getattr(Journal, record)))

    def _counted(self, work: Callable[..., Any]) -> Callable[..., Any]:
        def step(*args: Any, **options: Any) -> Any:
            if self._left == 0:
                if not self._full:
                    raise Cut
                self._left = -1
                # Of the journal: what it makes of a full disk.
                raise DiskFull("no room") if args and isinstance(args[0], Journal) else OSError(errno.ENOSPC, "no room")
            self._left -= 1
            return work(*args, **options)

        return step

    def everywhere(
        self,
        tmp_path: Path,
        before: Callable[[Path], Intake],
        take: Callable[[Intake], None],
        after: Callable[[Path], None],
        *,
        changes: range,
    ) -> None:
        """Cut at the first change of `take`, at the second, and so on to its end; each time in a new root.

        after: what has to be true of the root then. changes: how many of them there may be.
        """
        for steps in range(changes.stop):
            root = tmp_path / str(steps)
            root.mkdir()
            intake = before(root)
            self._left = steps
            try:
                take(intake)
            except (Cut, DiskTrouble):
                finished = False
            else:
                finished = self._left >= 0
            self._left = -1
            if self._full:
                _when_there_is_room(intake, take)
            intake.journal.close()
            after(root)
            if finished:
                assert steps in changes
                return
        pytest.fail("it never came to its end")
