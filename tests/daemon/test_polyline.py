"""Lengths along a polyline, and its places at them."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from daemon.polyline import lengths_along, places_at

CORNER = np.array([[0, 0], [3, 4], [3, 10]], float)


def test_lengths_grow_from_point_to_point() -> None:
    assert lengths_along(CORNER).tolist() == [0, 5, 11]
    assert lengths_along(CORNER[:1]).tolist() == [0]


def test_places_lie_between_the_points_and_never_beyond_the_ends() -> None:
    found = places_at(np.array([-1, 2.5, 8, 12]), CORNER, lengths_along(CORNER))
    assert found.tolist() == [[0, 0], [1.5, 2], [3, 7], [3, 10]]


@given(st.lists(st.tuples(st.integers(-999, 999), st.integers(-999, 999)), min_size=1, max_size=20, unique=True))
def test_at_the_lengths_of_its_points_the_line_is_at_its_points_bit_by_bit(points: list[tuple[int, int]]) -> None:
    line = np.array(points, float) / 7
    along = lengths_along(line)
    assert (places_at(along, line, along) == line).all()
