"""The ink of the machine, line by line, against the strokes of the programs: which stroke it is, and how much of it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from daemon.program.file import load_program

SAME_MM = 0.12
"""Steps of the motors, and the corner that a controller cuts ($11)."""

Line = npt.NDArray[np.float64]
_PLACE = re.compile(r"X(-?[\d.]+) Y(-?[\d.]+)")


@dataclass(frozen=True, slots=True)
class Inked:
    """A line of ink is this stroke (from 0) of this job, from its beginning; `whole`: up to its end."""

    job: str
    stroke: int
    whole: bool


def strokes_of(program: Path) -> list[Line]:
    """The polyline of each stroke of a program file, in mm as its lines say them. Raises LinedrawError."""
    found = load_program(program)
    strokes: list[list[tuple[float, float]]] = [[] for _ in range(found.strokes)]
    for line in found.lines:
        place = _PLACE.search(line.text)
        if line.stroke is not None and place:
            strokes[line.stroke].append((float(place[1]), float(place[2])))
    return [np.array(stroke, float) for stroke in strokes]


def whose(ink: Line, programs: dict[str, Sequence[Line]]) -> Inked | None:
    """The stroke whose beginning this line of ink is; None where there is no such stroke."""
    for job, strokes in programs.items():
        for index, stroke in enumerate(strokes):
            if begins(ink, stroke):
                return Inked(job, index, whole=_length(ink) >= _length(stroke) - 2 * SAME_MM)
    return None


def begins(ink: Line, stroke: Line) -> bool:
    """Whether the ink runs along the stroke from its first point on, and nowhere else."""
    if np.hypot(*(ink[0] - stroke[0])) > SAME_MM or _length(ink) > _length(stroke) + SAME_MM * len(stroke):
        return False
    along = 0.0
    for point, gone in zip(ink, np.concatenate([[0.0], np.cumsum(_steps(ink))]), strict=True):
        along = max(along, _nearest_along(point, stroke, around=float(gone)))
        if np.hypot(*(point - _at(stroke, along))) > SAME_MM:
            return False
    return True


def _nearest_along(point: Line, stroke: Line, *, around: float) -> float:
    """How far along the stroke it passes nearest to the point, near the length that the ink has got to there."""
    places = np.linspace(around - 3 * SAME_MM, around + 3 * SAME_MM, 61)
    return float(min(places, key=lambda place: np.hypot(*(point - _at(stroke, place)))))


def _at(stroke: Line, along: float) -> Line:
    """The point of the stroke at this length from its beginning."""
    lengths = np.concatenate([[0.0], np.cumsum(_steps(stroke))])
    return np.array([np.interp(along, lengths, stroke[:, axis]) for axis in (0, 1)])


def _steps(line: Line) -> Line:
    return np.hypot(*np.diff(line, axis=0).T) if len(line) > 1 else np.zeros(0)


def _length(line: Line) -> float:
    return float(_steps(line).sum())
