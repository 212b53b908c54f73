"""The two languages of an EMCO control: what stands around a program, how it is named, what its numbers mean."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Literal, TypeAlias

from firmware_protocol.errors import LocalProtocolError

DialectName: TypeAlias = Literal["siemens", "fanuc"]

TRAVEL_MM = (350.0, 250.0, 300.0)
"""X, Y and Z of the Concept Mill 250, as EMCO's catalogue gives them."""
RAPID_MM_MIN = 15_000.0
"""Its rapid traverse (the same catalogue); nothing is fed faster."""
BLOCK_CHARACTERS = 80
"""A convention: every control that was looked at takes a block of this length."""

SIEMENS_NAME = re.compile(r"[A-Z]{2}[A-Z0-9_]{0,22}")
_FANUC_NAME = re.compile(r"O(?!0000)\d{4}")
_FREE_NUMBERS = 7999
"""From O8000 on a control often protects its programs."""


@dataclass(frozen=True, slots=True)
class Dialect:
    """metric: the word for millimetres. comment: what a control passes over. thousandths: a coordinate without a
    decimal point counts micrometres, as on a Fanuc control without pocket calculator input.
    """

    name: DialectName
    metric: str
    comment: re.Pattern[str]
    suffix: str
    thousandths: bool

    def head(self, program: str) -> tuple[str, ...]:
        """The lines before the first block. Raises LocalProtocolError for a name that the control does not take."""
        self.check_name(program)
        if self.name == "siemens":
            return (f"%_N_{program}_MPF", ";$PATH=/_N_MPF_DIR")
        return ("%", program)

    @property
    def tail(self) -> tuple[str, ...]:
        """The lines behind M30."""
        return () if self.name == "siemens" else ("%",)

    def note(self, words: str) -> str:
        """A comment behind the words of a block, which a person reads on the control's screen."""
        return f"; {words}" if self.name == "siemens" else f"({words})"

    def check_name(self, program: str) -> None:
        """Raises LocalProtocolError for a name that the control does not take."""
        pattern = SIEMENS_NAME if self.name == "siemens" else _FANUC_NAME
        if not pattern.fullmatch(program):
            rule = (
                "two letters, then at most 22 letters, digits and underscores, all capitals"
                if self.name == "siemens"
                else "O and four digits, not O0000"
            )
            raise LocalProtocolError(f"a {self.name} control takes no program called {program!r}: name it by {rule}")

    def name_from(self, text: str, number: int) -> str:
        """A name that the control takes, for the `number`-th program (from 1) and a text such as a picture's name."""
        if self.name == "fanuc":
            return f"O{(number - 1) % _FREE_NUMBERS + 1:04d}"
        plain = re.sub(r"[^A-Z0-9]+", "_", text.upper()).strip("_")
        return f"LD{number % 100_000:05d}_{plain}"[:24].rstrip("_")

    def file_name(self, program: str) -> str:
        """What the program's file is called; the suffix of the Fanuc dialect is a convention of ours."""
        return f"{program}{self.suffix}"


SIEMENS = Dialect("siemens", "G71", re.compile(r";.*"), ".MPF", thousandths=False)
FANUC = Dialect("fanuc", "G21", re.compile(r"\([^)]*\)"), ".NC", thousandths=True)
DIALECTS: dict[DialectName, Dialect] = {"siemens": SIEMENS, "fanuc": FANUC}


def dialect_of(first_line: str) -> tuple[Dialect, str | None]:
    """The dialect of a program by its first line, and the program's name where that line says it.

    Raises LocalProtocolError for a line that begins no program.
    """
    named = re.fullmatch(r"%_N_(\w+)_MPF", first_line.strip())
    if named:
        return SIEMENS, named[1]
    if first_line.strip() == "%":
        return FANUC, None
    raise LocalProtocolError(f"{first_line[:60]!r} begins no program of an EMCO control: begin with % or %_N_NAME_MPF")


def program_name(lines: tuple[str, ...]) -> tuple[Dialect, str]:
    """The dialect and the name of a program by its head. Raises LocalProtocolError where it has none."""
    dialect, name = dialect_of(lines[0] if lines else "")
    name = name or (lines[1].strip() if len(lines) > 1 else "")
    dialect.check_name(name)
    return dialect, name
