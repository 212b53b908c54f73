"""Blocks of an EMCO control, written and read: words with decimal points, capitals only, no exponent."""

from __future__ import annotations

import re
from typing import NamedTuple

from firmware_protocol.emco.dialects import BLOCK_CHARACTERS, Dialect
from firmware_protocol.errors import RemoteProtocolError

_WORD = re.compile(r"(CR=|[A-Z])([+-]?(?:\d+\.?\d*|\.\d+))")
_PLAIN = re.compile(r"[ -~]*")
_LENGTHS = frozenset({"X", "Y", "Z", "I", "J", "R", "CR="})
"""Words that a Fanuc control reads as micrometres where they have no point."""


class Alarm(RemoteProtocolError):
    """The control refuses what it has read; `str(alarm)` is what stands on its screen, and nowhere else."""


class Word(NamedTuple):
    """An address and its number, such as X12.5 or CR=4.0."""

    address: str
    value: float


def number(value: float) -> str:
    """With a decimal point and one to three decimals: without the point a Fanuc control reads micrometres."""
    text = f"{round(value, 3) + 0.0:.3f}"  # + 0.0: no "-0.000"
    return text.rstrip("0") + "0" if text.endswith("000") else text.rstrip("0")


def rapid(**to_mm: float) -> str:
    """G0 to these coordinates (x, y, z)."""
    return f"G0 {_coordinates(to_mm)}"


def straight(*, feed_mm_min: float | None = None, **to_mm: float) -> str:
    """G1 to these coordinates; the feed stays until another is given."""
    return f"G1 {_coordinates(to_mm)}" + (f" F{number(feed_mm_min)}" if feed_mm_min is not None else "")


def arc(to_mm: tuple[float, float], centre_mm: tuple[float, float], *, clockwise: bool) -> str:
    """G2 or G3 to `to_mm`; `centre_mm` is counted from the start of the arc, as I and J are."""
    (x, y), (i, j) = to_mm, centre_mm
    return f"G{2 if clockwise else 3} X{number(x)} Y{number(y)} I{number(i)} J{number(j)}"


def read_block(text: str, dialect: Dialect) -> list[Word]:
    """The words of one block without its end; comments, block numbers and the mark of a block skip are left out.

    Raises Alarm for what is no block of this dialect.
    """
    if len(text) > BLOCK_CHARACTERS:
        raise Alarm(f"block of {len(text)} characters, {BLOCK_CHARACTERS} are allowed: {text[:40]}")
    if not _PLAIN.fullmatch(text):
        raise Alarm(f"character that is not allowed: {text[:40]!r}")
    rest = dialect.comment.sub("", text).replace(" ", "").removeprefix("/")
    words: list[Word] = []
    while rest:
        match = _WORD.match(rest)
        if match is None or (match[1] == "CR=" and dialect.thousandths):
            raise Alarm(f"syntax error at {rest[:20]!r} in block: {text[:40]}")
        words.append(Word(match[1], _value(match[1], match[2], dialect)))
        rest = rest[match.end() :]
    return [word for word in words if word.address != "N"]


def _value(address: str, digits: str, dialect: Dialect) -> float:
    bare = "." not in digits and address in _LENGTHS
    return float(digits) * (0.001 if bare and dialect.thousandths else 1.0)


def _coordinates(to_mm: dict[str, float]) -> str:
    return " ".join(f"{axis.upper()}{number(value)}" for axis, value in to_mm.items())
