"""Lines that ink a blot begin and end on its rim, so that the pen draws both without a lift."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from daemon.graph.crossings import Lines
from daemon.shapes import Points

_BESIDE_PX = 1.0


def led_in(fills: Sequence[Points], lines: Lines, *, width_px: float) -> Lines:
    """The lines, and those that ink blots: each led on to vertices of its rim.

    fills: (N, 2) each, in px, within a line width of the middle of their rims. A vertex in which an odd number of
    lines end is taken first, for that saves a lift; one end of each goes to any vertex where there is none of these.
    """
    degrees = np.bincount(lines.ends.ravel(), minlength=len(lines.vertices))
    polylines, ends, vertices = list(lines.polylines), lines.ends.tolist(), [lines.vertices]
    count = len(lines.vertices)
    for fill in fills:
        rim = _near(fill, lines.vertices, width_px + _BESIDE_PX) & (degrees > 0)
        line, tied = fill, [-1, -1]
        for odd_only in (True, True, False):
            free = rim & ((degrees % 2 == 1) | (not odd_only and max(tied) < 0))
            line, tied = _led(line, tied, lines.vertices, free)
            rim[[vertex for vertex in tied if vertex >= 0]] = False
        for side in (0, 1):
            if tied[side] < 0:
                vertices.append(line[[-side]])
                tied[side], count = count, count + 1
            else:
                degrees[tied[side]] += 1
        polylines.append(line)
        ends.append(tied)
    sound = [np.zeros(len(line), bool) for line in polylines[len(lines.polylines) :]]
    return Lines(polylines, lines.sound + sound, np.array(ends, np.intp).reshape(-1, 2), np.concatenate(vertices))


def _near(line: Points, vertices: Points, within_px: float) -> NDArray[np.bool_]:
    """Which vertices lie beside the line."""
    near = ((vertices > line.min(axis=0) - within_px) & (vertices < line.max(axis=0) + within_px)).all(axis=1)
    starts, ways = line[:-1, None], np.diff(line, axis=0)[:, None]
    offset = vertices[near] - starts
    share = np.clip((offset * ways).sum(axis=2) / np.maximum((ways**2).sum(axis=2), 1e-12), 0, 1)
    near[near] = np.hypot(*(offset - share[..., None] * ways).transpose(2, 0, 1)).min(axis=0) <= within_px
    return np.asarray(near)


def _led(line: Points, tied: list[int], vertices: Points, free: NDArray[np.bool_]) -> tuple[Points, list[int]]:
    """The line led on from that of its untied ends which is nearest to a free vertex."""
    sides = [side for side in (0, 1) if tied[side] < 0]
    if not free.any() or not sides:
        return line, tied
    away = np.where(free, np.hypot(*(vertices - line[[-side for side in sides]][:, None]).transpose(2, 0, 1)), np.inf)
    row, vertex = np.unravel_index(away.argmin(), away.shape)
    side = sides[int(row)]
    longer = np.insert(line, side * len(line), vertices[vertex], axis=0)
    return longer, [int(vertex) if each == side else tied[each] for each in (0, 1)]
