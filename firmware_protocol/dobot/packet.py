"""Packets of the Dobot Magician, and how they are found again behind noise.

`AA AA length id ctrl parameters checksum`: the length counts id, ctrl and parameters; these and the checksum add up to
0 modulo 256. Nothing is stuffed, so AA may stand anywhere. A packet that arrives damaged is never answered.
"""

from __future__ import annotations

from dataclasses import dataclass

from firmware_protocol.errors import LocalProtocolError

HEADER = b"\xaa\xaa"
LEAST_LENGTH = 2
LONGEST_LENGTH = 0xA9
"""The vendor's receiver takes no length of AA or more, so a third AA is never a length."""

_WRITE, _QUEUED = 0b01, 0b10


@dataclass(frozen=True, slots=True)
class Packet:
    """One packet. ctrl: bit 0 write, bit 1 into the queue; a reply repeats the id and ctrl of its request."""

    id: int
    ctrl: int
    params: bytes = b""

    @property
    def write(self) -> bool:
        """It changes something; otherwise it asks for something."""
        return bool(self.ctrl & _WRITE)

    @property
    def queued(self) -> bool:
        """It is put into the arm's queue: the answer is its index there, given before it is executed."""
        return bool(self.ctrl & _QUEUED)

    def encode(self) -> bytes:
        """Its bytes on the wire. Raises LocalProtocolError when it is longer than the arm takes."""
        length = 2 + len(self.params)
        if length > LONGEST_LENGTH:
            raise LocalProtocolError(f"a packet of {length} bytes is too long: the arm takes {LONGEST_LENGTH}")
        payload = bytes((self.id, self.ctrl)) + self.params
        return HEADER + bytes((length,)) + payload + bytes((checksum(payload),))


def ctrl(*, write: bool = False, queued: bool = False) -> int:
    """The control byte."""
    return _WRITE * write | _QUEUED * queued


def checksum(payload: bytes) -> int:
    """What makes the sum of payload and checksum 0 modulo 256."""
    return -sum(payload) & 0xFF


class PacketReader:
    """Cuts a byte stream into packets; never raises.

    As the vendor's receiver does: where the length is impossible one byte is dropped, where the checksum is wrong
    three, and the search goes on in what follows.
    """

    def __init__(self) -> None:
        self._rest = bytearray()
        self.damaged = 0
        """Packets whose checksum was wrong so far."""

    def feed(self, data: bytes) -> list[Packet]:
        """The packets that `data` completes."""
        self._rest += data
        packets = []
        while (packet := self._next()) is not None:
            packets.append(packet)
        return packets

    def give_up(self) -> list[Packet]:
        """Wait no longer for the rest of a packet that has begun: the packets that were behind its header."""
        if len(self._rest) > len(HEADER):
            del self._rest[:1]
        return self.feed(b"")

    def _next(self) -> Packet | None:
        rest = self._rest
        while True:
            start = rest.find(HEADER)
            if start < 0:
                # The last byte may be the first half of a header.
                del rest[: len(rest) - rest.endswith(HEADER[:1])]
                return None
            del rest[:start]
            if len(rest) < 3:
                return None
            length = rest[2]
            if not LEAST_LENGTH <= length <= LONGEST_LENGTH:
                del rest[:1]
                continue
            if len(rest) < length + 4:
                return None
            payload = bytes(rest[3 : 3 + length])
            if checksum(payload) == rest[3 + length]:
                del rest[: length + 4]
                return Packet(payload[0], payload[1], payload[2:])
            self.damaged += 1
            del rest[:3]
