"""Exact distances from points to the nearest of other points, by a grid of cells."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from daemon.shapes import Points

_CELL_PX = 2.0
_CHUNK = 200_000
_AROUND = [(dx, dy) for dx in (-1, 0, 1) for dy in (-1, 0, 1)]


def nearest_px(points: Points, others: Points) -> NDArray[np.float64]:
    """Distance of each of `points` (N, 2) to the nearest of `others` (M, 2), M >= 1."""
    best = _in_cells_around(points, others)
    # What lies in the cells around is the nearest for certain only when it is no further than a cell is wide.
    far = np.nonzero(best > _CELL_PX)[0]
    step = max(1, _CHUNK * 20 // len(others))
    for first in range(0, len(far), step):
        some = far[first : first + step]
        best[some] = _least(points[some], others)
    return best


def _least(points: Points, others: Points) -> NDArray[np.float64]:
    dx, dy = points[:, None, 0] - others[None, :, 0], points[:, None, 1] - others[None, :, 1]
    return np.asarray(np.sqrt((dx * dx + dy * dy).min(axis=1)))


def _in_cells_around(points: Points, others: Points) -> NDArray[np.float64]:
    corner = np.minimum(points.min(axis=0), others.min(axis=0)) - _CELL_PX
    wide = int((max(points[:, 0].max(), others[:, 0].max()) - corner[0]) / _CELL_PX) + 3
    mine, theirs = _keys(points, corner, wide), _keys(others, corner, wide)
    order = np.argsort(theirs, kind="stable")
    theirs, others = theirs[order], others[order]
    best = np.full(len(points), np.inf)
    for dx, dy in _AROUND:
        first = np.searchsorted(theirs, mine + dx + dy * wide, "left")
        last = np.searchsorted(theirs, mine + dx + dy * wide, "right")
        _lower(best, points, others, first, last - first)
    return best


def _keys(points: Points, corner: Points, wide: int) -> NDArray[np.int64]:
    column, row = ((points - corner) / _CELL_PX).astype(np.int64).T
    return np.asarray(row * wide + column)


def _lower(
    best: NDArray[np.float64], points: Points, others: Points, first: NDArray[np.intp], count: NDArray[np.intp]
) -> None:
    """Lower `best` by each point's candidates, others[first : first + count], in place."""
    some = np.nonzero(count)[0]
    if not len(some):
        return
    pairs, begin = count[some], np.cumsum(count[some]) - count[some]
    within = np.arange(pairs.sum()) - np.repeat(begin, pairs)
    off = np.repeat(points[some], pairs, axis=0) - others[np.repeat(first[some], pairs) + within]
    least = np.minimum.reduceat(np.hypot(off[:, 0], off[:, 1]), begin)
    best[some] = np.minimum(best[some], least)
