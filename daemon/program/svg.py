"""A toolpath as a drawing for people, and for the robot arm's own software."""

from __future__ import annotations

import re
from itertools import groupby
from typing import TypeAlias

from daemon.shapes import Stroke, Toolpath

LineMm: TypeAlias = list[tuple[float, float]]


def write_svg(
    toolpath: Toolpath,
    *,
    size_mm: tuple[float, float],
    corner_mm: tuple[float, float] = (0.0, 0.0),
    line_mm: float = 0.4,
) -> str:
    """One `<path d="M x y L x y ...">` a stroke in drawing order (Raghav et al. 2020, Sec. 3.4), y down.

    size_mm: width and height of the part of the sheet that is shown; corner_mm: its lower left corner in machine mm;
    line_mm: width of the pen's line. One unit of the view box is 1 mm. A dot is a path of length 0 with round ends.
    The strokes of each pen that has a name are a group which is called so, in its colour.
    """
    width, height = (f"{side_mm:g}" for side_mm in size_mm)
    look = f'stroke-width="{line_mm:g}" stroke-linecap="round" stroke-linejoin="round"'
    rows = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}mm" height="{height}mm" '
        f'viewBox="0 0 {width} {height}">',
    ]
    for pen, strokes in groupby(toolpath.strokes, key=lambda stroke: stroke.pen):
        name, colour = toolpath.pens[pen] if toolpath.pens else ("", "black")
        called = f'id="{name}" ' if name else ""
        rows.append(f'<g {called}fill="none" stroke="{colour}" {look}>')
        rows += [_path(stroke, corner_mm[0], corner_mm[1] + size_mm[1]) for stroke in strokes]
        rows.append("</g>")
    return "\n".join([*rows, "</svg>"]) + "\n"


def read_svg(text: str) -> list[LineMm]:
    """The strokes that `write_svg` wrote: points (x, y) in mm from the upper left corner, y down; a dot has two.

    Raises ValueError for a path of another form.
    """
    return [_points(path) for path in re.findall(r'<path d="M ([^"]*)"', text)]


def _points(path: str) -> LineMm:
    pairs = [place.split() for place in path.split(" L ")]
    return [(float(x_mm), float(y_mm)) for x_mm, y_mm in pairs]


def _path(stroke: Stroke, left_mm: float, top_mm: float) -> str:
    places = [f"{x_mm - left_mm:.3f} {top_mm - y_mm:.3f}" for x_mm, y_mm in stroke.points.tolist()]
    first, *rest = places if len(places) > 1 else places * 2
    return f'<path d="M {first}{"".join(f" L {place}" for place in rest)}"/>'
