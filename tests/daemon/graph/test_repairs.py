"""The rules that refuse an edge."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from daemon.graph.anchors import nearest
from daemon.graph.bends import sharpened
from daemon.graph.repairs import clear_of_corners, filled, redundant, suppressed, without_gap


def points(*values: tuple[float, float]) -> np.ndarray:
    return np.array(values, float)


def barred(gap_px: int) -> np.ndarray:
    ink = np.zeros((20, 60), bool)
    ink[9:12, 5:55] = True
    ink[:, 30 : 30 + gap_px] = False
    return ink


@pytest.mark.parametrize(("gap_px", "kept"), [(0, True), (2, True), (5, False)])
def test_ink_missing_along_an_edge_refuses_it(gap_px: int, kept: bool) -> None:
    assert without_gap(barred(gap_px), points((5, 10)), points((54, 10))).tolist() == [kept]


@pytest.mark.parametrize(("y", "kept"), [(10, True), (11.6, False)])
def test_an_edge_along_the_border_of_a_line_is_not_filled(y: float, kept: bool) -> None:
    assert filled(barred(0), points((5, y)), points((54, y)), width_px=3.0).tolist() == [kept]


@pytest.mark.parametrize(
    ("between", "known", "refused"),
    [((30, 10), [], True), ((30, 12.4), [[0, 1], [1, 2]], True), ((30, 12.4), [[0, 1]], False), ((30, 15), [], False)],
)
def test_an_edge_does_not_pass_by_a_corner(between: tuple[float, float], known: list[list[int]], refused: bool) -> None:
    corners = points((5, 10), between, (54, 10))
    near = nearest(corners, (20, 60), within_px=3.0)
    pairs, joined = np.array([[0, 2]]), np.array(known, np.intp).reshape(-1, 2)
    assert suppressed(corners, pairs, joined, near).tolist() == [refused]


def test_what_the_quick_look_refuses_suppression_refuses_too() -> None:
    corners = np.random.default_rng(1).uniform(0, 99, (60, 2))
    near, pairs = nearest(corners, (100, 100), within_px=3.0), np.argwhere(np.triu(np.ones((60, 60), bool), 1))
    none_known = np.empty((0, 2), np.intp)
    refused = ~clear_of_corners(corners, pairs, near)
    assert refused.sum() > 100
    # Both look up the nearest corner of whole pixels, at different places: a pair that grazes one may differ.
    assert suppressed(corners, pairs[refused], none_known, near).mean() > 0.98


def test_on_a_page_full_of_ink_few_pairs_are_clear_of_corners() -> None:
    clear = []
    for count in (200, 800):
        corners = np.random.default_rng(count).uniform(0, 199, (count, 2))
        near, pairs = (
            nearest(corners, (200, 200), within_px=3.0),
            np.argwhere(np.triu(np.ones((count, count), bool), 1)),
        )
        clear.append(clear_of_corners(corners, pairs, near).sum() / count)
    assert clear[1] < 0.5 * clear[0] < 25


def test_an_edge_that_others_cover_is_dropped_and_only_one_of_two() -> None:
    starts, ends = points((5, 10), (5, 10), (30, 10), (5, 15)), points((54, 10), (30, 10), (54, 10), (54, 15))
    assert redundant((20, 60), starts, ends, np.array([0, 1, 2, 3])).tolist() == [True, False, False, False]


def test_the_tip_of_a_sharp_bend_comes_back() -> None:
    ink = np.zeros((60, 60), np.uint8)
    cv2.polylines(ink, [np.array([[20, 50], [30, 10], [40, 50]], np.int32)], False, 1, 3)
    rounded = [(20 + i / 4, 50 - i) for i in range(36)] + [(30, 14.5)] + [(31.25 + i / 4, 15 + i) for i in range(36)]
    before, after = sharpened(points(*rounded), ink > 0)
    assert np.array_equal(before[-1], after[0])
    assert np.abs(before[-1] - (30, 10)).max() < 0.8


def test_a_tip_without_ink_is_not_invented() -> None:
    blunt = points(*[(20 + i / 4, 50 - i) for i in range(36)], *[(31.25 + i / 4, 15 + i) for i in range(36)])
    (whole,) = sharpened(blunt, np.zeros((60, 60), bool))
    assert np.array_equal(whole, blunt)
