"""Random strokes for property tests."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from daemon.shapes import Points, Stroke

coordinates = st.floats(0, 100, allow_nan=False).map(lambda value: round(value, 3))
places = st.tuples(coordinates, coordinates)


def polylines(*, least: int = 1, most: int = 12) -> st.SearchStrategy[Points]:
    return st.lists(places, min_size=least, max_size=most).map(lambda rows: np.array(rows, float))


def open_or_closed() -> st.SearchStrategy[Stroke]:
    closed = polylines(least=3).map(lambda points: np.vstack([points, points[:1]]))
    return (polylines() | closed).map(Stroke)


def hausdorff_mm(one: Points, other: Points, *, step_mm: float = 0.05) -> float:
    """How far any place of one polyline is from the other at most, looked at every step_mm."""
    return max(_furthest(one, other, step_mm), _furthest(other, one, step_mm))


def _furthest(one: Points, other: Points, step_mm: float) -> float:
    starts, along = other[:-1], np.diff(other, axis=0)
    if len(other) == 1:
        starts, along = other, np.zeros((1, 2))
    square = np.maximum((along * along).sum(axis=1), 1e-18)
    furthest = 0.0
    places = _places(one, step_mm)
    for first in range(0, len(places), 500):
        off = places[first : first + 500, None] - starts
        part = np.clip((off * along).sum(axis=2) / square, 0, 1)
        away = off - part[..., None] * along
        furthest = max(furthest, float((away * away).sum(axis=2).min(axis=1).max()))
    return float(np.sqrt(furthest))


def _places(line: Points, step_mm: float) -> Points:
    lengths = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    at = np.union1d(lengths, np.linspace(0, lengths[-1], int(lengths[-1] / step_mm) + 2))
    return np.stack([np.interp(at, lengths, axis) for axis in line.T], axis=1)
