"""How a byte travels on a serial line: bits, parity, stop bits, and how long that takes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

Parity: TypeAlias = Literal["none", "even"]
FormatName: TypeAlias = Literal["7E1", "7E2", "8N1"]


@dataclass(frozen=True, slots=True)
class LineFormat:
    """bits: of data, without parity. stop: stop bits."""

    bits: Literal[7, 8]
    parity: Parity
    stop: Literal[1, 2]

    @property
    def bits_per_byte(self) -> int:
        """What one byte takes on the line, its start bit included."""
        return 1 + self.bits + (self.parity != "none") + self.stop

    def bytes_per_s(self, baud: int) -> float:
        return baud / self.bits_per_byte


FORMATS: dict[FormatName, LineFormat] = {
    "7E1": LineFormat(7, "even", 1),
    "7E2": LineFormat(7, "even", 2),
    "8N1": LineFormat(8, "none", 1),
}
"""No document says which of them an EMCO control is set to: look at the control."""

_EVEN = bytes(byte | 0x80 if byte.bit_count() % 2 else byte for byte in range(128)) * 2
_SEVEN = bytes(byte & 0x7F for byte in range(256))


def with_even_parity(data: bytes) -> bytes:
    """The lower seven bits of each byte, and an eighth that makes their number even: 7E1 on a line set to 8N1."""
    return data.translate(_EVEN)


def lower_seven(data: bytes) -> bytes:
    """Each byte without its eighth bit."""
    return data.translate(_SEVEN)


def parity_is_even(byte: int) -> bool:
    return byte.bit_count() % 2 == 0
