"""Where a traced line turns at once and not in a curve."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from daemon.polyline import lengths_along, places_at
from daemon.shapes import Points

_REACH_ERRORS = 8.0
_LEAST_TURN_RAD = math.radians(35.0)
_AT_ONCE = 0.75
"""A curve turns half as much over half the reach, a corner as much over any."""


def corners(trace: Points, *, error_mm: float) -> NDArray[np.intp]:
    """The inner points of a polyline on which it turns by 35 degrees or more within a few times the error.

    trace: (N, 2) in mm, N >= 2, no point twice in a row. Of corners nearer to each other than that the sharpest.
    """
    along = lengths_along(trace)
    reach_mm = _REACH_ERRORS * error_mm
    turns, near = _turns(trace, along, reach_mm), _turns(trace, along, reach_mm / 2)
    sharp = np.flatnonzero((turns >= _LEAST_TURN_RAD) & (near >= _AT_ONCE * turns))
    found: list[int] = []
    for index in sharp[np.argsort(-near[sharp], kind="stable")].tolist():
        if all(abs(along[index] - along[other]) >= reach_mm for other in found):
            found.append(index)
    return np.array(sorted(found), np.intp)


def _turns(trace: Points, along: NDArray[np.float64], reach_mm: float) -> NDArray[np.float64]:
    """By how much the way to each point and the way from it differ in direction, in rad; 0 at the ends."""
    back, on = (places_at(along + side * reach_mm, trace, along) for side in (-1, 1))
    before, after = trace - back, on - trace
    turns = np.abs(np.arctan2(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0], (before * after).sum(axis=1)))
    turns[[0, -1]] = 0.0
    return np.asarray(turns, np.float64)
