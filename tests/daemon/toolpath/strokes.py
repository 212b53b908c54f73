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
