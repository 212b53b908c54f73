"""A polyline with fewer points that never leaves the given one by more than a stated error."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from daemon.shapes import Points


def simplify(points: Points, *, error: float) -> Points:
    """The polyline reduced by Ramer, Douglas and Peucker (1972, 1973): no given point lies further than error from it.

    points: (N, 2) float64, N >= 1, any unit; error: in the same unit, >= 0. Returns (M, 2), a subset of the points
    in their order, first and last among them. A closed polyline stays closed; one that lies all within error of its
    first point becomes that point; what runs back over its own line is not drawn twice. Iterative: no recursion limit
    bounds its length. Raises ValueError when there is no point or error is negative.
    """
    if len(points) == 0 or error < 0:
        raise ValueError(f"a polyline of {len(points)} points cannot be simplified with error {error}: give points")
    points = _without_repeats(points)
    keep = np.zeros(len(points), bool)
    keep[[0, -1]] = True
    spans = [(0, len(points) - 1)]
    while spans:
        first, last = spans.pop()
        furthest = _furthest(points[first : last + 1], error)
        if furthest is not None:
            keep[first + furthest] = True
            spans += [(first, first + furthest), (first + furthest, last)]
    return _without_repeats(points[keep])


def _without_repeats(points: Points) -> Points:
    moved = np.ones(len(points), bool)
    moved[1:] = (points[1:] != points[:-1]).any(axis=1)
    return points[moved]


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
