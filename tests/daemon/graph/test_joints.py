"""Edges are joined where a corner is no bend."""

from __future__ import annotations

import numpy as np
import pytest

from daemon.graph.joints import joined

Corners = list[tuple[float, float]]


def ends_after(corners: Corners, pairs: list[tuple[int, int]]) -> list[list[int]]:
    vertices = np.array(corners, float)
    polylines, ends, members = joined([vertices[list(pair)] for pair in pairs], np.array(pairs), vertices)
    for polyline, (start, end) in zip(polylines, ends, strict=True):
        assert np.array_equal(polyline[[0, -1]], vertices[[start, end]])
    assert sorted(edge for made_of in members for edge in made_of) == list(range(len(pairs)))
    return [sorted(pair) for pair in ends.tolist()]


def test_a_false_corner_between_short_edges_is_passed() -> None:
    assert ends_after([(0, 0), (8, 1), (16, 0)], [(0, 1), (2, 1)]) == [[0, 2]]


@pytest.mark.parametrize(("y", "edges"), [(2, [[0, 2]]), (8, [[0, 1], [1, 2]])])
def test_between_long_edges_a_small_bend_is_a_corner(y: float, edges: list[list[int]]) -> None:
    assert ends_after([(0, 0), (40, 0), (80, y)], [(0, 1), (1, 2)]) == edges


def test_a_sharp_bend_is_a_corner() -> None:
    assert ends_after([(0, 0), (8, 0), (8, 8)], [(0, 1), (1, 2)]) == [[0, 1], [1, 2]]


def test_edges_that_meet_a_third_stay_apart() -> None:
    star = [(0, 1), (1, 2), (1, 3)]
    assert ends_after([(0, 0), (8, 0), (16, 0), (8, 8)], star) == [[0, 1], [1, 2], [1, 3]]


def test_a_ring_keeps_one_vertex() -> None:
    ring = [(20 * np.cos(a), 20 * np.sin(a)) for a in np.linspace(0, 2 * np.pi, 16, endpoint=False)]
    assert ends_after(ring, [(i, (i + 1) % 16) for i in range(16)]) == [[0, 0]]
