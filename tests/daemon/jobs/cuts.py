"""A disk that is cut off at any of its writes: everything that daemon.jobs writes goes through it, and is counted.

A kill leaves what was written. A power cut takes back what no fsync has made durable: the contents of files that were
not synced, and renames, removals and new folders since the last fsync of anything (a journaling file system orders
them). SQLite keeps what it has committed; that it does is tried in another way, by tearing its log.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import IO, Any

import pytest

from daemon.jobs.journal import Journal


class Cut(BaseException):
    """The process is no more: nothing catches this."""


class Disk:
    """cut_at: before the write of this number, from 0, the process ends; None: never."""

    def __init__(self, cut_at: int | None, monkeypatch: pytest.MonkeyPatch) -> None:
        self.cut_at, self.writes, self.dead = cut_at, 0, False
        self.names: list[str] = []
        self._undo: list[Callable[[], object]] = []
        self._unsynced: dict[str, Path] = {}
        for name in ("rename", "unlink", "mkdir", "open"):
            monkeypatch.setattr(Path, name, self._of(name, getattr(Path, name)))
        monkeypatch.setattr(os, "fsync", self._fsync)
        write = Journal._write
        monkeypatch.setattr(Journal, "_write", lambda *args: self._before("journal") or write(*args))

    def reach(self, name: str) -> None:
        """A moment that is none of the disk's, such as a byte to the machine."""
        self._before(name)

    def lose_what_is_not_durable(self) -> None:
        """The power is cut."""
        for path in self._unsynced.values():
            if path.exists():
                os.truncate(path, 0)
        for undo in reversed(self._undo):
            with suppress(FileNotFoundError):
                undo()

    def _before(self, name: str) -> None:
        if self.dead or self.writes == self.cut_at:
            self.dead = True
            raise Cut(name)
        self.writes += 1
        self.names.append(name)

    def _of(self, name: str, act: Callable[..., Any]) -> Callable[..., Any]:
        def watched(path: Path, *args: Any, **options: Any) -> Any:
            if name == "open" and "w" not in (args[0] if args else options.get("mode", "r")):
                return act(path, *args, **options)
            if name == "unlink" and not path.exists():
                return act(path, *args, **options)
            self._before(name)
            undo = self._undo_of(name, path, *args)
            done = act(path, *args, **options)
            self._undo.append(undo)
            return done

        return watched

    def _undo_of(self, name: str, path: Path, *args: Any) -> Callable[[], object]:
        if name == "rename":
            to = Path(args[0])
            before = to.read_bytes() if to.exists() else None
            self._unsynced.update({str(to): to} if self._unsynced.pop(str(path), None) else {})
            return lambda: (os.rename(to, path), before is not None and to.write_bytes(before))
        if name == "unlink":
            content = path.read_bytes()
            return lambda: path.write_bytes(content)
        if name == "mkdir":
            return lambda: shutil.rmtree(path)
        self._unsynced[str(path)] = path
        return lambda: os.unlink(path)

    def _fsync(self, file: int | IO[bytes]) -> None:
        self._before("fsync")
        number = file if isinstance(file, int) else file.fileno()
        self._unsynced.pop(os.readlink(f"/proc/self/fd/{number}"), None)
        self._undo.clear()
