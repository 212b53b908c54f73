"""A drawing becomes a toolpath: placed, simplified, put in order, and checked against the machine's reach."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from daemon.errors import NothingToDraw
from daemon.shapes import Affine, Drawing, Stroke, Toolpath
from daemon.toolpath.curves import fitted
from daemon.toolpath.order import Place, order
from daemon.toolpath.place import Layout, place, placement
from daemon.toolpath.reach import check_reach
from daemon.toolpath.rejoin import rejoined
from daemon.toolpath.simplify import shared_points, simplify


@dataclass(frozen=True, slots=True)
class Precision:
    """How far a drawn line may leave the given one: the smaller of error_mm and error_px, in px of the drawing.

    shortest_mm: a segment shorter than this is left out where it may be, for the machine cannot resolve it.
    curve_mm: above 0 the line is drawn in straight moves and arcs that leave it by no more, nor by error_px; with 0 it
    is a polyline.
    """

    error_mm: float = 0.05
    error_px: float = 0.25
    shortest_mm: float = 0.0
    curve_mm: float = 0.0


IN_THE_BOX, PRECISE = Layout(), Precision()


def plan_toolpath(
    drawing: Drawing,
    *,
    layout: Layout = IN_THE_BOX,
    precision: Precision = PRECISE,
    start_mm: tuple[float, float] = (0.0, 0.0),
    park_mm: tuple[float, float] = (0.0, 0.0),
    reach_mm: tuple[float, float] | None = None,
    reach_low_mm: tuple[float, float] = (0.0, 0.0),
    rejoin: bool = True,
) -> Toolpath:
    """Everything in machine mm, y up; the picture lies in its box, its proportions kept.

    The box lies in machine coordinates: with origin "here" (the pen stands on the sheet's corner at start) the sheet's
    own, with origin "homed" plus `origin_mm`. start_mm: where the pen stands; park_mm: where it goes at the end.
    reach_mm: width and height from reach_low_mm on, None where they are not known. No line is lost; a stroke may be
    drawn from its other end, a closed one from another point, and strokes that share points may be joined otherwise
    there (see `rejoined`) unless rejoin is False; ends lie exactly where they were, and so do the crossings of
    polylines. Curves are fitted last, to the lines as they were traced and in mm of the machine, for only there arcs
    are arcs. All strokes of one pen are drawn before those of the next. Raises NothingToDraw without strokes,
    OutOfReach before anything moves.
    """
    if not drawing.strokes:
        raise NothingToDraw(
            f"the picture of {drawing.width_px} x {drawing.height_px} px holds no line to draw: "
            "give a drawing with dark lines on light paper or light lines on dark paper"
        )
    from_px = placement(drawing.width_px, drawing.height_px, layout, px_per_mm=drawing.px_per_mm)
    error_mm = _error_mm(from_px, precision)
    placed = _traced(drawing, from_px) if precision.curve_mm > 0 else _simplified(drawing, from_px, precision, error_mm)
    if reach_mm is not None:
        check_reach(placed, reach_mm=reach_mm, reach_low_mm=reach_low_mm, park_mm=park_mm)
    tour = _tour(placed, start_mm, park_mm, rejoin=rejoin)
    if precision.curve_mm > 0:
        room = None if reach_mm is None else (reach_low_mm, _added(reach_low_mm, reach_mm))
        tour = tuple(fitted(each, error_mm=error_mm, shortest_mm=precision.shortest_mm, room=room) for each in tour)
    return Toolpath(tour, from_px, start_mm, park_mm)


def _tour(strokes: list[Stroke], start_mm: Place, park_mm: Place, *, rejoin: bool) -> tuple[Stroke, ...]:
    """One pen after the other, each by a tour of its own that ends where it is changed."""
    found: list[Stroke] = []
    for pen in sorted({stroke.pen for stroke in strokes}):
        mine = [stroke for stroke in strokes if stroke.pen == pen]
        begin_mm = park_mm if found else start_mm
        tour = order(mine, start_mm=begin_mm, end_mm=park_mm)
        found += rejoined(tour, start_mm=begin_mm, end_mm=park_mm) if rejoin else tour
    return tuple(found)


def _error_mm(from_px: Affine, precision: Precision) -> float:
    mm_per_px = float(np.sqrt(abs(np.linalg.det(from_px[:, :2]))))
    return min(precision.curve_mm or precision.error_mm, precision.error_px * mm_per_px)


def _added(a: tuple[float, float], b: tuple[float, float]) -> tuple[float, float]:
    return a[0] + b[0], a[1] + b[1]


def _traced(drawing: Drawing, from_px: Affine) -> list[Stroke]:
    """The strokes in mm, with all their points."""
    return [replace(stroke, points=place(stroke.points, from_px)) for stroke in drawing.strokes]


def _simplified(drawing: Drawing, from_px: Affine, precision: Precision, error_mm: float) -> list[Stroke]:
    """The strokes in mm, with as few points as the precision allows."""
    crossings = shared_points([stroke.points for stroke in drawing.strokes])
    lines = [
        simplify(place(stroke.points, from_px), error=error_mm, kept=kept, shortest=precision.shortest_mm)
        for stroke, kept in zip(drawing.strokes, crossings, strict=True)
    ]
    return [replace(stroke, points=line) for stroke, line in zip(drawing.strokes, lines, strict=True)]
