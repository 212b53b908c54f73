"""A sheet on a desk."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from daemon.homography import through
from daemon.page.sheet import straighten
from daemon.shapes import Grey, Points
from tests.daemon.page.pages import drawn, grain, in_shadow, page

SQUARE = np.array([[60, 40], [330, 70], [310, 350], [40, 300]], float)


def on_desk(corners: Points, *, side_px: int = 400, desk: int = 70, sheet: int = 215) -> Grey:
    """The rings and the cross on a sheet of 256 px, its corners in the picture where they are said to lie."""
    ink = drawn(width_px=3, paper=sheet, ink=30)
    turn = cv2.getPerspectiveTransform(
        np.array([[0, 0], [255, 0], [255, 255], [0, 255]], np.float32), corners.astype(np.float32)
    )
    lying = cv2.warpPerspective(ink, turn, (side_px, side_px), flags=cv2.INTER_AREA, borderValue=desk)
    return grain(np.asarray(lying, np.uint8), 3)


def turned(degrees: float) -> Points:
    angle = np.radians(degrees + np.array([225, 315, 45, 135]))
    return np.stack([200 + 170 * np.cos(angle), 200 + 170 * np.sin(angle)], axis=1)


@pytest.mark.parametrize(
    "corners",
    [
        pytest.param(SQUARE, id="from an angle"),
        pytest.param(turned(0), id="straight"),
        pytest.param(turned(17), id="askew"),
        pytest.param(turned(44), id="at 44 degrees"),
    ],
)
def test_a_sheet_on_a_desk_becomes_the_page(corners: Points) -> None:
    straight = straighten(page(on_desk(corners)))
    height, width = straight.grey.shape
    found = through(straight.to_given, np.array([[0, 0], [width - 1, 0], [width - 1, height - 1], [0, height - 1]]))
    assert np.abs(found - corners).max() < 7
    assert np.percentile(straight.grey, 99.5) - np.median(straight.grey) < 20
    assert (straight.grey < 110).mean() < 0.2


def test_what_is_drawn_leads_back_to_where_it_lies_in_the_picture() -> None:
    straight = straighten(page(on_desk(SQUARE)))
    y, x = np.nonzero(straight.grey < 90)
    inked = np.rint(through(straight.to_given, np.stack([x, y], axis=1).astype(float))).astype(int)
    assert (on_desk(SQUARE)[inked[:, 1], inked[:, 0]] < 150).mean() > 0.97


def test_a_shadow_across_sheet_and_desk_is_no_side() -> None:
    grey = on_desk(SQUARE)
    grey[:, 180:] = grey[:, 180:] // 2
    height, width = straighten(page(grey)).grey.shape
    assert width == pytest.approx(270, abs=12)
    assert height == pytest.approx(280, abs=12)


def test_of_a_sheet_that_leaves_the_picture_the_desk_is_left_out() -> None:
    grey = on_desk(np.array([[120, -90], [600, -60], [580, 560], [90, 520]], float))
    bare = straighten(page(grey))
    assert bare.grey.shape == grey.shape
    assert np.array_equal(bare.to_given, np.eye(3))
    assert bare.grey[:, :80].min() > 150
    assert np.array_equal(bare.grey[:, 150:], grey[:, 150:])


def framed(thick: int) -> Grey:
    return np.asarray(cv2.rectangle(grain(drawn(paper=225, side_px=400), 3), (50, 40), (350, 360), 20, thick), np.uint8)


@pytest.mark.parametrize(
    "grey",
    [
        pytest.param(drawn(), id="clean"),
        pytest.param(framed(3), id="drawn rectangle"),
        pytest.param(framed(14), id="thick rectangle"),
        pytest.param(grain(in_shadow(drawn(paper=220), 0.5), 4), id="uneven light"),
        pytest.param(np.full((400, 400), 20, np.uint8), id="black"),
        pytest.param(cv2.rectangle(np.full((400, 400), 30, np.uint8), (60, 60), (340, 340), 255, -1), id="painted"),
        pytest.param(np.full((1, 20000), 200, np.uint8), id="strip"),
        pytest.param(np.full((20000, 1), 200, np.uint8), id="upright strip"),
    ],
)
def test_what_is_no_sheet_on_a_ground_stays(grey: Grey) -> None:
    given = page(grey)
    assert straighten(given) is given


def test_the_edge_of_a_shadow_cuts_nothing_off() -> None:
    grey = grain(drawn(paper=220), 3)
    grey[:, :90] = grey[:, :90] * 0.6
    given = page(grey)
    assert straighten(given) is given
