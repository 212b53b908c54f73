"""The watch: looks at the inbox whenever something happens in it, and now and then."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable
from pathlib import Path

from watchdog.events import FileClosedEvent, FileMovedEvent, FileSystemEvent, FileSystemEventHandler
from watchdog.observers import Observer
from watchdog.observers.api import BaseObserver

from daemon.errors import DiskTrouble
from daemon.intake.inbox import Inbox
from daemon.intake.side import is_side

RESCAN_S = 120.0
"""Events can be lost: another computer writes on a network folder, or the kernel's queue overflows."""
AFTER_EVENTS_S = 5.0
"""Where some have come, others may have been lost just now."""
RETRY_S = 10.0
"""After a full or read-only disk."""
_AT_LEAST_S = 0.02


class _Bell(FileSystemEventHandler):
    """Any event means: look at that file. Which event it was only shortens the settling."""

    def __init__(self, inbox: Inbox, ring: threading.Event) -> None:
        self._inbox, self._ring = inbox, ring

    def on_any_event(self, event: FileSystemEvent) -> None:
        name = os.path.basename(os.fsdecode(event.dest_path or event.src_path))
        # What becomes of a picture changes when its side file has gone; claimed pictures go all the time.
        if event.event_type in ("created", "closed", "moved") or (event.event_type == "deleted" and is_side(name)):
            self._inbox.notice(name, closed=isinstance(event, FileClosedEvent | FileMovedEvent))
            self._ring.set()


class InboxWatch:
    """`run` keeps looking until `stop`: when something happens, when a file should have settled, and now and then.

    trouble: told a sentence when the folder cannot be watched or read. poll_s: look so often and wait for no events,
    which tell nothing of what another computer writes; None: by events. tidy: called at each look.
    """

    def __init__(
        self,
        inbox: Inbox,
        folder: Path,
        *,
        trouble: Callable[[str], None],
        poll_s: float | None = None,
        tidy: Callable[[], None] = lambda: None,
    ) -> None:
        self._inbox, self._folder, self._trouble, self._poll_s, self._tidy = inbox, folder, trouble, poll_s, tidy
        self._ring, self._stopped, self._told = threading.Event(), False, ""
        self._everything_at_s = float("-inf")

    def run(self) -> None:
        """Until `stop`. What lies there already is found by the first look."""
        observer = Observer()
        if self._poll_s is None:
            self._begin(observer)
        while not self._stopped:
            happened = self._ring.is_set()
            self._ring.clear()
            self._ring.wait(self._look(happened=happened))
        if observer.is_alive():
            observer.stop()
            observer.join()

    def _begin(self, observer: BaseObserver) -> None:
        try:
            observer.schedule(_Bell(self._inbox, self._ring), str(self._folder))
            observer.start()
        except OSError as error:
            self._trouble(
                f"changes in {self._folder} cannot be watched ({error.strerror}): it is looked at now and then"
            )

    def _look(self, *, happened: bool) -> float:
        """Returns the seconds until the next look."""
        self._tidy()
        now = time.monotonic()
        everything = now >= self._everything_at_s
        if everything:
            self._everything_at_s = now + (RESCAN_S if self._poll_s is None else self._poll_s)
        if happened:
            self._everything_at_s = min(self._everything_at_s, now + AFTER_EVENTS_S)
        try:
            due_s = self._inbox.step(now, everything=everything)
        except DiskTrouble as error:
            self._everything_at_s = now + RETRY_S
            self._tell(str(error))
            return RETRY_S
        if everything:
            self._told = ""
        next_s = self._everything_at_s if due_s is None else min(due_s, self._everything_at_s)
        return max(_AT_LEAST_S, next_s - time.monotonic())

    def _tell(self, words: str) -> None:
        if words != self._told:
            self._told = words
            self._trouble(words)

    def stop(self) -> None:
        """May be called from any thread."""
        self._stopped = True
        self._ring.set()
