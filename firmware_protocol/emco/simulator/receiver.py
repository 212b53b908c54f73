"""The serial input of a simulated control: bytes in time, its buffer with two marks, and the bytes that are lost."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

XOFF_PART, XON_PART = 0.75, 0.25
"""Parts of the buffer at which the control says so."""

_EPSILON_S = 1e-9
_NEVER = float("inf")
_LF = 0x0A


class Receiver:
    """Takes the bytes of the host as they arrive. `full` is called when the buffer reaches the XOFF mark.

    after_xoff: so many bytes are taken behind an XOFF, others are overruns; None: as many as the buffer has room for.
    """

    def __init__(
        self, *, byte_s: float, buffer_bytes: int, after_xoff: int | None, full: Callable[[float], None]
    ) -> None:
        self._byte_s, self._buffer_bytes, self._after_xoff, self._full = byte_s, buffer_bytes, after_xoff, full
        self._coming: deque[tuple[float, int]] = deque()
        self._free_s = 0.0
        self._buffer = bytearray()
        self._taken_behind = 0
        self.held = False
        """XOFF has been said and no XON since."""
        self.open = False
        """The control reads; what comes otherwise is lost."""
        self.quiet = False
        """It takes bytes but says nothing any more, not even XOFF."""
        self.peak = self.overruns = self.unread = 0
        """The highest level of the buffer; bytes lost for want of room; bytes lost because nobody read."""

    @property
    def level(self) -> int:
        return len(self._buffer)

    def send(self, data: bytes, now: float) -> None:
        """The host writes: the bytes follow those that are still on the wire."""
        self._free_s = max(now, self._free_s)
        for byte in data:
            self._free_s += self._byte_s
            self._coming.append((self._free_s, byte))

    def next_s(self) -> float:
        """When the next byte arrives that ends a block or brings the buffer to the XOFF mark."""
        to_mark = self._buffer_bytes * XOFF_PART - len(self._buffer)
        for count, (at_s, byte) in enumerate(self._coming, 1):
            if byte == _LF or (count >= to_mark and not self.held):
                return at_s
        return self._coming[-1][0] if self._coming else _NEVER

    def absorb(self, now: float) -> None:
        """Take what has arrived up to `now`."""
        while self._coming and self._coming[0][0] <= now + _EPSILON_S:
            at_s, byte = self._coming.popleft()
            self._take(byte, at_s)

    def next_block(self) -> bytes | None:
        """The next whole block without its end; None when there is none."""
        end = self._buffer.find(b"\n")
        if end < 0:
            return None
        block = bytes(self._buffer[:end])
        del self._buffer[: end + 1]
        return block

    def drained(self) -> bool:
        """The buffer is down at the XON mark; asked once, then it counts as said."""
        if not self.held or len(self._buffer) > self._buffer_bytes * XON_PART:
            return False
        self.held = False
        self._taken_behind = 0
        return True

    def clear(self) -> None:
        """Forget what has been read, and what was said about it."""
        self._buffer.clear()
        self.held = self.quiet = False
        self._taken_behind = 0

    def _take(self, byte: int, at_s: float) -> None:
        if not self.open:
            self.unread += 1
            return
        behind = self.held and self._after_xoff is not None and self._taken_behind >= self._after_xoff
        if len(self._buffer) >= self._buffer_bytes or behind:
            self.overruns += 1
            return
        self._taken_behind += self.held
        self._buffer.append(byte)
        self.peak = max(self.peak, len(self._buffer))
        if len(self._buffer) >= self._buffer_bytes * XOFF_PART and not self.held and not self.quiet:
            self.held = True
            self._full(at_s)
