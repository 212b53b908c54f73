"""The inbox: a folder where pictures are dropped; each is claimed once it has stopped growing."""

from __future__ import annotations

import contextlib
import errno
import fnmatch
import os
import stat
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from watchdog.events import FileClosedEvent, FileMovedEvent, FileSystemEvent, FileSystemEventHandler
from watchdog.observers import Observer

from daemon.errors import DiskTrouble

IGNORED = (".*", "*.part", "*.tmp", "*.crdownload", "*.filepart", "*~")
NEXT = "NEXT"
"""A file of this name says: a new sheet is in."""
RESCAN_S = 120.0
"""Events can be lost: another host writes on a network folder, or the kernel's queue overflows."""
UNCLOSED_FACTOR = 3.0
"""A file of which nobody has said that it was closed settles this many times longer."""
RETRY_S = 10.0
"""After a full or read-only disk."""


@dataclass(frozen=True, slots=True)
class Seen:
    """A file as it was last looked at, and since when it has looked like that."""

    size: int
    changed_ns: int
    since_s: float


class Inbox:
    """What lies in the folder and has not been claimed. `step` looks once; no thread, no clock of its own.

    claim: takes the picture away; raises DiskTrouble when it cannot, the picture is then tried again.
    refuse: told once, with a sentence, about each file that is never claimed.
    new_sheet: called when the file NEXT was found (and removed).
    """

    def __init__(
        self,
        folder: Path,
        *,
        settle_s: float,
        claim: Callable[[Path], None],
        refuse: Callable[[str], None],
        new_sheet: Callable[[], None],
    ) -> None:
        self._folder, self._settle_s = folder, settle_s
        self._claim, self._refuse, self._new_sheet = claim, refuse, new_sheet
        self._seen: dict[str, Seen] = {}
        self._closed: set[str] = set()
        self._refused: dict[str, int] = {}

    def closed(self, name: str) -> None:
        """Somebody has closed this file, or moved it here whole. May be called from any thread."""
        self._closed.add(name)

    def step(self, now: float) -> float | None:
        """Look at the folder and claim what has settled. Returns when to look again; None: only when something happens.

        Raises DiskTrouble when the folder cannot be read or a claim failed: look again after RETRY_S.
        """
        present = self._present()
        self._forget_all_but(present)
        if NEXT in present:
            self._take_next()
        for name in [name for name in present if name != NEXT]:
            self._look_at(name, now)
        for name in sorted(self._seen, key=lambda name: (self._seen[name].changed_ns, name)):
            if self._due_s(name) <= now:
                self._take(name)
        return min((self._due_s(name) for name in self._seen), default=None)

    def _present(self) -> list[str]:
        try:
            names = os.listdir(self._folder)
        except OSError as error:
            raise DiskTrouble(f"the inbox {self._folder} cannot be read ({error.strerror}): make it again") from None
        return [name for name in names if not any(fnmatch.fnmatchcase(name, ignored) for ignored in IGNORED)]

    def _forget_all_but(self, present: list[str]) -> None:
        for known in (self._seen, self._refused):
            for name in known.keys() - set(present):
                del known[name]
        self._closed &= set(present)

    def _take_next(self) -> None:
        try:
            (self._folder / NEXT).unlink()
        except OSError as error:
            self._refuse_once(NEXT, f"cannot be removed ({error.strerror}): remove it")
            return
        self._new_sheet()

    def _look_at(self, name: str, now: float) -> None:
        try:
            found = (self._folder / name).lstat()
        except OSError:
            self._seen.pop(name, None)
            return
        if self._refused.get(name) == found.st_ctime_ns:
            return
        if not stat.S_ISREG(found.st_mode):
            self._refuse_once(name, f"is {_kind(found.st_mode)}, no file: put the picture itself there")
            return
        before = self._seen.get(name)
        if before is None or (before.size, before.changed_ns) != (found.st_size, found.st_mtime_ns):
            self._seen[name] = Seen(found.st_size, found.st_mtime_ns, now)

    def _due_s(self, name: str) -> float:
        return self._seen[name].since_s + self._settle_s * (1 if name in self._closed else UNCLOSED_FACTOR)

    def _take(self, name: str) -> None:
        path = self._folder / name
        del self._seen[name]
        try:
            # A link put in the file's place since it was looked at is not followed, a pipe does not block.
            os.close(os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK))
            self._claim(path)
        except FileNotFoundError:
            return
        except OSError as error:
            reason = "is a symbolic link" if error.errno == errno.ELOOP else f"cannot be read ({error.strerror})"
            self._refuse_once(name, f"{reason}: correct its rights or drop it again")
        self._closed.discard(name)

    def _refuse_once(self, name: str, words: str) -> None:
        self._seen.pop(name, None)
        with contextlib.suppress(OSError):
            changed_ns = (self._folder / name).lstat().st_ctime_ns
            if self._refused.get(name) != changed_ns:
                self._refused[name] = changed_ns
                self._refuse(f"{readable(name)} in the inbox {words}")


def readable(name: str) -> str:
    """A file name as one line of text, whatever bytes it is made of."""
    text = os.fsencode(name).decode("utf-8", "backslashreplace")
    return "".join(letter if letter.isprintable() else repr(letter)[1:-1] for letter in text)


def _kind(mode: int) -> str:
    kinds = {stat.S_IFLNK: "a symbolic link", stat.S_IFIFO: "a pipe", stat.S_IFDIR: "a folder"}
    return kinds.get(stat.S_IFMT(mode), "a special file")


class _Bell(FileSystemEventHandler):
    """Any event means: look. Which event it was only shortens the settling."""

    def __init__(self, inbox: Inbox, ring: threading.Event) -> None:
        self._inbox, self._ring = inbox, ring

    def on_any_event(self, event: FileSystemEvent) -> None:
        if isinstance(event, FileClosedEvent | FileMovedEvent):
            path = os.fsdecode(event.dest_path or event.src_path)
            self._inbox.closed(os.path.basename(path))
        if event.event_type in ("created", "closed", "moved"):
            self._ring.set()


class InboxWatch:
    """Keeps looking at the inbox: when something happens, when a file should have settled, and now and then."""

    def __init__(self, inbox: Inbox, folder: Path, *, trouble: Callable[[str], None]) -> None:
        self._inbox, self._folder, self._trouble = inbox, folder, trouble
        self._ring, self._stopped, self._told = threading.Event(), False, ""

    def run(self) -> None:
        """Until `stop`. What lies there already is found by the first look."""
        observer = Observer()
        try:
            observer.schedule(_Bell(self._inbox, self._ring), str(self._folder))
            observer.start()
        except OSError as error:
            self._trouble(
                f"changes in {self._folder} cannot be watched ({error.strerror}): it is looked at now and then"
            )
        while not self._stopped:
            self._ring.clear()
            self._ring.wait(self._look())
        if observer.is_alive():
            observer.stop()
            observer.join()

    def _look(self) -> float:
        try:
            due = self._inbox.step(time.monotonic())
        except DiskTrouble as error:
            self._tell(str(error))
            return RETRY_S
        self._told = ""
        return RESCAN_S if due is None else max(0.02, due - time.monotonic())

    def _tell(self, words: str) -> None:
        if words != self._told:
            self._told = words
            self._trouble(words)

    def stop(self) -> None:
        """May be called from any thread."""
        self._stopped = True
        self._ring.set()
