"""One direction of the serial line, 115200 8N1: what is written arrives when its last byte has passed."""

from __future__ import annotations

from collections import deque

BYTE_S = 10 / 115200
_NEVER = float("inf")
_EPSILON_S = 1e-9


class Line:
    """Messages on their way, in order."""

    def __init__(self) -> None:
        self._going: deque[tuple[float, bytes]] = deque()
        self._free_s = 0.0

    def send(self, data: bytes, now: float) -> None:
        """The message follows what is still on the way."""
        self._free_s = max(now, self._free_s) + len(data) * BYTE_S
        self._going.append((self._free_s, data))

    def next_s(self) -> float:
        """When the next message is whole at the other end."""
        return self._going[0][0] if self._going else _NEVER

    def arrived(self, now: float) -> bytes:
        """What has arrived up to `now`; each byte is returned once."""
        data = b""
        while self._going and self._going[0][0] <= now + _EPSILON_S:
            data += self._going.popleft()[1]
        return data

    def cut(self, now: float) -> None:
        """Nothing is on the way any more."""
        self._going.clear()
        self._free_s = now
