"""Supervision: what the main thread does while the others work, until it is told to end."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from queue import Empty, SimpleQueue
from typing import Literal, TypeAlias

from daemon.errors import LinedrawError
from daemon.notify import Notifier
from daemon.pulse import Pulse
from daemon.status import Status
from daemon.status import in_words as of_machine

FED_OFTEN = 3
"""So many times in the period of the watchdog it is fed: one late turn of a busy computer ends nothing."""
_Asked: TypeAlias = Literal["end", "reread", "watching"]


class Supervision:
    """`run` says when the daemon is ready, feeds the watchdog while the loops go on, and rereads the settings.

    `end`, `reread` and `watching` may be called from any thread and from a signal handler. say: an event in words.
    answers: raises LinedrawError when nobody answers at the control socket. reread: what has changed, in sentences;
    raises LinedrawError. status: the present one.
    """

    def __init__(
        self,
        notifier: Notifier,
        pulse: Pulse,
        *,
        say: Callable[..., None],
        status: Callable[[], Status],
        answers: Callable[[], object],
        reread: Callable[[], list[str]],
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self._notifier, self._pulse, self._say, self._status = notifier, pulse, say, status
        self._answers, self._reread, self._now = answers, reread, now
        # A signal handler may put into this queue whatever the thread below it is doing; an Event it might not set.
        self._asked: SimpleQueue[_Asked] = SimpleQueue()
        self._ready, self._late, self._fed_s = False, "", float("-inf")

    def run(self) -> None:
        """Until `end`."""
        every_s = None if self._notifier.watchdog_s is None else self._notifier.watchdog_s / FED_OFTEN
        while True:
            self._feed(every_s)
            try:
                asked = self._asked.get(timeout=every_s)
            except Empty:
                continue
            if asked == "end":
                self._notifier.stopping()
                return
            if asked == "watching":
                self._say_ready()
            else:
                self._say_reread()

    def end(self) -> None:
        self._asked.put("end")

    def reread(self) -> None:
        """Read the settings again and say what has become of each change."""
        self._asked.put("reread")

    def watching(self) -> None:
        """From now on the inbox is watched; may be said again and again."""
        if not self._ready:
            self._asked.put("watching")

    def show(self, status: Status) -> None:
        """Tell systemd what status.json tells everybody."""
        self._notifier.status(in_words(status))

    def _say_ready(self) -> None:
        if self._ready:
            return
        try:
            if self._notifier.listened_to:
                self._answers()
        except LinedrawError as error:
            self._say(f"not ready: {error}", level=logging.ERROR)
            return
        self._ready = True
        self._notifier.ready()

    def _say_reread(self) -> None:
        self._notifier.reloading()
        try:
            for words in self._reread():
                self._say(words)
        except LinedrawError as error:
            self._say(f"the settings stay as they were: {error}", level=logging.ERROR)
        self._notifier.ready()

    def _feed(self, every_s: float | None) -> None:
        if every_s is None or self._now() - self._fed_s < every_s / 2:
            return
        late = self._pulse.late(draw=_draw(self._status()))
        if late and not self._late:
            self._say(f"{late}: the watchdog is not fed, systemd starts linedrawd anew", level=logging.ERROR)
        self._late = late
        if not late:
            self._fed_s = self._now()
            self._notifier.alive()


def _draw(status: Status) -> list[str]:
    """The machines that draw."""
    return [name for name, machine in status.machines.items() if machine.state == "drawing"]


def in_words(status: Status) -> str:
    """The status in a line."""
    waiting = status.jobs_queued + status.jobs_waiting
    machine = status.words if len(status.machines) > 1 else of_machine(status)
    return ", ".join([machine, f"{waiting} waiting"] if waiting else [machine])
