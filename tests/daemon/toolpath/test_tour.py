"""A tour through segments gets shorter and stays a tour."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from daemon.toolpath import tour
from daemon.toolpath.doors import nearest_doors
from daemon.toolpath.tour import improve

START, END = np.array([0.0, 0.0]), np.array([100.0, 0.0])


def travelled(ends: NDArray[np.float64], codes: list[int]) -> float:
    doors = ends.reshape(-1, 2)
    stops = [START, *(doors[door] for code in codes for door in (code, code ^ 1)), END]
    return float(sum(np.hypot(*(b - a)) for a, b in list(pairwise(stops))[::2]))


def random_ends(count: int, seed: int = 0) -> NDArray[np.float64]:
    rng = np.random.default_rng([count, seed])
    return rng.uniform(0, 100, (count, 1, 2)) + rng.normal(0, 5, (count, 2, 2))


@settings(max_examples=40, deadline=None)
@given(st.integers(1, 30), st.integers(0, 1000))
def test_every_segment_is_walked_once_and_the_tour_is_no_longer(count: int, seed: int) -> None:
    ends = random_ends(count, seed)
    codes = improve(ends, start=START, end=END).tolist()
    assert sorted(code >> 1 for code in codes) == list(range(count))
    assert travelled(ends, codes) <= travelled(ends, list(range(0, 2 * count, 2))) + 1e-6


def test_a_tour_that_may_end_anywhere_is_shorter_than_one_that_has_an_end_left_out() -> None:
    def without_the_way_back(codes: NDArray[np.int64]) -> float:
        stops = [START, *(ends.reshape(-1, 2)[door] for code in codes.tolist() for door in (code, code ^ 1))]
        return float(sum(np.hypot(*(b - a)) for a, b in list(pairwise(stops))[::2]))

    free = bound = 0.0
    for ends in (random_ends(20, seed) for seed in range(5)):
        free += without_the_way_back(improve(ends, start=START, end=None))
        bound += without_the_way_back(improve(ends, start=START, end=START))
    assert free < 0.97 * bound


def test_kicks_make_a_tour_shorter_than_its_moves_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    ends = [random_ends(60, seed) for seed in range(5)]
    kicked = sum(travelled(each, improve(each, start=START, end=END).tolist()) for each in ends)
    monkeypatch.setattr(tour, "_MOST_KICKS", 0)
    settled = sum(travelled(each, improve(each, start=START, end=END).tolist()) for each in ends)
    assert kicked < 0.97 * settled


def test_the_nearest_doors_are_found_and_their_own_segment_is_none_of_them() -> None:
    doors = random_ends(400).reshape(-1, 2)
    near = nearest_doors(doors, 5)
    for door in range(0, 800, 37):
        away = np.hypot(*(doors - doors[door]).T)
        away[[door, door ^ 1]] = np.inf
        assert [other for other, _ in near[door]] == np.argsort(away)[:5].tolist()
        assert [far for _, far in near[door]] == pytest.approx(np.sort(away)[:5])


def test_segments_on_one_place_have_neighbours() -> None:
    assert [len(near) for near in nearest_doors(np.zeros((8, 2)), 5)] == [5] * 8
