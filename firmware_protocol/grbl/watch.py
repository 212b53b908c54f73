"""When to ask `?`, and for how long the controller has owed an answer."""

from __future__ import annotations


class Watch:
    """The clocks of one conversation; every time is given, none is read."""

    def __init__(self, *, now: float, silent_after_s: float) -> None:
        self._silent_after_s = silent_after_s
        self._every_s = 1.0
        self._next_at = now
        self._asked_at: float | None = None
        self._idle_since: float | None = None

    def begin(self, now: float, *, every_s: float) -> None:
        """Ask now and then every `every_s`; what was asked before is forgotten."""
        self._every_s = every_s
        self._next_at = now
        self._asked_at = None
        self._idle_since = None

    def ask(self, now: float) -> bytes:
        """`?` when it is time for one."""
        if now < self._next_at:
            return b""
        self._next_at = now + self._every_s
        self._asked_at = now if self._asked_at is None else self._asked_at
        return b"?"

    def reported(self, now: float, *, idle_but_owing: bool) -> None:
        """A report came; idle_but_owing: it says Idle although lines are unanswered."""
        self._asked_at = None
        if not idle_but_owing:
            self._idle_since = None
        elif self._idle_since is None:
            self._idle_since = now

    def answered(self) -> None:
        """A line was answered, so answers are not lost."""
        self._idle_since = None

    @property
    def silent_at(self) -> float | None:
        """When `?` will have gone unanswered for too long; None when none is unanswered."""
        return None if self._asked_at is None else self._asked_at + self._silent_after_s

    def stuck_at(self, *, dwell_s: float) -> float | None:
        """When the controller will have been idle for too long without answering its lines: something was lost."""
        return None if self._idle_since is None else self._idle_since + self._silent_after_s + dwell_s

    @property
    def ask_at(self) -> float:
        """When `ask` wants to be called again."""
        return self._next_at
