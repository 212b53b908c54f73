"""The reference rendering and the curved canvases, on strokes whose corners are known."""

import cv2
import numpy as np
import pytest

from training.appearance import worn
from training.curves import curves, resample, sharp_bends, smooth
from training.evaluate import centroids
from training.render import BACKGROUND, CORNERS, LINES, UNSURE, crossings, fit, polylines, reference


def stroke(*points: tuple[float, float]) -> np.ndarray:
    return np.array(points, float)


def corners_of(label: np.ndarray) -> set[tuple[int, int]]:
    return {(round(x), round(y)) for x, y in centroids(label)}


def test_a_cross_has_its_four_ends_and_its_crossing() -> None:
    sample = polylines([stroke((20, 100), (180, 100)), stroke((100, 20), (100, 180))], 221)
    assert corners_of(sample.label) == {(20, 100), (180, 100), (100, 20), (100, 180), (100, 100)}


def test_an_end_that_touches_a_segment_is_one_corner() -> None:
    sample = polylines([stroke((20, 100), (180, 100)), stroke((100, 100), (100, 180))], 221)
    assert corners_of(sample.label) == {(20, 100), (180, 100), (100, 100), (100, 180)}


def test_a_corner_is_a_disc_of_13_pixels() -> None:
    label = polylines([stroke((20, 100), (180, 100))], 221).label
    assert (label == CORNERS).sum() == 2 * 13


def test_lines_are_the_ink_without_the_corners() -> None:
    sample = polylines([stroke((20, 100), (180, 100))], 221)
    assert ((sample.label == LINES) == ((sample.ink > 127) & (sample.label != CORNERS))).all()
    assert (sample.label[sample.ink <= 127] != LINES).all()
    assert sample.label[0, 0] == BACKGROUND


def test_reference_fills_188_pixels_in_the_middle_of_221() -> None:
    ys, xs = np.nonzero(reference([np.array([[0, 0], [255, 0], [255, 100]], np.float32)]).label == CORNERS)
    assert (xs.min(), xs.max()) == (16 - 2, 204 + 2)
    assert ys.min() + ys.max() == 220


def test_a_stroke_of_one_point_is_left_out() -> None:
    sample = reference([np.array([[0, 0], [255, 255]], np.float32), np.array([[100, 50]], np.float32)])
    assert len(centroids(sample.label)) == 2


def test_fit_keeps_proportions() -> None:
    (placed,) = fit([np.array([[10, 10], [60, 30]], np.float32)], 221, 100)
    assert np.allclose(placed[1] - placed[0], (100, 40))
    assert np.allclose(placed.mean(axis=0), 110)


def test_collinear_overlap_gives_no_crossing_beyond_the_ends() -> None:
    assert len(crossings([stroke((0, 0), (10, 0)), stroke((5, 0), (15, 0))])) == 0


def test_a_stroke_that_crosses_itself_once() -> None:
    found = crossings([stroke((0, 0), (10, 10), (10, 0), (0, 10))])
    assert np.allclose(found, [[5, 5]])


def test_a_circle_has_no_corner_and_a_square_has_four() -> None:
    angle = np.linspace(0, 2 * np.pi, 200)
    circle = 110 + 60 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    assert corners_of(curves([circle], 221, 2).label) == set()
    square = stroke((60, 60), (150, 60), (150, 150), (60, 150), (60, 62))
    assert len(corners_of(curves([square], 221, 2).label)) >= 4


def test_a_sharp_bend_is_found_where_it_is() -> None:
    bent = resample(stroke((0, 0), (30, 0), (30, 30)), 1.0)
    (at,) = sharp_bends(bent)
    assert np.allclose(bent[at], (30, 0), atol=1.0)


def bent(degrees: float) -> np.ndarray:
    turn = np.radians(degrees)
    return stroke((40, 110), (110, 110), (110 + 60 * np.cos(turn), 110 + 60 * np.sin(turn)))


@pytest.mark.parametrize(("degrees", "there"), [(20, LINES), (50, UNSURE), (80, CORNERS)])
def test_a_bend_is_a_corner_unsure_or_none(degrees: float, there: int) -> None:
    assert curves([bent(degrees)], 221, 2).label[110, 110] == there


@pytest.mark.parametrize(("degrees", "there"), [(12, UNSURE), (50, CORNERS)])
def test_lines_that_cross_flatly_have_no_place_where_they_do(degrees: float, there: int) -> None:
    turn = np.radians(degrees)
    arm = 80 * np.array([np.cos(turn), np.sin(turn)])
    label = curves([stroke((30, 110), (190, 110)), stroke(110 - arm, 110 + arm)], 221, 2).label
    assert label[110, 110] == there
    assert label[110, 30] == CORNERS


def test_an_end_that_runs_along_another_line_is_unsure_and_one_that_stands_on_it_a_corner() -> None:
    along = stroke((30, 110), (190, 110))
    assert curves([along, stroke((80, 111), (120, 111), (190, 160))], 221, 3).label[110, 80] == UNSURE
    assert curves([along, stroke((110, 111), (110, 190))], 221, 3).label[110, 110] == CORNERS


def test_nothing_is_sure_in_a_blot() -> None:
    zigzag = stroke(*((x, y) for x in range(80, 120, 2) for y in ((80, 120) if x % 4 else (120, 80))))
    label = curves([zigzag, stroke((20, 20), (60, 20))], 221, 2).label
    assert (label[90:110, 90:110] == UNSURE).all()
    assert label[20, 20] == CORNERS


def test_a_worn_page_still_holds_the_drawing() -> None:
    """Ink stays dark where it was drawn, paper stays light, and the same numbers give the same page."""
    clean = curves([resample(bent(80), 1.0)], 221, 3)
    drawn = cv2.erode((clean.ink > 127).astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    far = cv2.dilate((clean.ink > 0).astype(np.uint8), np.ones((9, 9), np.uint8)) == 0
    for seed in range(40):
        page = worn(clean, np.random.default_rng(seed), line_px=3)
        assert page.ink[drawn].mean() > page.ink[far].mean() + 63
        assert (page.label[clean.label > 0] == clean.label[clean.label > 0]).all()
        assert (worn(clean, np.random.default_rng(seed), line_px=3).ink == page.ink).all()


def test_smoothing_keeps_both_ends() -> None:
    rough = np.cumsum(np.random.default_rng(1).normal(size=(5, 2)), axis=0).astype(np.float32)
    for sigma in (0.8, 2.0):
        done = smooth(rough, sigma)
        assert len(done) == len(rough)
        assert np.allclose(done[[0, -1]], rough[[0, -1]], atol=1e-5)
