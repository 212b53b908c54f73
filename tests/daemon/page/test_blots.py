"""Blots: what is one, its rim, and the line that inks its inside."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import cv2
import numpy as np
import pytest

from daemon.page.blots import rimmed
from daemon.shapes import Grey, PageImage
from tests.daemon.page.pages import page

_WIDTH_PX, _FINE = 3.0, 8


def paper() -> Grey:
    """Fine paper and a line along its lower edge."""
    fine = np.full((_FINE * 120, _FINE * 160), 255, np.uint8)
    cv2.line(fine, (0, _FINE * 110), (_FINE * 160, _FINE * 110), 0, round(_FINE * _WIDTH_PX))
    return fine


def seen(fine: Grey) -> PageImage:
    grey = np.asarray(cv2.resize(fine, None, fx=1 / _FINE, fy=1 / _FINE, interpolation=cv2.INTER_AREA), np.uint8)
    return replace(page(grey), line_width_px=_WIDTH_PX)


def disc(across_widths: float) -> PageImage:
    fine = paper()
    cv2.circle(fine, (_FINE * 60, _FINE * 50), round(across_widths * _WIDTH_PX * _FINE / 2), 0, -1)
    return seen(fine)


def filled(*corners: tuple[int, int]) -> PageImage:
    fine = paper()
    cv2.fillPoly(fine, [_FINE * np.array(corners, np.int32)], 0)
    return seen(fine)


def inked(given: PageImage) -> Grey:
    """What is left of the page, and its fills drawn by its pen."""
    drawn = cv2.resize(given.grey, None, fx=_FINE, fy=_FINE, interpolation=cv2.INTER_LINEAR)
    for line in given.fills:
        points = np.rint((line + 0.5) * _FINE).astype(np.int32)
        cv2.polylines(drawn, [points], False, 0, round(_FINE * _WIDTH_PX))
    return np.asarray(cv2.resize(drawn, given.grey.shape[::-1], interpolation=cv2.INTER_AREA), np.uint8)


@pytest.mark.parametrize("across_widths", [4.0, 5.0, 8.0, 11.0])
def test_of_a_disc_the_rim_is_left_and_one_line_inks_it_full(across_widths: float) -> None:
    given = disc(across_widths)
    found = rimmed(given)
    assert [step.words for step in found.steps] == ["1 small filled area is inked to and fro"]
    assert found.grey[50, 60] == 255
    row = 255 - found.grey[50, : 60 + 1].astype(float)
    assert row.sum() / 255 == pytest.approx(_WIDTH_PX, abs=0.6)
    assert len(found.fills) == 1
    black, drawn = given.grey < 128, inked(found) < 128
    assert (black & drawn).sum() >= 0.98 * black.sum()
    assert not (drawn & (given.grey > 250)).any()


def test_the_line_goes_to_and_fro_as_far_apart_as_a_pen_is_wide() -> None:
    (line,) = rimmed(disc(10.0)).fills
    ways = [after - before for before, after in pairwise(line[::2] + np.diff(line, axis=0)[::2] / 2)]
    across = np.array([1.0, 1.0]) / np.sqrt(2)
    assert np.abs(np.array(ways) @ across) == pytest.approx(0.85 * _WIDTH_PX, abs=0.2)


@pytest.mark.parametrize(
    "corners",
    [
        ((40, 30), (64, 30), (64, 54), (40, 54)),
        ((40, 30), (70, 42), (40, 54)),
        ((30, 30), (62, 30), (62, 48), (30, 48)),
    ],
)
def test_squares_heads_of_arrows_and_short_bars_are_blots(corners: tuple[tuple[int, int], ...]) -> None:
    given = filled(*corners)
    found = rimmed(given)
    black = given.grey < 128
    assert len(found.fills) == 1
    assert (black & (inked(found) < 128)).sum() >= 0.98 * black.sum()


@pytest.mark.parametrize("across_widths", [1.0, 2.0, 3.0])
def test_a_dot_is_none(across_widths: float) -> None:
    given = disc(across_widths)
    assert rimmed(given) is given


def test_the_stroke_of_a_thick_brush_is_none() -> None:
    given = filled((20, 40), (140, 40), (140, 58), (20, 58))
    assert rimmed(given) is given


def test_the_ink_where_many_lines_meet_is_none() -> None:
    fine = paper()
    for angle in np.linspace(0, np.pi, 12, endpoint=False):
        way = 45 * _FINE * np.array([np.cos(angle), np.sin(angle)])
        ends = (np.array([80, 52]) * _FINE + np.stack([-way, way])).astype(int).tolist()
        cv2.line(fine, ends[0], ends[1], 0, round(_FINE * _WIDTH_PX))
    given = seen(fine)
    assert rimmed(given) is given


def test_lines_that_end_on_a_blot_and_blots_beside_each_other_stay_as_they_are() -> None:
    fine = paper()
    for x in (40, 62):
        cv2.circle(fine, (_FINE * x, _FINE * 70), _FINE * 10, 0, -1)
        cv2.line(fine, (_FINE * (x + 8), _FINE * 70), (_FINE * (x + 8), _FINE * 20), 0, round(_FINE * _WIDTH_PX))
    given = seen(fine)
    found = rimmed(given)
    assert [step.words for step in found.steps] == ["2 small filled areas are inked to and fro"]
    assert len(found.fills) == 2
    assert np.array_equal(found.grey[:58], given.grey[:58])
    assert found.grey[70, 40] == found.grey[70, 62] == 255


def test_a_page_whose_lines_nobody_has_measured_comes_back_as_it_is() -> None:
    given = replace(disc(8.0), line_width_px=None)
    assert rimmed(given) is given


def test_a_screen_of_dots_is_left_as_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    given = seen(paper())
    grey = given.grey.copy()
    for place in ((20, 30), (60, 30), (100, 30)):
        cv2.circle(grey, place, 10, 0, -1)
    given = replace(given, grey=grey)
    assert len(rimmed(given).steps) == 1
    monkeypatch.setattr("daemon.page.blots._MOST", 2)
    assert rimmed(given) is given
