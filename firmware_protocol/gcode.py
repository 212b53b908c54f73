"""Words of a G-code line, read and written as GRBL 1.1 does it."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import NamedTuple

from firmware_protocol.errors import ProtocolError

LINE_CHARACTERS = 79
"""The longest line that GRBL takes, counted without blanks and comments."""

EXPECTED_LETTER = 1
BAD_NUMBER = 2
LINE_OVERFLOW = 11

_COMMENT = re.compile(rb"\([^)]*\)?|;.*", re.DOTALL)
_DROPPED = bytes(range(0x21)) + b"/" + bytes(range(0x80, 0x100))
_NUMBER = re.compile(r"([+-]?)(\d*)(?:\.(\d*))?")
_ZERO = re.compile(r"-0(?:\.0*)?")


class GcodeError(ProtocolError):
    """A line that GRBL refuses; `code` is the N of its `error:N`."""

    def __init__(self, code: int) -> None:
        super().__init__(f"error:{code}")
        self.code = code


class Word(NamedTuple):
    """A letter and its number, such as X12.5."""

    letter: str
    value: float


def clean_line(raw: bytes) -> str:
    """What GRBL keeps of a line without its terminator: no blanks, controls, slashes and comments, capital letters.

    Raises GcodeError(11) when more than 79 characters remain.
    """
    if b"(" in raw or b";" in raw:
        raw = _COMMENT.sub(b"", raw)
    kept = raw.translate(None, _DROPPED)
    if len(kept) > LINE_CHARACTERS:
        raise GcodeError(LINE_OVERFLOW)
    return kept.upper().decode("ascii")


def read_number(text: str, start: int = 0) -> tuple[float, int]:
    """The number at `start` and the index behind it: sign, digits, one point, no exponent.

    Raises GcodeError(2) where there is no digit.
    """
    match = _NUMBER.match(text, start)
    if match is None or not (match[2] or match[3]):
        raise GcodeError(BAD_NUMBER)
    return float(match[0]), match.end()


def read_words(line: str) -> Iterator[Word]:
    """The words of a line that `clean_line` returned, one by one, so that GRBL's first complaint comes first.

    Raises GcodeError(1) where a letter is expected and GcodeError(2) where a number is.
    """
    at = 0
    while at < len(line):
        letter = line[at]
        if not "A" <= letter <= "Z":
            raise GcodeError(EXPECTED_LETTER)
        value, at = read_number(line, at + 1)
        yield Word(letter, value)


def format_number(value: float, decimals: int = 3) -> str:
    """`value` with at most `decimals` decimals, without exponent, trailing zeros or a minus before zero."""
    text = f"{value:.{decimals}f}"
    if "." in text:
        text = text.rstrip("0").rstrip(".")
    return "0" if _ZERO.fullmatch(text) else text


def format_line(words: Iterable[tuple[str, float]], decimals: int = 3) -> str:
    """The words as one line with blanks between them, such as `G1 X1.5 Y2 F1200`."""
    return " ".join(letter + format_number(value, decimals) for letter, value in words)
