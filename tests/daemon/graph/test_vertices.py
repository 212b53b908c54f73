"""Corners of the segmentation become vertices, one a disc."""

from __future__ import annotations

import numpy as np
import pytest

from daemon.graph.vertices import DISC, centroids, corner_vertices
from daemon.shapes import Map


def corners_at(*places: tuple[int, int]) -> Map:
    corners = np.zeros((40, 40), np.float32)
    for x, y in places:
        corners[y + DISC[:, 1], x + DISC[:, 0]] = 1
    return corners


ALL_INK = np.ones((40, 40), bool)


def test_a_disc_is_a_vertex_at_its_centre() -> None:
    assert centroids(corners_at((10, 12))).tolist() == [[10, 12]]
    assert corner_vertices(corners_at((10, 12)), ALL_INK).tolist() == [[10, 12]]


@pytest.mark.parametrize("second", [(11, 12), (12, 12), (13, 12), (10, 15), (13, 14), (14, 12), (12, 15)])
def test_melted_discs_are_split(second: tuple[int, int]) -> None:
    melted = corners_at((10, 12), second)
    assert len(centroids(melted)) == 1
    assert sorted(corner_vertices(melted, ALL_INK).tolist()) == sorted([[10, 12], [*second]])


def test_three_discs_in_a_row_are_three_vertices() -> None:
    row = corners_at((10, 12), (14, 12), (18, 12))
    assert sorted(corner_vertices(row, ALL_INK).tolist()) == [[10, 12], [14, 12], [18, 12]]


def test_a_corner_away_from_the_ink_is_no_vertex() -> None:
    ink = np.zeros((40, 40), bool)
    ink[30, 5:35] = True
    assert corner_vertices(corners_at((10, 12), (20, 30)), ink)[:, 0].tolist() == [20]


def test_no_corner_is_no_vertex() -> None:
    assert corner_vertices(np.zeros((40, 40), np.float32), ALL_INK).shape == (0, 2)
