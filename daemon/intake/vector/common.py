"""What every vector file becomes: lines in millimetres on a page, within stated limits."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from daemon.colours import BLACK, Rgb
from daemon.shapes import Colours, Grey, Points

FLAT_MM = 0.01
"""A curve becomes chords that leave it by no more."""
MOST_POINTS = 400_000
MOST_MM = 20_000.0
"""Of a page's side."""
_MOST_CHORDS = 5_000
_BEYOND_MM = 1e7


@dataclass(frozen=True, slots=True, eq=False)
class Vectors:
    """A page of lines. lines: each (N, 2) in mm, x to the right, y down, the page's upper left corner at (0, 0).

    colours: of each line; empty where the file says none, which is black.
    sized: the file says how large it is; else its unit, or its whole width, is only taken for mm. warnings: what was
    left out or taken for granted, in plain words.
    """

    lines: tuple[Points, ...]
    width_mm: float
    height_mm: float
    sized: bool
    warnings: tuple[str, ...] = ()
    colours: tuple[Rgb, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Rendered:
    """A page as it looks. grey: uint8 (H, W). px_per_mm: None where the file does not say it. warnings: as above.

    colour: where it was asked for.
    """

    grey: Grey
    px_per_mm: float | None = None
    warnings: tuple[str, ...] = ()
    colour: Colours | None = None


@dataclass(slots=True)
class Collected:
    """Lines of a page that is being read, counted: raises ValueError when they hold too many points."""

    lines: list[Points] = field(default_factory=list)
    colours: list[Rgb] = field(default_factory=list)
    points: int = 0

    def add(self, line: Points, colour: Rgb = BLACK) -> None:
        self.points = checked_points(self.points + len(line))
        if not (np.abs(line) < _BEYOND_MM).all():
            raise ValueError("holds a number that is beyond every sheet: draw it anew at its own size")
        self.lines.append(line)
        self.colours.append(colour)

    def clip(self, high: tuple[float, float]) -> None:
        """Keep the parts within the page, which begins at (0, 0)."""
        parts = [clipped([line], (0.0, 0.0), high) for line in self.lines]
        self.colours = [colour for some, colour in zip(parts, self.colours, strict=True) for _ in some]
        self.lines = [part for some in parts for part in some]


def checked_points(count: int) -> int:
    """So many points of lines, once they are not too many. Raises ValueError."""
    if count > MOST_POINTS:
        raise ValueError(f"holds more than {MOST_POINTS} points of lines: simplify it")
    return count


def left_out(count: int, one: str, several: str) -> list[str]:
    """What is warned of so many things that are not drawn; nothing where there are none."""
    return [f"1 {one} is left out" if count == 1 else f"{count} {several} are left out"] if count else []


def checked_size(width_mm: float, height_mm: float) -> tuple[float, float]:
    """The size of a page, once it is one. Raises ValueError."""
    if not (0 < width_mm <= MOST_MM and 0 < height_mm <= MOST_MM):
        raise ValueError(f"is {width_mm:g} x {height_mm:g} mm large, from 0 to {MOST_MM:g} mm are drawn: scale it")
    return width_mm, height_mm


def chords_of_bezier(control: Points, *, within: float) -> Points:
    """A quadratic or cubic Bezier curve as points on it, without its first one.

    control: (3, 2) or (4, 2). within: how far the chords may lie from the curve, in the same unit (Wang's bound on the
    second differences). Returns (N, 2).
    """
    degree = len(control) - 1
    bend = float(np.hypot(*np.diff(control, 2, axis=0).T).max())
    if not math.isfinite(bend):
        raise ValueError("holds a number that is beyond every sheet: draw it anew at its own size")
    count = min(_MOST_CHORDS, max(1, math.ceil(math.sqrt(degree * (degree - 1) / 8 * bend / within))))
    t = (np.arange(1, count + 1) / count)[:, None]
    points = sum(
        math.comb(degree, k) * (1 - t) ** (degree - k) * t**k * control[k] for k in range(degree + 1)
    )  # fmt: skip
    found: Points = np.asarray(points, float)
    found[-1] = control[-1]
    return found


def clipped(lines: Sequence[Points], low: tuple[float, float], high: tuple[float, float]) -> list[Points]:
    """The parts of the lines that lie within a rectangle (Liang and Barsky 1984)."""
    found: list[Points] = []
    for line in lines:
        if ((line >= low) & (line <= high)).all():
            found.append(line)
        elif len(line) > 1:
            found += _clipped(line, np.asarray(low, float), np.asarray(high, float))
    return found


def _clipped(line: Points, low: NDArray[np.float64], high: NDArray[np.float64]) -> list[Points]:
    start, step = line[:-1], np.diff(line, axis=0)
    still = step == 0
    safe = np.where(still, 1.0, step)
    at_low, at_high = (low - start) / safe, (high - start) / safe
    inside = (start >= low) & (start <= high)
    enter = np.where(still, np.where(inside, 0.0, np.inf), np.minimum(at_low, at_high)).max(axis=1)
    leave = np.where(still, np.where(inside, 1.0, -np.inf), np.maximum(at_low, at_high)).min(axis=1)
    return kept_parts(line, [[(max(0.0, a), min(1.0, b))] for a, b in zip(enter, leave, strict=True)])


def kept_parts(line: Points, parts: Sequence[Sequence[tuple[float, float]]]) -> list[Points]:
    """What is left of a line. parts: for each of its segments the shares of it that stay, from 0 to 1, in order."""
    found: list[Points] = []
    run: list[NDArray[np.float64]] = []
    for start, end, shares in zip(line[:-1], line[1:], parts, strict=True):
        for a, b in shares:
            if a >= b:
                continue
            if a > 0 or not run:
                _end(run, found)
                run = [start + a * (end - start)]
            run.append(end if b == 1 else start + b * (end - start))
            if b < 1:
                _end(run, found)
                run = []
        if not shares or shares[-1][1] < 1 or shares[-1][0] >= shares[-1][1]:
            _end(run, found)
            run = []
    _end(run, found)
    return found


def _end(run: list[NDArray[np.float64]], found: list[Points]) -> None:
    if len(run) > 1:
        found.append(np.array(run))
