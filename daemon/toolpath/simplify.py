"""A polyline with fewer points that never leaves the given one by more than a stated error."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from daemon.shapes import Points


def simplify(points: Points, *, error: float, kept: NDArray[np.bool_] | None = None, shortest: float = 0.0) -> Points:
    """The polyline reduced by Ramer, Douglas and Peucker (1972, 1973): no given point lies further than error from it.

    points: (N, 2) float64, N >= 1, any unit; error, shortest: in the same unit, >= 0. kept: (N,) points that stay, as
    the first and the last do. Returns (M, 2), a subset of the points in their order. A point nearer than `shortest` to
    the one before is left out where it may be; the result is then off by `shortest` more. A closed polyline stays
    closed; one that lies all within error of its first point becomes that point; what runs back over its own line is
    not drawn twice. Iterative: no recursion limit bounds its length. Raises ValueError when there is no point or error
    is negative.
    """
    if len(points) == 0 or error < 0:
        raise ValueError(f"a polyline of {len(points)} points cannot be simplified with error {error}: give points")
    fixed = np.zeros(len(points), bool) if kept is None else kept.copy()
    fixed[[0, -1]] = True
    points, fixed = _without_repeats(points, fixed)
    chosen = _chosen(points, np.flatnonzero(fixed).tolist(), error)
    points, fixed = _without_repeats(points[chosen], fixed[chosen])
    return _long_enough(points, fixed, shortest) if shortest > 0 else points


def shared_points(polylines: Sequence[Points]) -> list[NDArray[np.bool_]]:
    """For each polyline which of its points are crossings: points that the polylines hold more than once."""
    every = np.concatenate([np.empty((0, 2)), *polylines])
    _, which, counts = np.unique(every, axis=0, return_inverse=True, return_counts=True)
    more = counts[which.reshape(-1)] > 1
    return np.split(more, np.cumsum([len(polyline) for polyline in polylines], dtype=np.intp))[:-1]


def _chosen(points: Points, fixed: list[int], error: float) -> NDArray[np.bool_]:
    """Which points stay: the fixed ones, and between them those that lie too far from what is drawn without them."""
    keep = np.zeros(len(points), bool)
    keep[fixed] = True
    spans = list(pairwise(fixed))
    while spans:
        first, last = spans.pop()
        furthest = _furthest(points[first : last + 1], error)
        if furthest is not None:
            keep[first + furthest] = True
            spans += [(first, first + furthest), (first + furthest, last)]
    return keep


def _without_repeats(points: Points, fixed: NDArray[np.bool_]) -> tuple[Points, NDArray[np.bool_]]:
    moved = np.ones(len(points), bool)
    moved[1:] = (points[1:] != points[:-1]).any(axis=1)
    # Of a run of equal points the first stays, fixed when any of them is.
    fixed = np.logical_or.reduceat(fixed, np.flatnonzero(moved))
    return points[moved], fixed


def _long_enough(points: Points, fixed: NDArray[np.bool_], shortest: float) -> Points:
    """Without the points that lie nearer than `shortest` to the one before or to a fixed one after them."""
    kept: list[int] = []
    for index, row in enumerate(points):
        if kept and not fixed[index] and math.dist(row, points[kept[-1]]) < shortest:
            continue
        while kept and not fixed[kept[-1]] and math.dist(row, points[kept[-1]]) < shortest:
            kept.pop()
        kept.append(index)
    return _without_repeats(points[kept], fixed[kept])[0]


def _furthest(points: Points, error: float) -> int | None:
    """Index of the inner point furthest from the segment between the ends; None when all lie within error."""
    if len(points) < 3:
        return None
    distances = _distances_to_segment(points[1:-1], points[0], points[-1])
    index = int(np.argmax(distances))
    return index + 1 if distances[index] > error else None


def _distances_to_segment(points: Points, a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """Distance of each point to the segment ab, not to its line: a path may fold back beyond an end."""
    along = b - a
    squared = float(along @ along)
    share = np.clip((points - a) @ along / squared, 0.0, 1.0) if squared > 0 else np.zeros(len(points))
    off = points - a - share[:, None] * along
    return np.hypot(off[:, 0], off[:, 1])
