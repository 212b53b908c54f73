"""Short loose ends within the ink of other lines are no lines: a false corner has drawn them."""

from __future__ import annotations

import math

import numpy as np

from daemon.graph.crossings import Fewer, Lines, half_edges, lengths_px
from daemon.graph.plausibility import Floats, values_at
from daemon.graph.verdicts import Rule
from daemon.shapes import Map

_LONGEST_WIDTHS = 1.5
_BESIDE_WIDTHS = 1.0
_LEAST_LINES = 3
_BEYOND_WIDTHS = np.array([[0.15], [0.3]])
_INKED = 0.58
"""Mean ink so far beyond a loose end: about all of it where a pen has stopped, for its line reaches half a width on."""


def unspurred(lines: Lines, ink: Map, *, width_px: float) -> Fewer | None:
    """The edges without spurs, None where there is none.

    ink: float32 (H, W), 1 = full ink. A spur leads from a vertex in which three or more edges end to one in which none
    but it does, is at most one and a half line widths long, and its loose end lies within a line width of other edges
    near by and at the rim of the ink: a pen that stops there would have left half a line width of ink beyond it. The
    one nearest to the others goes first, and the last two edges of a vertex stay.
    """
    halves = half_edges(lines.ends, len(lines.vertices))
    degrees = np.array([len(some) for some in halves])
    loose = (degrees[lines.ends] == 1).any(axis=1) & (degrees[lines.ends] >= _LEAST_LINES).any(axis=1)
    short = set(np.flatnonzero(loose & (lengths_px(lines) <= _LONGEST_WIDTHS * width_px)).tolist())
    away = {edge: _aside(lines, edge, halves, short) for edge in short}
    gone: dict[int, Rule] = {}
    for edge in sorted(short, key=lambda edge: (math.hypot(*away[edge]), edge)):
        fork, tip = sorted(lines.ends[edge].tolist(), key=degrees.__getitem__, reverse=True)
        near = math.hypot(*away[edge]) <= _BESIDE_WIDTHS * width_px
        if degrees[fork] >= _LEAST_LINES and near and not _goes_on(ink, lines.vertices[tip], away[edge], width_px):
            gone[edge] = "spur"
            degrees[fork] -= 1
    if not gone:
        return None
    kept = [index for index in range(len(lines.polylines)) if index not in gone]
    return Fewer([lines.polylines[index] for index in kept], lines.ends[kept], lines.vertices, kept, gone)


def _aside(lines: Lines, edge: int, halves: list[list[int]], short: set[int]) -> Floats:
    """From the nearest point of the edges at a fork, and those that go on from them, to the loose end of an edge."""
    near = {half >> 1 for vertex in lines.ends[edge].tolist() for half in halves[vertex]}
    near |= {half >> 1 for other in near for vertex in lines.ends[other].tolist() for half in halves[vertex]}
    tip = lines.vertices[min(lines.ends[edge].tolist(), key=lambda vertex: len(halves[vertex]))]
    others = [lines.polylines[other] for other in sorted(near - short)]
    if not others:
        return np.full(2, np.inf)
    offsets = tip - np.concatenate(others)
    return np.asarray(offsets[np.hypot(*offsets.T).argmin()])


def _goes_on(ink: Map, tip: Floats, aside: Floats, width_px: float) -> bool:
    """Whether the ink goes on beyond a loose end as far as where a pen has stopped."""
    onward = aside / max(math.hypot(*aside), 1e-9) * width_px
    return float(values_at(ink, tip + _BEYOND_WIDTHS * onward).mean()) > _INKED
