"""A drawing becomes a toolpath: placed, simplified, put in order, and checked against the machine's reach."""

from __future__ import annotations

from dataclasses import replace

from daemon.errors import NothingToDraw
from daemon.shapes import Drawing, Toolpath
from daemon.toolpath.order import order
from daemon.toolpath.place import place, placement
from daemon.toolpath.reach import check_reach
from daemon.toolpath.simplify import simplify


def plan_toolpath(
    drawing: Drawing,
    *,
    box_mm: tuple[float, float] = (64.0, 64.0),
    box_origin_mm: tuple[float, float] = (25.0, 25.0),
    error_mm: float = 0.05,
    start_mm: tuple[float, float] = (0.0, 0.0),
    park_mm: tuple[float, float] = (0.0, 0.0),
    reach_mm: tuple[float, float] | None = None,
    reach_low_mm: tuple[float, float] = (0.0, 0.0),
) -> Toolpath:
    """Everything in machine mm, y up; the picture fits the box, its proportions kept.

    box_origin_mm: the box's lower left corner in machine coordinates: with origin "here" (the pen stands on the
    sheet's corner at start) the sheet's own, with origin "homed" plus `origin_mm`. error_mm: how far a drawn line may
    leave the given polyline. start_mm: where the pen stands; park_mm: where it goes at the end. reach_mm: width and
    height from reach_low_mm on, None where they are not known. No stroke is lost; a stroke may be drawn from its
    other end, a closed one from another point. Raises NothingToDraw without strokes, OutOfReach before anything moves.
    """
    if not drawing.strokes:
        raise NothingToDraw(
            f"the picture of {drawing.width_px} x {drawing.height_px} px holds no line to draw: "
            "give a drawing with dark lines on light paper or light lines on dark paper"
        )
    from_px = placement(drawing.width_px, drawing.height_px, box_mm=box_mm, box_origin_mm=box_origin_mm)
    placed = [
        replace(stroke, points=simplify(place(stroke.points, from_px), error=error_mm)) for stroke in drawing.strokes
    ]
    if reach_mm is not None:
        check_reach(placed, reach_mm=reach_mm, reach_low_mm=reach_low_mm, park_mm=park_mm)
    return Toolpath(order(placed, start_mm=start_mm, end_mm=park_mm), from_px, start_mm, park_mm)
