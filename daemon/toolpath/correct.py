"""What a crooked machine has to be told so that the lines come out as they were meant."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from daemon.shapes import Points, Stroke, Toolpath
from daemon.toolpath.curves import fitted, points_of

_CHORD_MM, _FITTED_MM = 0.002, 0.01
"""On a crooked machine arcs are none: their chords are led aside, and arcs are fitted to these again."""
_TURNED_MM = 0.02
"""An axis has turned round when it has come back so far; less is what tracing leaves of a straight line."""


@dataclass(frozen=True, slots=True)
class Correction:
    """How a machine draws: the errors that are to be made good.

    scale_x, scale_y: mm that the pen goes for one mm asked for. skew_deg: so far the Y axis leans towards +X.
    backlash_mm: so far X and Y run before the pen follows, when they turn round. corner_mm: the sheet's corner, which
    stays where it is.
    """

    scale_x: float = 1.0
    scale_y: float = 1.0
    skew_deg: float = 0.0
    backlash_mm: tuple[float, float] = (0.0, 0.0)
    corner_mm: tuple[float, float] = (0.0, 0.0)


def corrected(toolpath: Toolpath, correction: Correction) -> Toolpath:
    """The toolpath whose strokes, drawn by that machine, lie where those of the given one are meant to lie.

    As many strokes in the same order; where an axis with backlash turns round within one, a point is added, to which
    the pen does not follow. The way back to px stays that of the sheet. `park_mm` is a place of the machine and stays.
    """
    if correction == Correction(corner_mm=correction.corner_mm):
        return toolpath
    lines = [_polyline(stroke) for stroke in toolpath.strokes]
    straight = [replace(line, points=_straight(line.points, correction)) for line in lines]
    taken_up = _TakenUp(correction.backlash_mm, toolpath.start_mm)
    led = [taken_up.stroke(stroke) for stroke in straight]
    return replace(toolpath, strokes=tuple(map(_curved_as, led, toolpath.strokes)))


def _polyline(stroke: Stroke) -> Stroke:
    if stroke.moves is None:
        return stroke
    return replace(stroke, points=points_of(stroke.points[0], stroke.moves, chord_mm=_CHORD_MM), moves=None)


def _curved_as(line: Stroke, given: Stroke) -> Stroke:
    return line if given.moves is None else fitted(line, error_mm=_FITTED_MM)


def _straight(points: Points, correction: Correction) -> Points:
    """Undo scale and skew, about the sheet's corner. (N, 2) to (N, 2), in mm."""
    lean = math.radians(correction.skew_deg)
    x_mm, y_mm = (points - correction.corner_mm).T
    up_mm = y_mm / (correction.scale_y * math.cos(lean))
    across_mm = (x_mm - correction.scale_y * math.sin(lean) * up_mm) / correction.scale_x
    return np.column_stack([across_mm, up_mm]) + correction.corner_mm


class _TakenUp:
    """Follows both axes through all strokes, each half its backlash ahead of the way it goes."""

    def __init__(self, backlash_mm: tuple[float, float], start_mm: tuple[float, float]) -> None:
        self._axes = [_Axis(play_mm, at_mm) for play_mm, at_mm in zip(backlash_mm, start_mm, strict=True)]

    def stroke(self, stroke: Stroke) -> Stroke:
        first, *others = stroke.points.tolist()
        self._turn(first)
        points = [self._ahead(first)]
        before = first
        for point in others:
            # The axes turn where the last point lies: the pen stands until their play is through.
            if self._turn(point):
                points.append(self._ahead(before))
            points.append(self._ahead(point))
            before = point
        return replace(stroke, points=np.array(points, float))

    def _turn(self, point: list[float]) -> bool:
        """Whether an axis has turned round on its way to this point."""
        return any([axis.goes_to(at_mm) for axis, at_mm in zip(self._axes, point, strict=True)])

    def _ahead(self, point: list[float]) -> list[float]:
        return [at_mm + axis.ahead_mm for axis, at_mm in zip(self._axes, point, strict=True)]


class _Axis:
    """One axis: the way it last went (0 before it has moved), and how far it came on it."""

    def __init__(self, play_mm: float, at_mm: float) -> None:
        self._play_mm, self._way, self._furthest_mm = play_mm, 0.0, at_mm

    @property
    def ahead_mm(self) -> float:
        return self._way * self._play_mm / 2

    def goes_to(self, at_mm: float) -> bool:
        """Whether it turns round, and its play has to be run through."""
        step_mm = at_mm - self._furthest_mm
        if abs(step_mm) > _TURNED_MM and self._way != math.copysign(1.0, step_mm):
            self._way, self._furthest_mm = math.copysign(1.0, step_mm), at_mm
            return self._play_mm > 0
        if self._way * step_mm > 0:
            self._furthest_mm = at_mm
        return False
