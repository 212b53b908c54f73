"""The pulse of the daemon's loops: each says when it will be heard of again, and it shows which one is late."""

from __future__ import annotations

import time
from collections.abc import Callable


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
        self.drawing, self.planning, self.inbox = (Heart(name, now) for name in ("drawing", "planning", "inbox"))

    def late(self, *, draws: bool) -> str:
        """Which loop stands still, in words; "" when all go on.

        draws: something is being drawn, and only the loop that draws counts: no other one is worth a spoilt sheet.
        """
        counted = (self.drawing,) if draws else (self.drawing, self.planning, self.inbox)
        late = [f"the {heart.name} loop is {heart.late_s:.0f} s late" for heart in counted if heart.late_s > 0]
        return ", ".join(late)
