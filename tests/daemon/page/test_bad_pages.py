"""Pages that are no good drawings pass, and quickly."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from daemon.homography import through
from daemon.page.prepare import prepare, put_right
from daemon.shapes import Grey
from tests.daemon.page.pages import drawn, grain, page
from tests.daemon.page.test_sheet import on_desk, turned


def scenery() -> Grey:
    """A photo of something that is no drawing: soft shapes of all tones and grain."""
    random = np.random.default_rng(3)
    soft = cv2.GaussianBlur(random.normal(0, 1, (480, 640)), (0, 0), 25)
    return grain(np.asarray(128 + 110 * soft / np.abs(soft).max(), np.uint8), 6)


BAD = {
    "at 45 degrees": on_desk(turned(45)),
    "half outside": on_desk(np.array([[180, -90], [600, -60], [580, 560], [150, 520]], float)),
    "black": np.zeros((500, 400), np.uint8),
    "nearly black": grain(np.full((500, 400), 9, np.uint8), 2),
    "white": np.full((500, 400), 255, np.uint8),
    "no drawing": scenery(),
    "noise": np.random.default_rng(5).integers(0, 256, (300, 300)).astype(np.uint8),
    "strip": np.full((1, 20000), 255, np.uint8),
    "inked strip": np.tile(np.array([0, 255, 255, 255], np.uint8), 5000).reshape(1, -1),
    "upright strip": np.full((20000, 1), 255, np.uint8),
}


@pytest.mark.parametrize("grey", BAD.values(), ids=BAD.keys())
def test_every_page_becomes_one_whose_pixels_lead_back_into_the_given_picture(grey: Grey) -> None:
    prepared = prepare(page(grey))
    high, wide = prepared.grey.shape
    corners = np.array([[-0.5, -0.5], [wide - 0.5, -0.5], [wide - 0.5, high - 0.5], [-0.5, high - 0.5]])
    found = through(prepared.to_given, corners)
    limits = np.array(grey.shape[::-1])
    assert (found > -0.1 * limits - 1).all()
    assert (found < 1.1 * limits + 1).all()


@pytest.mark.parametrize("name", ["black", "nearly black", "white"])
def test_a_page_of_one_tone_holds_no_ink(name: str) -> None:
    assert prepare(page(BAD[name])).line_width_px is None


def test_a_clean_drawing_on_any_size_comes_back_as_it_was() -> None:
    for side_px in (64, 256, 1024):
        given = page(drawn(side_px=side_px))
        assert put_right(given) is given
