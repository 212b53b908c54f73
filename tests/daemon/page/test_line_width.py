"""The pen's line width, and the page brought to it."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from daemon.homography import through
from daemon.page.line_width import fit_line_width, line_width_px
from daemon.shapes import Grey, Homography, PageImage, Points
from tests.daemon.page.pages import drawn, grain, page


@pytest.mark.parametrize("width_px", [1.5, 2, 3, 4, 6, 10])
@pytest.mark.parametrize("ink", [0, 120])
def test_the_width_of_a_line_is_found(width_px: float, ink: int) -> None:
    assert line_width_px(drawn(width_px=width_px, ink=ink)) == pytest.approx(width_px, rel=0.1)


@pytest.mark.parametrize("width_px", [20, 40])
def test_the_width_of_a_marker_is_found(width_px: float) -> None:
    grey = np.full((700, 700), 255, np.uint8)
    cv2.circle(grey, (350, 350), 250, 0, round(width_px))
    assert line_width_px(grey) == pytest.approx(width_px, rel=0.1)


@pytest.mark.parametrize("first", range(28, 36))
def test_a_square_has_its_width_wherever_it_lies(first: int) -> None:
    grey = np.full((128, 128), 255, np.uint8)
    grey[first : first + 68, first : first + 68] = 0
    grey[first + 3 : first + 65, first + 3 : first + 65] = 255
    assert line_width_px(grey) == pytest.approx(3, rel=0.4)


def test_the_lower_rim_of_a_line_counts_where_the_next_cell_begins() -> None:
    grey = np.full((128, 128), 255, np.uint8)
    for row in (32, 64, 96):
        grey[row - 2 : row, 10:118] = 0
    assert line_width_px(grey) == pytest.approx(2, rel=0.1)


def test_grain_changes_the_width_little() -> None:
    assert line_width_px(grain(drawn(width_px=3), 6)) == pytest.approx(3, rel=0.1)


def test_a_filled_area_does_not_outvote_the_lines() -> None:
    grey = drawn(width_px=3, side_px=400)
    grey[20:380, 20:120] = 0
    assert line_width_px(grey) == pytest.approx(3, rel=0.1)


def test_a_scribble_of_melted_lines_is_no_wide_line() -> None:
    grey = drawn(width_px=3, side_px=256)
    for x in range(20, 236, 4):
        cv2.line(grey, (x, 70 + x % 50), (x, 190 - x % 30), 0, 3)
    assert line_width_px(grey) == pytest.approx(3, rel=0.15)


@pytest.mark.parametrize("level", [0, 255])
def test_a_page_without_ink_has_no_width_and_stays(level: int) -> None:
    given = page(np.full((40, 40), level, np.uint8))
    assert line_width_px(given.grey) is None
    assert fit_line_width(given) is given


@pytest.mark.parametrize("width_px", [2, 2.5, 3.3])
def test_lines_that_are_right_are_left_alone(width_px: float) -> None:
    given = page(drawn(width_px=width_px))
    fitted = fit_line_width(given)
    assert fitted.grey is given.grey
    assert fitted.line_width_px == pytest.approx(width_px, rel=0.08)


@pytest.mark.parametrize("width_px", [0.8, 5, 12, 30])
def test_other_lines_come_to_about_two_and_a_half_px(width_px: float) -> None:
    fitted = fit_line_width(page(drawn(width_px=width_px, side_px=512)))
    assert fitted.line_width_px == pytest.approx(2.5)
    assert line_width_px(fitted.grey) == pytest.approx(2.5, rel=0.25)


def test_pale_remains_of_printed_lines_do_not_count() -> None:
    grey = drawn(width_px=5, side_px=512)
    pale = np.full_like(grey, 255)
    pale[::16] = 200
    assert line_width_px(np.minimum(grey, pale)) == pytest.approx(5, rel=0.25)


def test_a_small_picture_with_lines_that_are_a_little_wide_is_not_reduced() -> None:
    small, large = (fit_line_width(page(drawn(width_px=3.8, side_px=side_px))) for side_px in (256, 1024))
    assert small.grey.shape == (256, 256)
    assert large.line_width_px == pytest.approx(2.5)


def middle_of_dot(grey: Grey) -> Points:
    ink = 255.0 - grey
    y, x = np.indices(grey.shape)
    return np.array([[np.average(x, weights=ink), np.average(y, weights=ink)]])


def to_given(fitted: PageImage, points: Points) -> Points:
    return through(fitted.to_given, points)


@pytest.mark.parametrize(("width", "height"), [(301, 203), (300, 200)])
@pytest.mark.parametrize("radius", [1, 9])
def test_the_way_back_leads_to_the_same_place(width: int, height: int, radius: int) -> None:
    grey = np.full((height, width), 255, np.uint8)
    cv2.circle(grey, (211, 57), radius, 0, -1)
    fitted = fit_line_width(page(grey))
    assert fitted.grey.shape != grey.shape
    assert to_given(fitted, middle_of_dot(fitted.grey)) == pytest.approx(np.array([[211, 57]]), abs=0.03)


def test_the_way_back_goes_on_through_what_was_done_before() -> None:
    before: Homography = np.array([[2.0, 0, 7], [0, 2, 9], [0, 0, 1]])
    given = page(drawn(width_px=6))
    alone, after = fit_line_width(given), fit_line_width(replace(given, to_given=before))
    corner = np.array([[10.0, 20.0]])
    assert to_given(after, corner) == pytest.approx(2 * to_given(alone, corner) + (7, 9))


def test_a_page_is_not_enlarged_beyond_4096_px() -> None:
    grey = np.full((64, 3000), 255, np.uint8)
    cv2.line(grey, (10, 32), (2990, 32), 120, 1)
    assert fit_line_width(page(grey)).grey.shape[1] <= 4096


def test_a_large_page_is_reduced_as_far_as_its_lines_allow() -> None:
    grey = np.full((100, 8000), 255, np.uint8)
    grey[49:52, 10:7990] = 0
    fitted = fit_line_width(page(grey))
    assert fitted.line_width_px == pytest.approx(1.8, rel=0.03)
    assert fitted.grey.shape[1] == pytest.approx(8000 * 0.6, rel=0.03)
