"""Precision, recall, f1 and overlap of drawn lines."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
import pytest

from daemon.report.fidelity import fidelity, within
from daemon.report.places import Place, places
from daemon.shapes import Grey, PageImage, Points

SQUARE = np.array([[40, 40], [160, 40], [160, 160], [40, 160], [40, 40]], float)
LINE = np.array([[20.0, 100.0], [180.0, 100.0]])


def inked(*strokes: Points, width_px: float = 3, side_px: int = 200) -> PageImage:
    """A page with lines of a true width: drawn eight times as large and averaged, for OpenCV's own are wider."""
    large = np.full((side_px * 8, side_px * 8), 255, np.uint8)
    for stroke in strokes:
        corners = np.rint(stroke * 8 + 3.5).astype(np.int32)
        cv2.polylines(large, [corners], False, 0, round(width_px * 8) - 2)
    return page_of(cv2.resize(large, (side_px, side_px), interpolation=cv2.INTER_AREA).astype(np.uint8))


def page_of(grey: Grey) -> PageImage:
    return PageImage(grey, np.eye(3), grey.shape[1], grey.shape[0], "")


def judge(page: PageImage, strokes: Sequence[Points], width_px: float = 3.0) -> tuple[float, float, float, float]:
    f = fidelity(page, strokes, line_width_px=width_px)
    return f.precision, f.recall, f.f1, f.iou


def test_the_line_itself_is_perfect() -> None:
    precision, recall, f1, iou = judge(inked(SQUARE), [SQUARE])
    assert (precision, recall, f1) == (1.0, 1.0, 1.0)
    assert iou > 0.9


def test_precision_is_the_share_of_drawn_length_on_ink() -> None:
    stray = np.array([[20.0, 150.0], [60.0, 150.0]])
    precision, recall, *_ = judge(inked(LINE), [LINE, stray])
    assert precision == pytest.approx(160 / 200, abs=0.001)
    assert recall == 1.0


def test_recall_is_the_share_of_the_centre_line_that_was_drawn() -> None:
    precision, recall, f1, _ = judge(inked(LINE), [np.array([[20.0, 100.0], [140.0, 100.0]])])
    assert precision == 1.0
    assert recall == pytest.approx(120 / 160, abs=0.015)
    assert f1 == pytest.approx(2 * recall / (1 + recall))


@pytest.mark.parametrize(("beside_px", "precision", "recall"), [(1.4, 1.0, 1.0), (1.6, 1.0, 0.0), (2.6, 0.0, 0.0)])
def test_tolerances_are_one_pixel_beside_ink_and_one_and_a_half_off_the_centre(
    beside_px: float, precision: float, recall: float
) -> None:
    beside = LINE + np.array([0.0, beside_px])
    assert judge(inked(LINE), [beside])[:2] == (pytest.approx(precision, abs=0.02), pytest.approx(recall, abs=0.02))


def test_one_and_a_half_pixels_off_the_centre_of_a_thin_line_are_allowed() -> None:
    assert judge(inked(LINE, width_px=1), [LINE + np.array([0.0, 1.4])], 1.0)[1] > 0.95


def test_half_a_line_width_off_the_centre_of_a_thick_line_is_allowed() -> None:
    beside = LINE + np.array([0.0, 4.4])
    assert judge(inked(LINE, width_px=9), [beside], 9.0)[1] > 0.95
    assert judge(inked(LINE, width_px=9), [beside], 8.0)[1] < 0.1


def test_overlap_falls_by_the_part_that_was_not_drawn() -> None:
    half = np.array([[20.0, 100.0], [100.0, 100.0]])
    assert judge(inked(LINE), [half])[3] == pytest.approx(0.5, abs=0.03)


def test_overlap_counts_a_line_drawn_too_wide() -> None:
    assert judge(inked(LINE, width_px=3), [LINE], 6.0)[3] == pytest.approx(0.5, abs=0.1)


def test_order_direction_and_cuts_of_the_strokes_do_not_matter() -> None:
    cut = [SQUARE[2:][::-1], SQUARE[:3]]
    assert judge(inked(SQUARE), cut) == judge(inked(SQUARE), [SQUARE])


def test_a_dot_counts_as_one_line_width() -> None:
    dot = np.array([[100.0, 150.0]])
    assert judge(inked(LINE), [LINE, dot], 4.0)[0] == pytest.approx(160 / 164, abs=0.001)


def test_nothing_drawn_on_an_empty_page_is_perfect() -> None:
    assert judge(inked(), []) == (1.0, 1.0, 1.0, 1.0)


def test_nothing_drawn_of_ink_is_worth_nothing() -> None:
    assert judge(inked(LINE), []) == (0.0, 0.0, 0.0, 0.0)


def test_a_line_on_an_empty_page_is_worth_nothing() -> None:
    assert judge(inked(), [LINE]) == (0.0, 0.0, 0.0, 0.0)


def test_a_line_off_the_page_is_a_line_without_ink() -> None:
    off = np.array([[-200.0, -50.0], [-40.0, -50.0]])
    assert judge(inked(LINE), [LINE, off])[0] == pytest.approx(0.5, abs=0.001)


def test_a_line_width_of_nothing_is_refused() -> None:
    with pytest.raises(ValueError, match="positive"):
        fidelity(inked(LINE), [LINE], line_width_px=0.0)


def test_a_line_is_redrawn_as_wide_as_stated() -> None:
    slant = np.array([[20.0, 30.0], [180.0, 120.0]])
    for width_px in (1.0, 2.5, 6.0, 20.0):
        area = within([slant], (200, 200), width_px / 2).sum()
        assert area == pytest.approx(np.hypot(160, 90) * width_px + np.pi * width_px**2 / 4, rel=0.06)


def test_ink_that_was_not_drawn_is_named_with_its_place() -> None:
    found = fidelity(inked(SQUARE, LINE), [SQUARE, LINE[:1]], line_width_px=3.0)
    left, right = sorted(found.not_drawn, key=lambda place: place.left_px)[:: len(found.not_drawn) - 1]
    assert 20 < left.left_px < 25
    assert 179 <= right.left_px + right.width_px <= 183
    assert all(place.top_px >= 99 and place.top_px + place.height_px <= 103 for place in found.not_drawn)
    assert found.not_on_ink == ()


def test_a_line_beside_all_ink_is_named_with_its_place() -> None:
    found = fidelity(inked(SQUARE), [SQUARE, np.array([[60.0, 100], [140, 100]])], line_width_px=3.0)
    assert found.not_drawn == ()
    assert [(place.left_px, place.width_px) for place in found.not_on_ink] == [(59, 83)]


def test_what_is_no_longer_than_two_line_widths_is_not_named() -> None:
    assert fidelity(inked(SQUARE), [SQUARE, np.array([[98.0, 100], [101, 100]])], line_width_px=3.0).not_on_ink == ()


def test_no_more_than_a_hundred_places_are_named_the_largest_first() -> None:
    mask = np.zeros((120, 40), bool)
    mask[::2, :10] = True
    mask[:, 20:22] = True
    mask[::2, 30:] = True
    found = places(mask, longer_than_px=5)
    assert found[0] == Place(20, 0, 2, 120, 240)
    assert len(found) == 100
