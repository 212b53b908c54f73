"""Strokes in an order with little travel."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from itertools import permutations, product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from daemon.shapes import Points, Stroke, Toolpath
from daemon.toolpath.order import order
from tests.daemon.toolpath.strokes import open_or_closed, places

START, END = (0.0, 0.0), (50.0, 0.0)


def travelled(strokes: Sequence[Stroke], start: tuple[float, float] = START, end: tuple[float, float] = END) -> float:
    return Toolpath(tuple(strokes), np.zeros((2, 3)), start, end).travelled_mm


def segments(strokes: Sequence[Stroke]) -> Counter[tuple[tuple[float, ...], ...]]:
    """What is drawn, whatever the order and direction."""
    return Counter(
        tuple(sorted(map(tuple, pair)))
        for stroke in strokes
        for pair in zip(stroke.points.tolist(), stroke.points.tolist()[1:], strict=False)
    )


def line(*points: tuple[float, float]) -> Stroke:
    return Stroke(np.array(points, float))


def random_lines(count: int) -> list[Stroke]:
    rng = np.random.default_rng(count)
    middles = rng.uniform(0, 100, (count, 1, 2))
    return [Stroke(points) for points in middles + rng.normal(0, 3, (count, 2, 2))]


@settings(max_examples=60)
@given(st.lists(open_or_closed(), max_size=8), places, places)
def test_no_stroke_is_lost_and_nothing_new_is_drawn(
    strokes: list[Stroke], start: tuple[float, float], end: tuple[float, float]
) -> None:
    ordered = order(strokes, start_mm=start, end_mm=end)
    assert len(ordered) == len(strokes)
    assert segments(ordered) == segments(strokes)
    assert sorted(len(stroke.points) for stroke in ordered) == sorted(len(stroke.points) for stroke in strokes)


@settings(max_examples=60)
@given(st.lists(open_or_closed(), max_size=8))
def test_travel_is_never_longer_than_in_the_given_order(strokes: list[Stroke]) -> None:
    assert travelled(order(strokes, start_mm=START, end_mm=END)) <= travelled(strokes) + 1e-9


@settings(max_examples=30)
@given(st.lists(open_or_closed(), max_size=6))
def test_the_same_strokes_give_the_same_order(strokes: list[Stroke]) -> None:
    one, other = (order(strokes, start_mm=START, end_mm=END) for _ in range(2))
    assert all(np.array_equal(a.points, b.points) for a, b in zip(one, other, strict=True))


def test_a_stroke_is_begun_at_its_nearer_end() -> None:
    (drawn,) = order([line((9, 0), (1, 0))], start_mm=(0, 0), end_mm=(10, 0))
    assert drawn.points.tolist() == [[1, 0], [9, 0]]


def test_a_closed_stroke_is_begun_where_the_way_through_it_is_shortest() -> None:
    square = line((10, 10), (20, 10), (20, 20), (10, 20), (10, 10))
    (drawn,) = order([square], start_mm=(25, 25), end_mm=(25, 25))
    assert drawn.points.tolist() == [[20, 20], [10, 20], [10, 10], [20, 10], [20, 20]]


def test_four_strokes_get_the_best_order_of_all() -> None:
    for seed in range(20):
        rng = np.random.default_rng(seed)
        strokes = [Stroke(points) for points in rng.uniform(0, 100, (4, 2, 2))]
        best = min(travelled(walk) for walk in every_walk(strokes))
        assert travelled(order(strokes, start_mm=START, end_mm=END)) <= 1.0001 * best


def every_walk(strokes: list[Stroke]) -> list[list[Stroke]]:
    def walked(stroke: Stroke, backwards: bool) -> Stroke:
        return Stroke(stroke.points[::-1]) if backwards else stroke

    return [
        [walked(stroke, flip) for stroke, flip in zip(chosen, flips, strict=True)]
        for chosen in permutations(strokes)
        for flips in product((False, True), repeat=len(strokes))
    ]


@pytest.mark.parametrize(("count", "most_mm"), [(100, 620), (300, 985)])
def test_random_strokes_are_travelled_nearly_as_shortly_as_is_known(count: int, most_mm: float) -> None:
    assert travelled(order(random_lines(count), start_mm=(0, 0), end_mm=(0, 0)), (0, 0), (0, 0)) < most_mm


def test_a_tour_may_end_anywhere() -> None:
    near, far = line((10, 0), (10, 5)), line((-90, 0), (-90, 5))
    assert [stroke.points[0, 0] for stroke in order([far, near], start_mm=(0, 0), end_mm=None)] == [10, -90]
    assert [stroke.points[0, 0] for stroke in order([far, near], start_mm=(0, 0), end_mm=(10, 0))] == [-90, 10]
    square = line((5, 5), (9, 5), (9, 9), (5, 9), (5, 5))
    (drawn,) = order([square], start_mm=(10, 10), end_mm=None)
    assert drawn.points[0].tolist() == [9, 9]


def test_dots_and_no_strokes_at_all_are_fine() -> None:
    dots = [line((5, 5)), line((1, 1)), line((3, 3))]
    assert [stroke.points[0, 0] for stroke in order(dots, start_mm=(0, 0), end_mm=(9, 9))] == [1, 3, 5]
    assert order([], start_mm=(0, 0), end_mm=(0, 0)) == ()


def test_a_pen_stays_with_its_stroke() -> None:
    points: Points = np.array([[9.0, 0], [1, 0]])
    assert order([Stroke(points, pen=2)], start_mm=(0, 0), end_mm=(9, 9))[0].pen == 2
