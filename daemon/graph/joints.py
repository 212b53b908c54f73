"""Edges that go straight on through a vertex of degree two are one edge: a corner that is no bend is no corner."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from daemon.graph.plausibility import Floats
from daemon.graph.skeleton import Indices
from daemon.polyline import lengths_along, places_at
from daemon.shapes import Points

_SPAN_PX = 7.0
"""Distance before and after a vertex over which the turn is measured: a disc a pixel off its place turns little."""
_SHORT_DEGREES = 25.0
_LONG_PX, _LONG_DEGREES = 12.0, 8.0
"""Between two edges as long as this the turn is known better."""


@dataclass(frozen=True, slots=True, eq=False)
class _Piece:
    """A polyline between two vertices and the edges that it is made of."""

    line: Points
    start: int
    end: int
    members: tuple[int, ...]


def joined(
    polylines: list[Points], ends: Indices, vertices: Points
) -> tuple[list[Points], Indices, list[tuple[int, ...]]]:
    """The edges with those joined that meet in a vertex of degree two and hardly turn there.

    Hardly: by less than 25 degrees, between two edges of 12 px or more by less than 8.

    polylines: (N, 2) each, from vertex to vertex. ends: (E, 2) indices of their vertices. Returns polylines, ends, and
    for each edge the given ones that it is made of. A ring keeps one vertex.
    A network strings false corners along curves; each would hold its edges away from the ridge of the ink.
    """
    halves = _half_edges(ends, len(vertices))
    through = [len(half) == 2 and half[0] >> 1 != half[1] >> 1 for half in halves]
    mates = {a: b for pair, go in zip(halves, through, strict=True) if go for a, b in (pair, pair[::-1])}
    pieces: list[_Piece] = []
    for walk in _walks(mates, len(ends)):
        pieces += _cut(walk, polylines, ends)
    joined_ends = np.array([(piece.start, piece.end) for piece in pieces], np.intp).reshape(-1, 2)
    return [piece.line for piece in pieces], joined_ends, [piece.members for piece in pieces]


def _half_edges(ends: Indices, count: int) -> list[list[int]]:
    """For each vertex the half-edges that leave it: 2 i from the start of edge i, 2 i + 1 from its end."""
    halves: list[list[int]] = [[] for _ in range(count)]
    for index, (start, end) in enumerate(ends.tolist()):
        halves[start].append(2 * index)
        halves[end].append(2 * index + 1)
    return halves


def _walks(mates: dict[int, int], edges: int) -> list[list[int]]:
    """Maximal walks through vertices of degree two, open ones first."""
    seen = [False] * edges
    walks = []
    for half in [*(h for h in range(2 * edges) if h not in mates), *range(0, 2 * edges, 2)]:
        walk: list[int] = []
        onward: int | None = half
        while onward is not None and not seen[onward >> 1]:
            seen[onward >> 1] = True
            walk.append(onward)
            onward = mates.get(onward ^ 1)
        if walk:
            walks.append(walk)
    return walks


def _cut(walk: list[int], polylines: list[Points], ends: Indices) -> list[_Piece]:
    """The polyline of a walk, cut at the vertices where it turns."""
    parts = [polylines[half >> 1][:: -1 if half & 1 else 1] for half in walk]
    stops = [int(ends[half >> 1, half & 1]) for half in walk] + [int(ends[walk[-1] >> 1, 1 - (walk[-1] & 1)])]
    if len(walk) == 1:
        return [_Piece(parts[0], stops[0], stops[1], (walk[0] >> 1,))]
    line = np.concatenate([parts[0], *(part[1:] for part in parts[1:])])
    rows = np.cumsum([0, *(len(part) - 1 for part in parts)])
    lengths = np.array([np.hypot(*np.diff(part, axis=0).T).sum() for part in parts])
    certain = np.minimum(lengths[:-1], lengths[1:]) >= _LONG_PX
    bent = np.flatnonzero(_turns(line, rows) >= np.where(certain, _LONG_DEGREES, _SHORT_DEGREES)) + 1
    kept = [0, *bent.tolist(), len(walk)]
    return [
        _Piece(line[rows[a] : rows[b] + 1], stops[a], stops[b], tuple(half >> 1 for half in walk[a:b]))
        for a, b in pairwise(kept)
    ]


def _turns(line: Points, rows: Indices) -> Floats:
    """The turn in degrees at each inner row, between the points 7 px before and after it."""
    along = lengths_along(line)
    at = along[rows[1:-1]]
    before, here, after = (places_at(at + step, line, along) for step in (-_SPAN_PX, 0.0, _SPAN_PX))
    (ux, uy), (vx, vy) = (here - before).T, (after - here).T
    return np.asarray(np.degrees(np.abs(np.arctan2(ux * vy - uy * vx, ux * vx + uy * vy))))
