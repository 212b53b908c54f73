"""Lines that share points are joined so that the pen travels less, and stay the same lines."""

from __future__ import annotations

from itertools import groupby

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from daemon.shapes import Stroke
from daemon.toolpath.order import order
from daemon.toolpath.rejoin import rejoined
from tests.daemon.toolpath.test_order import END, START, line, segments, travelled

knots = st.tuples(st.integers(0, 3), st.integers(0, 3)).map(lambda place: (10.0 * place[0], 10.0 * place[1]))
walks = st.lists(knots, min_size=1, max_size=6).map(lambda stops: line(*(place for place, _ in groupby(stops))))
"""Strokes between few places, which they share."""


@settings(max_examples=100, deadline=None)
@given(st.lists(walks, min_size=1, max_size=7))
@example([line((0, 10)), line((20, 0)), line((0, 0), (10, 0)), line((0, 10), (30, 0), (0, 10)),
          line((30, 30), (10, 0), (0, 20))])  # fmt: skip
def test_every_line_is_drawn_once_with_no_more_travel_or_fewer_lifts(
    strokes: list[Stroke],
) -> None:
    tour = order(strokes, start_mm=START, end_mm=END)
    joined = rejoined(tour, start_mm=START, end_mm=END)
    assert segments(joined) == segments(strokes)
    assert len(joined) <= len(strokes)
    assert travelled(joined) <= travelled(tour) + 1e-6 or len(joined) < len(strokes)
    assert sum(len(stroke.points) == 1 for stroke in joined) == sum(len(stroke.points) == 1 for stroke in strokes)


def test_strokes_that_share_no_point_stay_as_they_are() -> None:
    tour = [line((0, 0), (10, 0)), line((10, 5), (0, 5), (0, 9)), line((3, 3))]
    assert rejoined(tour, start_mm=START, end_mm=END) == tuple(tour)


def test_no_stroke_stays_none() -> None:
    assert rejoined((), start_mm=START, end_mm=END) == ()


@settings(max_examples=20, deadline=None)
@given(st.lists(walks, min_size=1, max_size=7))
def test_the_same_strokes_give_the_same_lines(strokes: list[Stroke]) -> None:
    one, other = (rejoined(strokes, start_mm=START, end_mm=END) for _ in range(2))
    assert all(np.array_equal(a.points, b.points) for a, b in zip(one, other, strict=True))


def test_tails_are_exchanged_at_a_crossing_where_that_saves_travel() -> None:
    """From the west end to the east end: with two corners only the way from the north end to the south end is left."""
    along, across = line((0, 20), (20, 20), (40, 20)), line((20, 15), (20, 20), (20, 25))
    tour = order([along, across], start_mm=(0, 20), end_mm=(40, 20))
    joined = rejoined(tour, start_mm=(0, 20), end_mm=(40, 20))
    assert travelled(tour, (0, 20), (40, 20)) > 40
    assert travelled(joined, (0, 20), (40, 20)) == pytest.approx(10)


def test_lines_go_straight_on_where_a_corner_saves_nothing() -> None:
    east, north = line((0, 10), (10, 10), (20, 10)), line((10, 0), (10, 10), (10, 20))
    tour = order([east, north], start_mm=(0, 10), end_mm=(10, 0))
    assert [stroke.points.tolist() for stroke in rejoined(tour, start_mm=(0, 10), end_mm=(10, 0))] == [
        stroke.points.tolist() for stroke in tour
    ]


@pytest.mark.parametrize(("arm", "straight"), [(2.0, True), (6.0, False)])
def test_a_corner_is_drawn_only_where_it_saves_more_than_a_millimetre(arm: float, straight: bool) -> None:
    """From the west end to the east end by way of the north and the south end: two corners save 0.4 or 3.3 mm."""
    along, across = line((0, 20), (20, 20), (20 + arm, 20)), line((20, 10), (20, 20), (20, 30))
    begin, end = (0.0, 20.0), (20.0 + arm, 20.0)
    tour = rejoined(order([along, across], start_mm=begin, end_mm=end), start_mm=begin, end_mm=end)
    bends = [np.abs(np.diff(stroke.points, 2, axis=0)).min() for stroke in tour]
    assert [bend == 0 for bend in bends] == [straight, straight]


def test_strokes_that_end_where_others_begin_become_one() -> None:
    parts = [line((0, 0), (10, 0)), line((20, 5), (10, 0)), line((20, 5), (30, 0))]
    (joined,) = rejoined(order(parts, start_mm=START, end_mm=END), start_mm=START, end_mm=END)
    assert joined.points.tolist() == [[0, 0], [10, 0], [20, 5], [30, 0]]


def test_pens_are_not_mixed() -> None:
    red, blue = Stroke(np.array([[0.0, 0], [10, 0]]), pen=1), Stroke(np.array([[10.0, 0], [20, 0]]), pen=2)
    joined = rejoined([red, blue], start_mm=START, end_mm=END)
    assert sorted((stroke.pen, *stroke.points[:, 0]) for stroke in joined) == [(1, 0, 10), (2, 10, 20)]


def test_a_dot_on_a_line_stays_a_dot() -> None:
    joined = rejoined([line((0, 0), (10, 0)), line((10, 0)), line((10, 0), (20, 0))], start_mm=START, end_mm=END)
    assert sorted(len(stroke.points) for stroke in joined) == [1, 3]


def test_a_tour_that_may_end_anywhere_needs_no_way_back() -> None:
    lines = [line((0, 20), (20, 20), (40, 20)), line((20, 15), (20, 20), (20, 25))]
    free = rejoined(order(lines, start_mm=(0, 20), end_mm=None), start_mm=(0, 20), end_mm=None)
    assert travelled(free, (0, 20), tuple(free[-1].points[-1].tolist())) == pytest.approx(10)


def test_a_mesh_is_drawn_with_the_fewest_lifts_and_nearly_the_least_travel() -> None:
    """Spokes of a wheel: twelve odd rim points, six strokes; the least travel pairs neighbours on the rim."""
    rim = [(50 + 40 * np.cos(a), 50 + 40 * np.sin(a)) for a in np.linspace(0, 2 * np.pi, 12, endpoint=False)]
    spokes = [line((50.0, 50.0), end) for end in rim]
    tour = rejoined(order(spokes, start_mm=rim[0], end_mm=rim[1]), start_mm=rim[0], end_mm=rim[1])
    assert len(tour) == 6
    assert travelled(tour, rim[0], rim[1]) == pytest.approx(6 * np.hypot(*np.subtract(rim[1], rim[0])), rel=0.2)
