"""Our own drawings: small files, made anew by their script, and read as what was drawn."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from daemon.ink import Mask, ink_mask
from daemon.intake.decode import decode
from daemon.page.prepare import prepare
from daemon.shapes import Points
from tests.drawings.make import SHEETS, Sheet, draw, truth

HERE = Path(__file__).parent
every_sheet = pytest.mark.parametrize("sheet", SHEETS, ids=lambda sheet: sheet.file)


@every_sheet
def test_the_files_are_what_the_script_makes(sheet: Sheet) -> None:
    picture, strokes = draw(sheet)
    kept = decode(HERE / sheet.file).grey
    lossy = sheet.file.endswith(".jpg")
    assert np.abs(kept.astype(int) - picture).mean() < (4 if lossy else 0.1)
    assert (HERE / sheet.file).with_suffix(".json").read_text() == truth(sheet, strokes)


@every_sheet
def test_a_drawing_takes_less_than_60_kilobytes(sheet: Sheet) -> None:
    assert (HERE / sheet.file).stat().st_size < 60_000


@every_sheet
def test_the_prepared_ink_is_what_was_drawn(sheet: Sheet) -> None:
    """Almost all ink lies on a true stroke, and almost all of the strokes is inked."""
    page = prepare(decode(HERE / sheet.file))
    near = near_strokes(sheet, true_strokes(sheet))
    y, x = np.nonzero(ink_mask(page.grey))
    inked = np.rint(np.stack([x, y], axis=1) @ page.to_given[:2, :2].T + page.to_given[:2, 2]).astype(int)
    assert near[inked[:, 1], inked[:, 0]].mean() > 0.995
    back = np.linalg.inv(page.to_given)
    along = np.concatenate(true_strokes(sheet))
    column, row = np.rint(along @ back[:2, :2].T + back[:2, 2]).astype(int).T
    assert (cv2.dilate(ink_mask(page.grey).astype(np.uint8), np.ones((3, 3), np.uint8))[row, column]).mean() > 0.995


@every_sheet
def test_the_prepared_line_is_as_wide_as_the_network_likes_it(sheet: Sheet) -> None:
    width_px = prepare(decode(HERE / sheet.file)).line_width_px
    assert width_px is not None
    assert 1.5 <= width_px <= 3.5


@every_sheet
def test_the_way_back_keeps_the_size(sheet: Sheet) -> None:
    page = prepare(decode(HERE / sheet.file))
    assert (page.given_width_px, page.given_height_px) == (sheet.side_px, sheet.side_px)
    edge = np.array([page.grey.shape[1] - 0.5, page.grey.shape[0] - 0.5])
    assert page.to_given[:2, :2] @ edge + page.to_given[:2, 2] == pytest.approx([sheet.side_px - 0.5] * 2, abs=1e-6)


def test_there_are_at_least_ten_drawings_of_different_sizes() -> None:
    assert len(SHEETS) >= 10
    assert {sheet.side_px for sheet in SHEETS} >= {256, 512, 1024}


def true_strokes(sheet: Sheet) -> list[Points]:
    kept = json.loads((HERE / sheet.file).with_suffix(".json").read_text())
    return [np.array(stroke) for stroke in kept["strokes"]]


def near_strokes(sheet: Sheet, strokes: list[Points]) -> Mask:
    """(side, side) bool: within half a line width and a pixel and a half of a stroke."""
    mask = np.zeros((sheet.side_px, sheet.side_px), np.uint8)
    for points in strokes:
        cv2.polylines(mask, [np.rint(points * 16).astype(np.int32)], False, 1, round(sheet.width_px + 3), shift=4)
        cv2.circle(mask, np.rint(points[0]).astype(int).tolist(), round(sheet.width_px / 2 + 2), 1, -1)
    near: Mask = mask > 0
    return near
