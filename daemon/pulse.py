"""The pulse of the daemon's loops: each says when it will be heard of again, and it shows which one is late."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection


class Heart:
    """One loop. `within` is called by its own thread, `late_s` by any."""

    def __init__(self, name: str, now: Callable[[], float] = time.monotonic) -> None:
        self.name, self._now = name, now
        self._due_s: float | None = None

    def within(self, seconds: float) -> None:
        """This loop lives, and will be heard of again within so many seconds."""
        self._due_s = self._now() + seconds

    @property
    def late_s(self) -> float:
        """Seconds since it should have been heard of; 0 when it is not late, or has not begun."""
        return 0.0 if self._due_s is None else max(0.0, self._now() - self._due_s)


class Pulse:
    """The hearts of a daemon."""

    def __init__(self, now: Callable[[], float] = time.monotonic) -> None:
        self._now, self.planning = now, Heart("planning", now)
        self._drawing: dict[str, Heart] = {}
        self._inboxes: dict[str, Heart] = {}

    def drawing(self, machine: str) -> Heart:
        """That of the loop which draws on this machine."""
        return self._drawing.setdefault(machine, Heart(f"drawing ({machine})", self._now))

    def inbox(self, name: str) -> Heart:
        """That of the loop which watches this inbox."""
        return self._inboxes.setdefault(name, Heart(f"inbox ({name})", self._now))

    def late(self, *, draw: Collection[str]) -> str:
        """Which loop stands still, in words; "" when all go on.

        draw: the machines that draw at this moment. Only their loops count then: no other one is worth a spoilt sheet.
        """
        drawing = [self.drawing(machine) for machine in draw]
        counted = drawing or [*self._drawing.values(), self.planning, *self._inboxes.values()]
        late = [f"the {heart.name} loop is {heart.late_s:.0f} s late" for heart in counted if heart.late_s > 0]
        return ", ".join(late)
