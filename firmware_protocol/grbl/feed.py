"""The feed override: real-time bytes that move it in steps, and reports that say how far it is."""

from __future__ import annotations

USUAL_PERCENT, LEAST_PERCENT, MOST_PERCENT = 100, 10, 200

_USUAL, _TEN_MORE, _TEN_LESS, _ONE_MORE, _ONE_LESS = (bytes([byte]) for byte in range(0x90, 0x95))
_AGAIN_AFTER_S = 1.0
"""A change shows in the next report; one that does not show was lost on the way."""


class FeedOverride:
    """Brings the controller's override to the wanted one, a step a report: the bytes are flags, equal ones merge."""

    def __init__(self) -> None:
        self._wanted = self._known = USUAL_PERCENT
        self._asked_at: float | None = None

    def want(self, percent: int) -> None:
        """Raises ValueError outside what GRBL offers, 10 to 200 percent."""
        if not LEAST_PERCENT <= percent <= MOST_PERCENT:
            raise ValueError(f"feed override {percent} %: GRBL takes {LEAST_PERCENT} to {MOST_PERCENT} %")
        self._wanted = percent

    def restarted(self) -> None:
        """Any reset sets the override back."""
        self._known, self._asked_at = USUAL_PERCENT, None

    def reported(self, percent: int | None) -> None:
        """A report came; it names the override only after a change and now and then."""
        if percent is not None:
            self._known, self._asked_at = percent, None

    def step(self, now: float) -> bytes:
        """The next real-time bytes, empty when nothing is to be changed or a change has not shown yet."""
        waits = self._asked_at is not None and now < self._asked_at + _AGAIN_AFTER_S
        if waits or self._wanted == self._known:
            return b""
        self._asked_at = now
        if self._wanted == USUAL_PERCENT:
            return _USUAL
        more = self._wanted > self._known
        tens, ones = divmod(abs(self._wanted - self._known), 10)
        return (_TEN_MORE if more else _TEN_LESS) * bool(tens) + (_ONE_MORE if more else _ONE_LESS) * bool(ones)
