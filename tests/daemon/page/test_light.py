"""Paper tone, uneven light, faint ink."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from daemon.page.light import flatten_light
from daemon.shapes import Grey
from tests.daemon.page.pages import drawn, grain, in_shadow, overlap, page

FILLED = cv2.rectangle(drawn(side_px=400), (20, 20), (150, 380), 0, -1)
JPEG = cv2.imdecode(cv2.imencode(".jpg", drawn(), [cv2.IMWRITE_JPEG_QUALITY, 80])[1], cv2.IMREAD_GRAYSCALE)


@pytest.mark.parametrize(
    "grey",
    [
        pytest.param(drawn(), id="lines"),
        pytest.param(drawn(width_px=0.8), id="hair-lines"),
        pytest.param(drawn(width_px=40), id="thick-marker"),
        pytest.param(FILLED, id="filled-area"),
        pytest.param(JPEG, id="jpeg"),
        pytest.param(np.full((30, 900), 255, np.uint8), id="white-strip"),
        pytest.param(np.zeros((60, 60), np.uint8), id="black"),
        pytest.param(np.full((60, 60), 150, np.uint8), id="grey"),
        pytest.param(np.zeros((1, 1), np.uint8), id="one-pixel"),
    ],
)
def test_a_clean_or_empty_page_comes_back_bit_by_bit(grey: Grey) -> None:
    given = page(grey)
    assert flatten_light(given) is given


@pytest.mark.parametrize(
    "grey",
    [
        pytest.param(drawn(ink=150, paper=255), id="faint-on-white"),
        pytest.param(drawn(ink=140, paper=190), id="pencil-on-grey"),
        pytest.param(grain(drawn(ink=140, paper=200), 5), id="on-textured-paper"),
        pytest.param(in_shadow(drawn(), 0.4), id="in-shadow"),
        pytest.param(grain(in_shadow(drawn(ink=120, paper=215), 0.6), 3), id="all-at-once"),
    ],
)
def test_what_was_drawn_comes_out_black_on_white(grey: Grey) -> None:
    flat = flatten_light(page(grey)).grey
    assert overlap(flat, drawn()) > 0.85
    assert np.median(flat) == 255
    assert np.percentile(flat[drawn() < 20], 50) < 40


def test_strong_grain_leaves_few_specks_on_the_paper_and_few_holes_in_the_ink() -> None:
    flat = flatten_light(page(grain(drawn(ink=150, paper=200), 12))).grey
    far_from_ink = cv2.dilate(255 - drawn(), np.ones((9, 9), np.uint8)) == 0
    assert (flat[far_from_ink] < 128).mean() < 0.0002
    assert (flat[drawn() < 20] > 128).mean() < 0.01


def test_the_edge_of_a_shadow_is_no_line() -> None:
    grey = drawn()
    grey[:, 140:] = grey[:, 140:] // 2
    assert overlap(flatten_light(page(grey)).grey, drawn()) > 0.85


def test_a_filled_area_on_grey_paper_stays_filled() -> None:
    grey = np.asarray(np.maximum(FILLED * 0.8, 10), np.uint8)
    assert (flatten_light(page(grey)).grey[30:370, 30:140] < 100).all()
