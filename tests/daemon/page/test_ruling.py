"""Printed lines."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from daemon.page.ruling import take_off_ruling
from daemon.shapes import Grey
from tests.daemon.page.pages import drawn, grain, page

SIDE_PX = 600
INK = drawn(width_px=5, side_px=SIDE_PX) < 128


def ruled(
    *,
    pitch: float = 30,
    slope: float = 0.0,
    dark: float = 0.25,
    squared: bool = False,
    fan: float = 0.0,
    grain_sigma: float = 2,
) -> Grey:
    """The rings and the cross on printed paper; dark: the share of the light that the print takes."""
    print_px = np.zeros((SIDE_PX, SIDE_PX), np.uint8)
    for row in np.arange(-SIDE_PX, 2 * SIDE_PX, pitch):
        turn = slope + fan * (row / SIDE_PX - 0.5)
        ends = ((0, row - turn * SIDE_PX / 2), (SIDE_PX, row + turn * SIDE_PX / 2))
        fixed = [tuple(round(16 * each) for each in end) for end in ends]
        cv2.line(print_px, fixed[0], fixed[1], 255, 2, cv2.LINE_AA, 4)
    both = np.maximum(print_px, print_px.T[:, ::-1]) if squared else print_px
    bare = 1 - dark * both.astype(float) / 255
    return grain(
        np.asarray(np.rint(drawn(width_px=5, side_px=SIDE_PX, ink=30, paper=240) * bare), np.uint8), grain_sigma
    )


@pytest.mark.parametrize(
    "grey",
    [
        pytest.param(ruled(), id="ruled"),
        pytest.param(ruled(squared=True), id="squared"),
        pytest.param(ruled(slope=0.03, squared=True), id="askew"),
        pytest.param(ruled(fan=0.06), id="seen from an angle"),
        pytest.param(ruled(dark=0.45), id="dark"),
    ],
)
def test_printed_lines_go_and_ink_on_them_stays(grey: Grey) -> None:
    bare = take_off_ruling(page(grey)).grey
    away = cv2.dilate(INK.astype(np.uint8), np.ones((9, 9), np.uint8)) == 0
    assert (grey[away] < 215).mean() > 0.02
    assert (bare[away] < 215).mean() < 0.008
    assert np.percentile(bare[away], 0.1) > 170
    inside = cv2.erode(INK.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    assert np.percentile(bare[inside], 99) < 90


@pytest.mark.parametrize(
    "grey",
    [
        pytest.param(ruled(dark=0.95), id="as dark as the drawing"),
        pytest.param(grain(drawn(paper=240, side_px=SIDE_PX), 2), id="no print"),
        pytest.param(drawn(side_px=SIDE_PX), id="clean"),
        pytest.param(ruled(grain_sigma=0), id="painted"),
        pytest.param(grain(np.full((SIDE_PX, SIDE_PX), 240, np.uint8), 2), id="empty"),
    ],
)
def test_what_is_no_print_stays(grey: Grey) -> None:
    given = page(grey)
    assert take_off_ruling(given) is given


def test_faint_lines_at_uneven_distances_are_drawn_ones() -> None:
    grey = drawn(width_px=5, side_px=SIDE_PX, ink=30, paper=240)
    for row in (40, 75, 160, 190, 285, 440, 466, 560):
        cv2.line(grey, (0, row), (SIDE_PX, row), 180, 2)
    given = page(grain(grey, 2))
    assert take_off_ruling(given) is given
