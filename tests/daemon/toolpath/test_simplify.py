"""Polylines with fewer points, within a stated error."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from daemon.shapes import Points
from daemon.toolpath.simplify import shared_points, simplify
from tests.daemon.toolpath.strokes import polylines

errors = st.floats(0, 20)


def distance(points: Points, polyline: Points) -> Points:
    """Of each point to the polyline."""
    a, b = (polyline, polyline) if len(polyline) == 1 else (polyline[:-1], polyline[1:])
    along = b - a
    share = ((points[:, None] - a) * along).sum(-1) / np.maximum((along**2).sum(-1), 1e-12)
    foot = a + np.clip(share, 0, 1)[..., None] * along
    off: Points = np.linalg.norm(points[:, None] - foot, axis=-1).min(axis=1)
    return off


@given(polylines(most=40), errors)
def test_no_given_point_lies_further_than_the_error_from_the_result(points: Points, error: float) -> None:
    assert distance(points, simplify(points, error=error)).max() <= error + 1e-6


@given(polylines(most=40), errors)
def test_ends_stay_exactly_where_they_were(points: Points, error: float) -> None:
    result = simplify(points, error=error)
    assert (result[0] == points[0]).all()
    assert (result[-1] == points[-1]).all()


@given(polylines(most=40), errors)
def test_the_result_is_never_longer_and_repeats_no_point(points: Points, error: float) -> None:
    result = simplify(points, error=error)
    lengths = [np.linalg.norm(np.diff(some, axis=0), axis=1) for some in (points, result)]
    assert lengths[1].sum() <= lengths[0].sum() + 1e-9
    assert (lengths[1] > 0).all()


@given(st.integers(0, 10_000), st.integers(2, 9), st.floats(0.1, 60))
def test_segments_are_as_long_as_the_machine_resolves_but_for_the_only_one(
    seed: int, count: int, shortest: float
) -> None:
    points = np.random.default_rng(seed).uniform(0, 100, (count, 2))
    result = simplify(points, error=0.0, shortest=shortest)
    assert (result[[0, -1]] == points[[0, -1]]).all()
    assert len(result) == 2 or np.linalg.norm(np.diff(result, axis=0), axis=1).min() >= shortest


@given(polylines(most=40), errors, st.floats(0.1, 20))
def test_points_left_out_for_shortness_add_no_more_than_that_to_the_error(
    points: Points, error: float, shortest: float
) -> None:
    assert distance(points, simplify(points, error=error, shortest=shortest)).max() <= error + shortest + 1e-6


def test_a_ring_shorter_than_the_machine_resolves_is_a_dot() -> None:
    assert len(simplify(np.array([[0.0, 0], [0.01, 0], [0.01, 0.01], [0, 0]]), error=0.0, shortest=0.02)) == 1


@given(polylines(most=20), st.integers(0, 19), errors, st.floats(0.1, 20))
def test_a_point_that_must_stay_stays(points: Points, index: int, error: float, shortest: float) -> None:
    kept = np.arange(len(points)) == min(index, len(points) - 1)
    result = simplify(points, error=error, kept=kept, shortest=shortest)
    assert (result == points[kept]).all(axis=1).any()


def test_shared_points_are_those_that_occur_twice() -> None:
    one, other = np.array([[0.0, 0], [5, 5], [9, 9]]), np.array([[5.0, 5], [7, 7], [0, 1]])
    loop = np.array([[3.0, 3], [4, 4], [3, 3]])
    assert [mask.tolist() for mask in shared_points([one, other, loop])] == [
        [False, True, False],
        [True, False, False],
        [True, False, True],
    ]


def test_a_straight_line_keeps_its_two_ends() -> None:
    line = np.linspace([0, 0], [30, 10], 1000)
    assert np.array_equal(simplify(line, error=1e-6), line[[0, -1]])


def test_a_path_that_folds_back_beyond_its_end_keeps_the_fold() -> None:
    assert len(simplify(np.array([[0.0, 0], [10, 0], [5, 0]]), error=0.05)) == 3


def test_a_circle_stays_closed() -> None:
    angle = np.linspace(0, 2 * np.pi, 400)
    circle = 10 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    circle[-1] = circle[0]
    result = simplify(circle, error=0.05)
    assert (result[0] == result[-1]).all()
    assert 12 < len(result) < 64


def test_a_ring_smaller_than_the_error_is_a_dot() -> None:
    assert len(simplify(np.array([[0.0, 0], [0.01, 0], [0.01, 0.01], [0, 0]]), error=0.05)) == 1


def test_a_zigzag_deeper_than_the_recursion_limit_needs_no_recursion() -> None:
    zigzag = np.stack([np.arange(5000.0), np.arange(5000) % 2 * 10.0], axis=1)
    assert len(simplify(zigzag, error=0.05)) == 5000


@pytest.mark.parametrize(("points", "error"), [(np.zeros((0, 2)), 1.0), (np.zeros((3, 2)), -1.0)])
def test_no_point_or_a_negative_error_is_refused(points: Points, error: float) -> None:
    with pytest.raises(ValueError, match="give points"):
        simplify(points, error=error)
