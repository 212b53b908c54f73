"""Lines as a small picture in braille: two dots across and four down in each letter."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeAlias

Line: TypeAlias = Sequence[tuple[float, float]]
Dots: TypeAlias = set[tuple[int, int]]

ACROSS, DOWN = 2, 4
_BITS = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))
_BLANK = 0x2800
DIM, PEN, PLAIN = "\x1b[2m", "\x1b[7m", "\x1b[0m"


@dataclass(frozen=True, slots=True)
class Scale:
    """From the units of the lines to dots, both directions alike. low: what lies at dot (0, 0)."""

    low: tuple[float, float]
    high_units: tuple[float, float]
    dots_per_unit: float

    @property
    def high(self) -> tuple[int, int]:
        """The dot furthest to the right and down."""
        return self.dot(self.high_units)

    def dot(self, point: tuple[float, float]) -> tuple[int, int]:
        (x, y), (low_x, low_y) = point, self.low
        return round((x - low_x) * self.dots_per_unit), round((y - low_y) * self.dots_per_unit)


def braille(lines: Sequence[Line], done: int, *, columns: int, rows: int, colour: bool) -> list[str]:
    """The lines within so many letters, y down; [] for no lines.

    The first `done` are drawn. With colour the others are dim, and the letter where the next one begins, which is where
    the pen is, is reversed; without, the others are left out.
    """
    if not lines or columns < 1 or rows < 1:
        return []
    scale = _scale(lines, columns * ACROSS, rows * DOWN)
    drawn, rest = _dots(lines[:done], scale), _dots(lines[done:], scale)
    pen = _letter(scale.dot(lines[done][0] if done < len(lines) else lines[-1][-1]))
    if not colour:
        rest = set()
    width, height = (1 + last for last in _letter(scale.high))
    return [_row(row, width, drawn, rest, pen if colour else None) for row in range(height)]


def _scale(lines: Sequence[Line], width: int, height: int) -> Scale:
    xs, ys = zip(*(point for line in lines for point in line), strict=True)
    sides = ((max(xs) - min(xs)) / (width - 1), (max(ys) - min(ys)) / (height - 1))
    return Scale((min(xs), min(ys)), (max(xs), max(ys)), 1 / (max(sides) or 1.0))


def _dots(lines: Iterable[Line], scale: Scale) -> Dots:
    dots: Dots = set()
    for line in lines:
        places = [scale.dot(point) for point in line]
        dots.update(places[:1])
        for before, after in pairwise(places):
            dots.update(_between(before, after))
    return dots


def _between(before: tuple[int, int], after: tuple[int, int]) -> Dots:
    (x, y), (to_x, to_y) = before, after
    steps = max(abs(to_x - x), abs(to_y - y), 1)
    return {(round(x + (to_x - x) * at / steps), round(y + (to_y - y) * at / steps)) for at in range(steps + 1)}


def _letter(dot: tuple[int, int]) -> tuple[int, int]:
    return dot[0] // ACROSS, dot[1] // DOWN


def _row(row: int, columns: int, drawn: Dots, rest: Dots, pen: tuple[int, int] | None) -> str:
    return "".join(_styled(column, row, drawn, rest, pen) for column in range(columns))


def _styled(column: int, row: int, drawn: Dots, rest: Dots, pen: tuple[int, int] | None) -> str:
    of_drawn, of_rest = (_bits(column, row, dots) for dots in (drawn, rest))
    letter = chr(_BLANK + (of_drawn | of_rest))
    if (column, row) == pen:
        return f"{PEN}{letter}{PLAIN}"
    # A letter has one style: what is drawn in it is not hidden by what is not.
    return f"{DIM}{letter}{PLAIN}" if of_rest and not of_drawn else letter


def _bits(column: int, row: int, dots: Dots) -> int:
    places = ((x, y) for y in range(DOWN) for x in range(ACROSS))
    return sum(_BITS[y][x] for x, y in places if (column * ACROSS + x, row * DOWN + y) in dots)
