"""Filled areas."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from daemon.page.fills import hollow
from daemon.page.prepare import prepare
from daemon.shapes import Grey, PageImage
from tests.daemon.page.pages import page

_WIDTH_PX = 3


def with_lines() -> Grey:
    grey = np.full((300, 300), 255, np.uint8)
    cv2.rectangle(grey, (10, 10), (290, 290), 0, _WIDTH_PX)
    cv2.line(grey, (10, 270), (290, 260), 0, _WIDTH_PX, cv2.LINE_AA)
    return grey


def with_disc(radius_px: int) -> PageImage:
    grey = with_lines()
    cv2.circle(grey, (150, 130), radius_px, 0, -1, cv2.LINE_AA)
    return replace(page(grey), line_width_px=float(_WIDTH_PX))


def with_letter() -> PageImage:
    grey = with_lines()
    for corner, other in (((80, 60), (125, 205)), ((80, 160), (190, 205))):
        cv2.rectangle(grey, corner, other, 0, -1)
    return replace(page(grey), line_width_px=float(_WIDTH_PX))


def test_of_a_black_disc_the_rim_is_left_as_wide_as_a_line() -> None:
    found = hollow(with_disc(50))
    assert [step.words for step in found.steps] == ["1 filled area is drawn as outlines"]
    assert found.grey[130, 150] == 255
    row = found.grey[130, 90:150] < 128
    assert row.sum() == pytest.approx(_WIDTH_PX, abs=1)


def test_of_a_black_letter_the_outline_is_left() -> None:
    found = hollow(with_letter())
    assert len(found.steps) == 1
    assert found.grey[100, 95] == 255
    assert found.grey[100, 80] == 0


def test_skip_leaves_nothing_of_a_filled_area_and_all_lines() -> None:
    found = hollow(with_disc(50), fill="skip")
    assert np.array_equal(found.grey, with_lines())


@pytest.mark.parametrize("radius_px", [2, 8, 15])
def test_a_dot_is_no_filled_area(radius_px: int) -> None:
    given = with_disc(radius_px)
    assert hollow(given) is given


def test_the_long_stroke_of_a_marker_beside_a_pen_is_no_filled_area() -> None:
    grey = with_lines()
    way = np.array([[40, 220], [40, 40], [150, 40], [260, 40], [260, 220]])
    cv2.polylines(grey, [way], False, 0, 39, cv2.LINE_AA)
    given = replace(page(grey), line_width_px=float(_WIDTH_PX))
    assert hollow(given) is given


def test_a_drawing_of_a_thick_marker_holds_no_filled_area() -> None:
    grey = np.full((400, 400), 255, np.uint8)
    cv2.polylines(grey, [np.array([[60, 330], [60, 80], [200, 200], [340, 80]])], False, 0, 28, cv2.LINE_AA)
    assert prepare(page(grey)).steps == ()
