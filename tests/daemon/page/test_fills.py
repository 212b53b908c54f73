"""Filled areas."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from daemon.page.fills import hollow
from daemon.page.hatch import Hatch
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


def hatched(*, angle_deg: float = 45.0, cross: bool = False) -> tuple[PageImage, PageImage, Grey]:
    """A disc with a round hole, the page that was made of it, and its hatch alone, drawn by a pen as wide as a line."""
    grey = with_lines()
    cv2.circle(grey, (150, 130), 90, 0, -1, cv2.LINE_AA)
    cv2.circle(grey, (165, 120), 30, 255, -1, cv2.LINE_AA)
    given = replace(page(grey), line_width_px=float(_WIDTH_PX))
    found = hollow(given, fill=Hatch(6.0, angle_deg, cross))
    fine = np.full((8 * 300, 8 * 300), 255, np.uint8)
    for line in found.hatching:
        cv2.polylines(fine, [np.rint(line * 8 + 3.5).astype(np.int32)], False, 0, 8 * _WIDTH_PX)
    return given, found, np.asarray(cv2.resize(fine, (300, 300), interpolation=cv2.INTER_AREA), np.uint8)


@pytest.mark.parametrize(("cross", "covered"), [(False, 0.5), (True, 0.75)])
def test_a_hatch_covers_an_area_as_its_spacing_says_and_leaves_no_ink_beside_it(cross: bool, covered: float) -> None:
    """Lines 3 px wide, 6 px apart, cover a half; crossed, half of what is left, too."""
    given, found, drawn = hatched(cross=cross)
    assert [step.words for step in found.steps] == ["1 filled area is hatched"]
    inside = cv2.erode((given.grey < 128).astype(np.uint8), np.ones((25, 25), np.uint8)) > 0
    assert (255 - drawn[inside].astype(float)).mean() / 255 == pytest.approx(covered, abs=0.06)
    assert not (drawn[given.grey > 128] < 200).any()
    assert found.grey[130, 80] == 255


def test_a_hatch_is_drawn_in_few_lines_and_goes_round_a_hole() -> None:
    assert 2 <= len(hatched()[1].hatching) <= 6


@pytest.mark.parametrize("angle_deg", [0.0, 30.0, -60.0])
def test_a_hatch_rises_to_the_right_by_its_angle(angle_deg: float) -> None:
    steps = np.concatenate([np.diff(line, axis=0) for line in hatched(angle_deg=angle_deg)[1].hatching])
    longest = steps[np.hypot(*steps.T).argmax()]
    assert np.degrees(np.arctan(-longest[1] / longest[0])) == pytest.approx(angle_deg, abs=1.0)
