"""The serial line between host and controller: 115200 8N1, both directions, byte by byte in time."""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Callable
from math import ceil, floor

BYTE_S = 10 / 115200
RING_BYTES = 128
TRANSMIT_BYTES = 104

_PIECES = re.compile(rb"[^\n\r!?~\x18\x80-\xff]*[\n\r]|[!?~\x18\x80-\xff]|[^\n\r!?~\x18\x80-\xff]+")
_REAL_TIME = frozenset(b"!?~\x18") | frozenset(range(0x80, 0x100))
_EPSILON_S = 1e-9
_NEVER = float("inf")


class Inbound:
    """Bytes on their way to the controller, its receive ring and the line it is reading.

    Real-time bytes never enter the ring: each is handed to `signal` at the moment it arrives. A full ring drops bytes
    silently (`overflows` counts them), as does a chip that has interrupts off (`lost`).
    """

    def __init__(self, signal: Callable[[int], None]) -> None:
        self._signal = signal
        self._coming: deque[tuple[float, bytes]] = deque()
        self._free_s = 0.0
        self._ring = bytearray()
        self._partial = bytearray()
        self.usb_s = 0.0
        """What is written waits for the next multiple of this, as in a slow USB converter."""
        self.reading = False
        """The main loop waits for input: it takes bytes out of the ring as they come."""
        self.deaf_until_s = 0.0
        self.overflows = 0
        self.lost = 0

    def send(self, data: bytes, now: float) -> None:
        """The host writes: the bytes follow those that are still on the wire."""
        start = max(_next_packet_s(now, self.usb_s), self._free_s)
        for piece in _PIECES.findall(data):
            self._coming.append((start + BYTE_S, piece))
            start += len(piece) * BYTE_S
        self._free_s = start

    def clear(self) -> None:
        """The receive buffer is emptied by a reset."""
        self._ring.clear()
        self._partial.clear()

    def unplug(self, now: float) -> None:
        """Nothing is on the wire any more."""
        self._coming.clear()
        self._free_s = now
        self.clear()

    @property
    def free(self) -> int:
        """Bytes that the ring has place for."""
        return RING_BYTES - len(self._ring)

    def next_s(self) -> float:
        """When the next line end or real-time byte arrives."""
        if not self._coming:
            return _NEVER
        first_s, piece = self._coming[0]
        return first_s + (len(piece) - 1) * BYTE_S

    def absorb(self, now: float) -> bool:
        """Take what has arrived up to `now`. Returns True when that may concern the main loop."""
        concerned = False
        while self._coming:
            first_s, piece = self._coming[0]
            count = int((now - first_s + _EPSILON_S) / BYTE_S) + 1 if now + _EPSILON_S >= first_s else 0
            if count <= 0:
                break
            if count < len(piece):
                self._coming[0] = (first_s + count * BYTE_S, piece[count:])
            else:
                self._coming.popleft()
            concerned |= self._take(piece[:count], first_s)
        return concerned

    def next_line(self) -> bytes | None:
        """The next whole line without its end; None when there is none: then the ring is empty."""
        ends = [at for at in (self._ring.find(b"\n"), self._ring.find(b"\r")) if at >= 0]
        if not ends:
            self._partial += self._ring
            self._ring.clear()
            return None
        line = bytes(self._partial + self._ring[: min(ends)])
        del self._ring[: min(ends) + 1]
        self._partial.clear()
        return line

    def _take(self, piece: bytes, first_s: float) -> bool:
        if first_s < self.deaf_until_s:
            deaf = min(len(piece), int((self.deaf_until_s - first_s) / BYTE_S) + 1)
            self.lost += deaf
            piece = piece[deaf:]
        if not piece:
            return False
        if piece[0] in _REAL_TIME:
            self._signal(piece[0])
            return True
        if self.reading and not self._ring and piece[-1] not in b"\n\r":
            self._partial += piece
            return False
        room = self.free + (len(piece) if self.reading else 0)
        self.overflows += max(0, len(piece) - room)
        self._ring += piece[:room]
        return piece[-1] in b"\n\r"


class Outbound:
    """Bytes on their way to the host."""

    def __init__(self) -> None:
        self._going: deque[tuple[float, bytes]] = deque()
        self._free_s = 0.0
        self.usb_s = 0.0
        """What has come waits for the next multiple of this, as in a slow USB converter."""

    def send(self, data: bytes, now: float) -> float:
        """The controller prints. Returns the time until which it has to wait for its transmit buffer of 104 bytes."""
        start = max(now, self._free_s)
        self._going.append((start + BYTE_S, data))
        self._free_s = start + len(data) * BYTE_S
        return self._free_s - TRANSMIT_BYTES * BYTE_S

    def next_s(self) -> float:
        """When the next message is whole at the host."""
        if not self._going:
            return _NEVER
        first_s, data = self._going[0]
        return _next_packet_s(first_s + (len(data) - 1) * BYTE_S, self.usb_s)

    def arrived(self, now: float) -> bytes:
        """The bytes that have reached the host up to `now`; each is returned once."""
        out = bytearray()
        if self.usb_s:
            now = floor(now / self.usb_s + _EPSILON_S) * self.usb_s
        while self._going and self._going[0][0] <= now + _EPSILON_S:
            first_s, data = self._going.popleft()
            count = int((now - first_s + _EPSILON_S) / BYTE_S) + 1
            out += data[:count]
            if count < len(data):
                self._going.appendleft((first_s + count * BYTE_S, data[count:]))
                break
        return bytes(out)

    def unplug(self, now: float) -> None:
        """Nothing is on the wire any more."""
        self._going.clear()
        self._free_s = now


def _next_packet_s(now: float, usb_s: float) -> float:
    return ceil(now / usb_s - _EPSILON_S) * usb_s if usb_s else now
