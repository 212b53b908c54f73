"""Lengths along a polyline, and its places at given lengths."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from daemon.shapes import Points

Lengths = NDArray[np.float64]


def lengths_along(line: Points) -> Lengths:
    """(N,) float64: how far along the line each of its points (N, 2) lies from the first, in the unit of the points."""
    return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])


def places_at(stops: Lengths, line: Points, along: Lengths) -> Points:
    """(M, 2): where the line is after these lengths (M,); before its first and after its last point stand these.

    along: as `lengths_along` gives it.
    """
    return np.stack([np.interp(stops, along, side) for side in line.T], axis=1)
