"""The test card: lines of known size that show a person, and a scanner, how a machine draws.

A frame, a ruler, a circle, and along the four sides marks in two rows: one drawn on the way there, one on the way back.
Where an axis has backlash the marks of the two rows stand beside each other, as on a vernier.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from daemon.errors import SettingsError
from daemon.shapes import Drawing, Points, Stroke

PX_PER_MM = 10.0
LEAST_MM = 60.0
_MOST_MM = 120.0
_EVERY_MM = 4.0
_FIRST_MM = 10.0
"""From the corner of the frame to the first mark of a row."""
_THERE_MM, _BACK_MM = (3.0, 5.0), (5.4, 7.4)
"""From the frame to the near and the far end of a mark, on the way there and on the way back."""


@dataclass(frozen=True, slots=True)
class Mark:
    """A short line across the way the machine came. axis: the one whose place it shows, 0 for X.

    way: 1 where that axis came from lower numbers, -1 where it came from higher ones.
    """

    axis: Literal[0, 1]
    way: Literal[1, -1]
    start_mm: tuple[float, float]
    end_mm: tuple[float, float]


@dataclass(frozen=True, slots=True)
class Card:
    """A test card of that size, in mm from its lower left corner, x to the right and y up."""

    width_mm: float
    height_mm: float

    @property
    def corners_mm(self) -> Points:
        """(4, 2), counterclockwise from the lower left."""
        return np.array([[0, 0], [self.width_mm, 0], [self.width_mm, self.height_mm], [0, self.height_mm]], float)

    @property
    def marks(self) -> tuple[Mark, ...]:
        """Those that may be measured: the first of each row is only there to bring the machine onto its way."""
        return tuple(mark for row in self._rows() for mark in row[1:])

    @property
    def strokes_mm(self) -> tuple[Points, ...]:
        """In the order in which they have to be drawn, each (N, 2)."""
        rows = [np.array([mark.start_mm, mark.end_mm]) for row in self._rows() for mark in row]
        frame = np.vstack([self.corners_mm, self.corners_mm[:1]])
        return (frame, *rows, *self.figures_mm)

    @property
    def figures_mm(self) -> tuple[Points, ...]:
        """The ruler and the circle: they lie on one side, so that a picture of the card shows which way up it is."""
        return (*self._ruler(), self._circle(1.0))

    @property
    def blank_mm(self) -> tuple[Points, ...]:
        """Where nothing is drawn: inside and outside the circle."""
        return self._circle(0.6), self._circle(1.4)

    @property
    def ruler_mm(self) -> float:
        return 10.0 * math.floor((self.width_mm - 2 * _FIRST_MM) / 10)

    def _rows(self) -> Iterator[Sequence[Mark]]:
        """Bottom, top, left, right; each there and back."""
        for axis, across_mm in ((0, self.height_mm), (1, self.width_mm)):
            for far in (False, True):
                yield self._row(axis, 1, _mirrored(_THERE_MM, across_mm) if far else _THERE_MM)
                yield self._row(axis, -1, _mirrored(_BACK_MM, across_mm) if far else _BACK_MM)

    def _row(self, axis: int, way: Literal[1, -1], ends_mm: tuple[float, float]) -> Sequence[Mark]:
        along_mm = (self.width_mm, self.height_mm)[axis]
        places_mm = np.arange(_FIRST_MM, along_mm - _FIRST_MM + 1e-6, _EVERY_MM).tolist()[::way]
        if axis == 0:
            return [Mark(0, way, (at, ends_mm[0]), (at, ends_mm[1])) for at in places_mm]
        return [Mark(1, way, (ends_mm[0], at), (ends_mm[1], at)) for at in places_mm]

    def _ruler(self) -> Iterator[Points]:
        """A line with a tick each mm, longer ones each 5 and 10 mm."""
        left_mm = (self.width_mm - self.ruler_mm) / 2
        base_mm = _FIRST_MM + 1
        yield np.array([[left_mm, base_mm], [left_mm + self.ruler_mm, base_mm]])
        for at in range(round(self.ruler_mm) + 1):
            tall_mm = 4.0 if at % 10 == 0 else 2.5 if at % 5 == 0 else 1.5
            yield np.array([[left_mm + at, base_mm], [left_mm + at, base_mm + tall_mm]])

    def _circle(self, part: float) -> Points:
        radius_mm = part * 0.15 * min(self.width_mm, self.height_mm)
        turn = np.linspace(0, 2 * math.pi, 145)
        middle_mm = (0.64 * self.width_mm, 0.6 * self.height_mm)
        return np.column_stack([np.cos(turn), np.sin(turn)]) * radius_mm + middle_mm


def card_in(box_mm: tuple[float, float]) -> Card:
    """The largest card of whole centimetres in such a box. Raises SettingsError where there is no room for one."""
    width_mm, height_mm = (min(_MOST_MM, 10.0 * math.floor(side_mm / 10 + 1e-9)) for side_mm in box_mm)
    if min(width_mm, height_mm) < LEAST_MM:
        raise SettingsError(
            f"[sheet] box_mm = {box_mm[0]:g} x {box_mm[1]:g} mm has no room for a test card of "
            f"{LEAST_MM:g} x {LEAST_MM:g} mm: make it larger"
        )
    return Card(width_mm, height_mm)


def gauge_mm(card: Card, heights: int) -> tuple[Points, ...]:
    """Where the strokes of the pen gauge are drawn, the lowest first; the one in the middle is longer. Each (2, 2)."""
    left_mm, low_mm = 0.2 * card.width_mm, 0.36 * card.height_mm
    step_mm = 0.4 * card.height_mm / (heights - 1)
    lengths_mm = [0.2 * card.width_mm if at == heights // 2 else 0.12 * card.width_mm for at in range(heights)]
    return tuple(
        np.array([[left_mm, low_mm + at * step_mm], [left_mm + length_mm, low_mm + at * step_mm]])
        for at, length_mm in enumerate(lengths_mm)
    )


def drawing_of(card: Card, lines_mm: Sequence[Points]) -> Drawing:
    """Lines of the card as a drawing of true size, which is as large as the card."""
    strokes = tuple(Stroke(_px(line_mm, card)) for line_mm in lines_mm)
    return Drawing(strokes, round(card.width_mm * PX_PER_MM), round(card.height_mm * PX_PER_MM), PX_PER_MM)


def _px(line_mm: Points, card: Card) -> Points:
    """The centre of the first pixel is (0, 0), so the picture's edge is half a pixel outside."""
    return np.column_stack([line_mm[:, 0], card.height_mm - line_mm[:, 1]]) * PX_PER_MM - 0.5


def _mirrored(ends_mm: tuple[float, float], across_mm: float) -> tuple[float, float]:
    return across_mm - ends_mm[1], across_mm - ends_mm[0]
