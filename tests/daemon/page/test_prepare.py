"""A page put right, all steps together."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from daemon.page.prepare import even_out, prepare
from tests.daemon.page.pages import drawn, grain, in_shadow, overlap, page


def test_a_clean_page_comes_back_bit_by_bit() -> None:
    given = page(drawn())
    assert prepare(given).grey is given.grey
    assert np.array_equal(prepare(given).to_given, given.to_given)


def test_thick_chalk_on_an_unevenly_lit_board_becomes_fine_ink() -> None:
    board = grain(in_shadow(drawn(ink=235, paper=50, width_px=5, side_px=512), 0.7), 3)
    prepared = prepare(page(board))
    assert prepared.line_width_px == pytest.approx(2.5)
    fine = cv2.resize(drawn(width_px=5, side_px=512), prepared.grey.shape[::-1], interpolation=cv2.INTER_AREA)
    assert overlap(prepared.grey, np.asarray(fine, np.uint8)) > 0.85


def test_evening_out_keeps_every_pixel_where_it_is() -> None:
    board = drawn(ink=235, paper=50, width_px=9)
    evened = even_out(page(board))
    assert np.array_equal(evened.to_given, np.eye(3))
    assert overlap(evened.grey, drawn(width_px=9)) > 0.95


@pytest.mark.parametrize("level", [0, 128, 255])
def test_a_page_of_one_tone_has_no_line_width(level: int) -> None:
    assert prepare(page(np.full((80, 60), level, np.uint8))).line_width_px is None


@pytest.mark.parametrize("shape", [(1, 1), (1, 5000), (7, 3)])
def test_tiny_pages_and_strips_pass(shape: tuple[int, int]) -> None:
    grey = np.full(shape, 255, np.uint8)
    grey[0, 0] = 0
    assert prepare(page(grey)).given_width_px == shape[1]
