"""Random strokes for property tests."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

from daemon.shapes import Points, Stroke

coordinates = st.floats(0, 100, allow_nan=False).map(lambda value: round(value, 3))
places = st.tuples(coordinates, coordinates)


def polylines(*, least: int = 1, most: int = 12) -> st.SearchStrategy[Points]:
    return st.lists(places, min_size=least, max_size=most).map(lambda rows: np.array(rows, float))


def open_or_closed() -> st.SearchStrategy[Stroke]:
    closed = polylines(least=3).map(lambda points: np.vstack([points, points[:1]]))
    return (polylines() | closed).map(Stroke)


@st.composite
def curves(draw: st.DrawFn) -> Points:
    """Traced lines: a few waves along both axes, what tracing leaves of noise, open or closed, with a corner or not."""
    count = draw(st.integers(20, 150))
    t = np.linspace(0, 1, count)
    waves = draw(st.lists(st.tuples(st.floats(0.2, 6), st.integers(1, 4), st.floats(0, 7)), min_size=2, max_size=4))
    axes = [sum((a * np.sin(math.tau * n * t + p) for a, n, p in waves[k::2]), np.zeros(count)) for k in (0, 1)]
    points = np.stack(axes, axis=1)
    if draw(st.booleans()):
        points[count // 3 :] += np.outer(np.arange(count - count // 3), draw(st.tuples(*[st.floats(-0.2, 0.2)] * 2)))
    noise_mm = draw(st.sampled_from([0.0, 0.005, 0.03]))
    points += np.random.default_rng(draw(st.integers(0, 99))).normal(0, noise_mm, points.shape)
    return points


def hausdorff_mm(one: Points, other: Points, *, step_mm: float = 0.05) -> float:
    """How far any place of one polyline is from the other at most, looked at every step_mm."""
    there = nearest_mm(_places(one, step_mm), other).max()
    return max(float(there), float(nearest_mm(_places(other, step_mm), one).max()))


def nearest_mm(places: Points, line: Points) -> NDArray[np.float64]:
    """How far each place is from a polyline."""
    starts, along = (line[:-1], np.diff(line, axis=0)) if len(line) > 1 else (line, np.zeros((1, 2)))
    square = np.maximum((along * along).sum(axis=1), 1e-18)
    found = []
    for first in range(0, len(places), 500):
        off = places[first : first + 500, None] - starts
        part = np.clip((off * along).sum(axis=2) / square, 0, 1)
        away = off - part[..., None] * along
        found.append(np.sqrt((away * away).sum(axis=2).min(axis=1)))
    return np.concatenate(found)


def _places(line: Points, step_mm: float) -> Points:
    lengths = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    at = np.union1d(lengths, np.linspace(0, lengths[-1], int(lengths[-1] / step_mm) + 2))
    return np.stack([np.interp(at, lengths, axis) for axis in line.T], axis=1)
