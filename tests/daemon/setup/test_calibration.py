"""What a machine does wrong is read from a picture of the card that it has drawn."""

from __future__ import annotations

from itertools import pairwise

import cv2
import numpy as np
import pytest

from daemon.errors import BadPicture, SettingsError
from daemon.setup.card import Card, card_in, drawing_of, gauge_mm
from daemon.setup.find import find_marks
from daemon.setup.fit import Errors, by_known_width, by_resolution, errors_of
from daemon.setup.picture import found_picture
from daemon.setup.sheet_edges import px_to_mm_by_sheet
from daemon.shapes import Grey, Stroke, Toolpath
from daemon.toolpath.correct import Correction, corrected
from firmware_protocol.crooked import Crooked
from tests.daemon.setup.scanned import PX_PER_MM, SHEET_MM, card_drawn_by, drawn_by, scanned

CARD = Card(60.0, 60.0)
WIDE = Card(120.0, 90.0)
MACHINES = [
    Crooked(),
    Crooked(1.012, 0.991, skew_deg=0.35, backlash_mm=(0.3, 0.2)),
    Crooked(0.97, 1.03, skew_deg=-1.0, backlash_mm=(0.8, 0.0)),
]


def errors_in(grey: Grey, card: Card = CARD, px_per_mm: float = PX_PER_MM) -> Errors:
    return errors_of(find_marks(grey, card)[0], px_to_mm=by_resolution(px_per_mm))


def is_about(errors: Errors, crooked: Crooked, mm: float = 0.02) -> bool:
    assert errors.scale_x == pytest.approx(crooked.scale_x, abs=5e-4)
    assert errors.scale_y == pytest.approx(crooked.scale_y, abs=5e-4)
    assert errors.skew_deg == pytest.approx(crooked.skew_deg, abs=0.03)
    assert errors.backlash_mm == pytest.approx(crooked.backlash_mm, abs=mm)
    return True


@pytest.mark.parametrize("crooked", MACHINES)
@pytest.mark.parametrize("card", [CARD, WIDE])
def test_a_scan_tells_what_the_machine_does_wrong(card: Card, crooked: Crooked) -> None:
    assert is_about(errors_in(scanned(card_drawn_by(card, crooked)), card), crooked)


@pytest.mark.parametrize(("turned_deg", "upside_down"), [(-4.0, False), (0.0, True), (90.0, False), (-90.0, False)])
def test_the_card_may_lie_in_any_direction(turned_deg: float, upside_down: bool) -> None:
    ink = drawn_by(CARD.strokes_mm, MACHINES[1], at_mm=(44.0, 75.0))
    assert is_about(errors_in(scanned(ink, turned_deg=turned_deg, upside_down=upside_down)), MACHINES[1])


@pytest.mark.parametrize(("dpi", "pen_mm"), [(150, 0.5), (600, 0.3), (300, 1.0)])
def test_coarse_and_fine_scans_and_pens(dpi: int, pen_mm: float) -> None:
    px_per_mm = dpi / 25.4
    grey = scanned(card_drawn_by(CARD, MACHINES[1]), px_per_mm=px_per_mm, pen_mm=pen_mm)
    assert is_about(errors_in(grey, px_per_mm=px_per_mm), MACHINES[1], mm=0.04)


def test_what_is_left_after_the_correction_is_below_a_tenth_of_a_millimetre() -> None:
    crooked = MACHINES[1]
    seen = errors_in(scanned(card_drawn_by(WIDE, crooked)), WIDE)
    assert seen.before_mm > 0.8
    at_mm = (14.0, 40.0)
    meant = Toolpath(tuple(Stroke(line + at_mm) for line in WIDE.strokes_mm), np.eye(2, 3))
    path = corrected(meant, Correction(seen.scale_x, seen.scale_y, seen.skew_deg, seen.backlash_mm))
    lines = [stroke.points for stroke in path.strokes]
    after = errors_in(scanned(drawn_by(lines, crooked, at_mm=(0.0, 0.0))), WIDE)
    assert after.before_mm < 0.1
    assert is_about(after, Crooked())


def test_a_known_width_stands_for_the_resolution() -> None:
    crooked = MACHINES[1]
    found, to_px = find_marks(scanned(card_drawn_by(CARD, crooked)), CARD)
    known_mm = crooked.scale_x * (CARD.width_mm - crooked.backlash_mm[0])
    assert is_about(errors_of(found, px_to_mm=by_known_width(found, to_px, CARD, known_mm)), crooked)


def photographed(sheet: Grey) -> Grey:
    """From the side, on a dark table, in uneven light."""
    height, width = sheet.shape
    corners = np.array([[0, 0], [width, 0], [width, height], [0, height]], np.float32) - 0.5
    seen = np.array([[420, 260], [1880, 330], [2060, 2460], [260, 2380]], np.float32)
    size = (2300, 2700)
    photo = np.full(size[::-1], 70, np.uint8)
    transform = cv2.getPerspectiveTransform(corners, seen)
    there = cv2.warpPerspective(np.full_like(sheet, 255), transform, size)
    photo = np.where(there > 127, cv2.warpPerspective(sheet, transform, size, flags=cv2.INTER_AREA), photo)
    light = np.linspace(0.75, 1.0, size[0])[None, :]
    return np.asarray(photo * light, np.uint8)


def test_the_edges_of_the_sheet_undo_the_perspective_of_a_photo() -> None:
    photo = photographed(scanned(card_drawn_by(WIDE, MACHINES[1]), turned_deg=0.0))
    found, _ = find_marks(photo, WIDE)
    errors = errors_of(found, px_to_mm=px_to_mm_by_sheet(photo, SHEET_MM))
    assert errors.scale_x == pytest.approx(MACHINES[1].scale_x, abs=0.002)
    assert errors.scale_y == pytest.approx(MACHINES[1].scale_y, abs=0.002)
    assert errors.skew_deg == pytest.approx(MACHINES[1].skew_deg, abs=0.1)
    assert errors.backlash_mm == pytest.approx(MACHINES[1].backlash_mm, abs=0.04)


def test_a_photo_from_the_side_is_refused_where_nothing_undoes_it() -> None:
    found, to_px = find_marks(photographed(scanned(card_drawn_by(WIDE, Crooked()), turned_deg=0.0)), WIDE)
    with pytest.raises(BadPicture, match="--paper"):
        errors_of(found, px_to_mm=by_known_width(found, to_px, WIDE, WIDE.width_mm))


def test_a_frame_that_the_pen_left_open_is_one_all_the_same() -> None:
    grey = scanned(card_drawn_by(CARD, MACHINES[1]), turned_deg=0.0)
    bottom_px = round((SHEET_MM[1] - 40) * PX_PER_MM)
    grey[bottom_px - 60 : bottom_px + 60, 400:480] = 232
    assert is_about(errors_in(grey), MACHINES[1])


def test_a_picture_without_a_card_is_refused() -> None:
    for picture in (np.full((600, 400), 230, np.uint8), scanned([[(20.0, 20.0), (80.0, 90.0)]])):
        with pytest.raises(BadPicture, match="--card"):
            find_marks(picture, CARD)


def test_a_sheet_without_edges_is_refused() -> None:
    with pytest.raises(BadPicture, match="take all of it"):
        px_to_mm_by_sheet(scanned(card_drawn_by(CARD, Crooked())), SHEET_MM)


def test_the_picture_of_the_marks_shows_each_of_them() -> None:
    grey = scanned(card_drawn_by(CARD, Crooked()))
    found, to_px = find_marks(grey, CARD)
    picture = cv2.imdecode(np.frombuffer(found_picture(grey, CARD, found, to_px), np.uint8), cv2.IMREAD_COLOR)
    assert max(picture.shape) <= 2000
    green = (picture[..., 1].astype(int) - picture[..., 2] > 60).astype(np.uint8)
    assert cv2.connectedComponents(green)[0] - 1 == len(CARD.marks)


def test_each_mark_is_reached_from_the_side_that_it_stands_for() -> None:
    drawn = [tuple(map(tuple, line.tolist())) for line in CARD.strokes_mm]
    for mark in CARD.marks:
        index = drawn.index((mark.start_mm, mark.end_mm))
        come_mm = mark.start_mm[mark.axis] - drawn[index - 1][-1][mark.axis]
        assert mark.way * come_mm >= 4


def test_the_card_is_as_large_as_its_box_allows() -> None:
    assert (card_in((64.0, 64.0)), card_in((180.0, 120.0))) == (CARD, Card(120.0, 120.0))
    with pytest.raises(SettingsError, match="60 x 60"):
        card_in((64.0, 59.9))


@pytest.mark.parametrize("card", [CARD, WIDE, Card(60.0, 150.0)])
def test_nothing_on_the_card_touches_its_frame_or_a_mark(card: Card) -> None:
    _, *lines = card.strokes_mm
    inside = np.vstack([*lines, *gauge_mm(card, 7)])
    assert inside.min() >= 3
    assert ((card.width_mm, card.height_mm) - inside.max(axis=0)).min() >= 3
    far = 7.4 + 1.5
    figures = np.vstack([*card.figures_mm, *gauge_mm(card, 7)])
    assert figures.min() >= far
    assert ((card.width_mm, card.height_mm) - figures.max(axis=0)).min() >= far


def test_the_drawing_of_a_card_has_its_true_size() -> None:
    drawing = drawing_of(CARD, CARD.strokes_mm)
    frame = drawing.strokes[0].points
    assert drawing.px_per_mm is not None
    assert [abs(b - a).max() / drawing.px_per_mm for a, b in pairwise(frame)] == pytest.approx([60] * 4)
    assert (drawing.width_px, drawing.height_px) == (600, 600)
