"""The mean of the lines channel along a pair of vertices."""

from __future__ import annotations

import numpy as np
import pytest

from daemon.graph.plausibility import pairs_on_ink, plausibilities

LINES = np.zeros((30, 60), np.float32)
LINES[9:12, 10:30] = 1.0


def eta(p: tuple[float, float], q: tuple[float, float], **options: float) -> float:
    return float(plausibilities(LINES, np.array([p], float), np.array([q], float), **{"width_px": 1.8, **options})[0])


def test_a_line_along_its_ink_is_certain() -> None:
    assert eta((10, 10), (29, 10)) == 1.0


def test_half_a_line_is_half_as_plausible() -> None:
    assert eta((10, 10), (49, 10)) == pytest.approx(0.5)


def test_a_strip_wider_than_the_line_sees_the_paper_beside_it() -> None:
    assert eta((10, 10), (29, 10), width_px=9.0) == pytest.approx(1 / 3)


def test_a_wide_strip_is_seen_at_every_pixel_across() -> None:
    assert eta((10, 10), (29, 10), width_px=7.0) == pytest.approx(3 / 7)


def test_trimmed_ends_do_not_count() -> None:
    assert eta((7, 10), (32, 10)) < 0.8
    assert eta((7, 10), (32, 10), trim_px=3.0) == 1.0


def test_outside_the_page_there_is_nothing() -> None:
    assert eta((-20, 10), (-5, 10)) == 0.0


def test_no_pair_has_no_plausibility() -> None:
    nothing = np.empty((0, 2))
    assert plausibilities(LINES, nothing, nothing, width_px=1.8).shape == (0,)


def test_pairs_without_ink_between_them_are_left_out() -> None:
    vertices = np.array([[10, 10], [29, 10], [20, 25], [12, 10]], float)
    assert sorted(pairs_on_ink(vertices, LINES > 0).tolist()) == [[0, 1], [0, 3], [1, 3]]


def test_pairs_far_apart_are_left_out() -> None:
    vertices = np.array([[10, 10], [29, 10], [12, 10]], float)
    assert pairs_on_ink(vertices, LINES > 0, within_px=5.0).tolist() == [[0, 2]]
