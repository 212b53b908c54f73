"""The ink of a page and its centre line."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

from daemon.ink import ink_mask, ink_threshold, thin
from daemon.shapes import Grey

masks = arrays(bool, st.tuples(st.integers(1, 14), st.integers(1, 14)))


def page_with_line(*, paper: int = 255, ink: int = 0, width_px: int = 3, noise: float = 0.0) -> Grey:
    grey = np.full((96, 128), paper, np.uint8)
    cv2.line(grey, (16, 20), (110, 70), ink, width_px, cv2.LINE_AA)
    grain = np.random.default_rng(0).normal(0.0, noise, grey.shape) if noise else 0.0
    return np.clip(grey + grain, 0, 255).astype(np.uint8)


def pieces(mask: NDArray[np.bool_], connectivity: int) -> int:
    return int(cv2.connectedComponents(np.pad(mask.astype(np.uint8), 1), connectivity=connectivity)[0])


def test_ink_ends_half_way_between_paper_and_ink() -> None:
    threshold = ink_threshold(page_with_line(paper=250, ink=10, width_px=9))
    assert threshold == pytest.approx(130, abs=8)


def test_faint_pencil_on_grainy_paper_is_ink() -> None:
    clean = ink_mask(page_with_line(paper=220, ink=160))
    grainy = ink_mask(page_with_line(paper=220, ink=160, noise=6.0))
    assert (grainy ^ clean).sum() < 0.1 * clean.sum()


@pytest.mark.parametrize("level", [0, 90, 255])
def test_a_page_of_one_tone_holds_no_ink(level: int) -> None:
    assert not ink_mask(np.full((40, 50), level, np.uint8)).any()


def test_grain_alone_is_no_ink() -> None:
    grain = np.random.default_rng(1).normal(200, 8, (200, 200)).astype(np.uint8)
    assert ink_mask(grain).mean() < 0.001


def test_a_page_without_pixels_holds_no_ink() -> None:
    assert ink_mask(np.zeros((0, 7), np.uint8)).shape == (0, 7)


def test_more_ink_than_paper_is_still_ink() -> None:
    grey = np.full((60, 60), 20, np.uint8)
    grey[20:30] = 240
    assert np.array_equal(ink_mask(grey), grey == 20)


def test_a_thick_line_thins_to_one_pixel_a_column() -> None:
    bar = np.zeros((30, 80), bool)
    bar[10:19, 5:75] = True
    centre = thin(bar)
    assert np.array_equal(np.flatnonzero(centre[:, 15:65].any(axis=1)), [14])


def test_a_dot_thins_to_one_pixel() -> None:
    for side in (1, 2, 3, 4, 7):
        dot = np.zeros((12, 12), bool)
        dot[2 : 2 + side, 3 : 3 + side] = True
        assert thin(dot).sum() == 1


def test_ink_that_fills_the_page_to_its_rim_is_thinned() -> None:
    assert 0 < thin(np.ones((40, 60), bool)).sum() <= 60


@given(masks)
def test_thinning_keeps_every_piece_and_every_hole(mask: NDArray[np.bool_]) -> None:
    centre = thin(mask)
    assert not (centre & ~mask).any()
    assert pieces(centre, 8) == pieces(mask, 8)
    assert pieces(~np.pad(centre, 1), 4) == pieces(~np.pad(mask, 1), 4)


@given(masks)
def test_thinning_equals_the_published_algorithm_run_over_the_whole_page(mask: NDArray[np.bool_]) -> None:
    assert np.array_equal(thin(mask), guo_hall(mask))


def guo_hall(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Guo and Hall 1989, A1, on whole arrays until two passes in a row change nothing."""
    centre, idle, even = np.pad(mask, 1), 0, False
    while idle < 2:
        gone = removable(centre, even=even)
        idle = 0 if gone.any() else idle + 1
        centre &= ~gone
        even = not even
    return centre[1:-1, 1:-1]


def removable(centre: NDArray[np.bool_], *, even: bool) -> NDArray[np.bool_]:
    turns = [(1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1), (0, 1), (1, 1)]
    p2, p3, p4, p5, p6, p7, p8, p9 = (np.roll(centre, turn, (0, 1)) for turn in turns)
    c = (~p2 & (p3 | p4)) * 1 + (~p4 & (p5 | p6)) + (~p6 & (p7 | p8)) + (~p8 & (p9 | p2))
    n1 = (p9 | p2) * 1 + (p3 | p4) + (p5 | p6) + (p7 | p8)
    n2 = (p2 | p3) * 1 + (p4 | p5) + (p6 | p7) + (p8 | p9)
    n = np.minimum(n1, n2)
    m = (p6 | p7 | ~p9) & p8 if even else (p2 | p3 | ~p5) & p4
    return centre & (c == 1) & (n >= 2) & (n <= 3) & ~m
