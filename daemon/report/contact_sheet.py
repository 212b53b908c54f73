"""contact_sheet.png: one row a job, given, understood and drawn side by side."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from daemon.report import canvas
from daemon.report.canvas import Colour, Picture
from daemon.report.preview import in_words
from daemon.shapes import Points

_TILE_PX = 300
_GAP_PX = 18
_MARGIN_PX = 40
_HEAD_PX = 96
_SIDE_PX = 210
_TILES = ("given", "understood", "drawn")
_PITCH_PX = _TILE_PX + _GAP_PX
_COLUMN_PX = _MARGIN_PX + _SIDE_PX + len(_TILES) * _PITCH_PX - _GAP_PX
_ROWS_IN_ONE_COLUMN = 6
_FINE = 4
"""The ink is drawn this many times as large and averaged, for a true width."""


@dataclass(frozen=True, slots=True, eq=False)
class Row:
    """One job: the picture that was given, the strokes that were understood, the ink that was drawn."""

    name: str
    given: Picture
    """As a viewer shows it, uint8 (H, W, 3)."""
    understood: Sequence[Points]
    """Strokes, each (N, 2), in px of the given picture."""
    drawn: Sequence[Points]
    """Ink on the sheet, each (N, 2), in px of the given picture; none where the job failed."""
    f1: float | None = None
    seconds: float | None = None
    """What the machine took."""
    line_width_px: float = 2.0
    """Of the pen, in px of the given picture."""
    trouble: str = ""
    """Why there is no drawing."""


def contact_sheet(rows: Sequence[Row], *, title: str) -> Picture:
    """One picture with a row for each job, in two columns where there are many. Returns uint8 (H, W, 3)."""
    columns = 2 if len(rows) > _ROWS_IN_ONE_COLUMN else 1
    deep = math.ceil(len(rows) / columns)
    sheet = canvas.blank(
        columns * _COLUMN_PX + _MARGIN_PX, _HEAD_PX + deep * _PITCH_PX + _MARGIN_PX - _GAP_PX, canvas.DESK
    )
    canvas.write(sheet, title, (_MARGIN_PX, 46), size_px=26, weight=600)
    for left in range(0, columns * _COLUMN_PX, _COLUMN_PX):
        for number, words in enumerate(_TILES):
            canvas.write(sheet, words, (left + _tile_left(number), _HEAD_PX - 12), canvas.QUIET, size_px=16)
    for index, row in enumerate(rows):
        _lay(sheet, row, index // deep * _COLUMN_PX, _HEAD_PX + index % deep * _PITCH_PX)
    return sheet


def understood_tile(row: Row) -> Picture:
    """The strokes in their colours with a ring where each begins, on a white tile."""
    tile = canvas.blank(_TILE_PX, _TILE_PX)
    for stroke, colour in zip(row.understood, canvas.many_colours(), strict=False):
        points = _on_tile(stroke, row.given)
        canvas.line(tile, points, colour, 2.5)
        canvas.dot(tile, points[0], 3.0, canvas.PAPER, colour)
    return tile


def drawn_tile(row: Row) -> Picture:
    """The ink at the width of the pen, on a white tile."""
    large = canvas.blank(_FINE * _TILE_PX, _FINE * _TILE_PX)
    width_px = row.line_width_px * _FINE * _TILE_PX / max(row.given.shape[:2])
    for stroke in row.drawn:
        canvas.line(large, (_on_tile(stroke, row.given) + 0.5) * _FINE - 0.5, canvas.INK, width_px)
    return canvas.fit(large, _TILE_PX, _TILE_PX)


def _lay(sheet: Picture, row: Row, left: int, top: int) -> None:
    for number, tile in enumerate((canvas.fit(row.given, _TILE_PX, _TILE_PX), understood_tile(row), drawn_tile(row))):
        x = left + _tile_left(number)
        canvas.paste(sheet, tile, x, top)
        canvas.box(sheet, (x - 1, top - 1), (x + _TILE_PX, top + _TILE_PX), canvas.FRAME)
    name = canvas.shortened(row.name, _SIDE_PX - _GAP_PX, size_px=20, weight=600)
    canvas.write(sheet, name, (left + _MARGIN_PX, top + 26), size_px=20, weight=600)
    for number, (words, colour) in enumerate(_said(row)):
        canvas.write(sheet, words, (left + _MARGIN_PX, top + 56 + 24 * number), colour, size_px=16)


def _said(row: Row) -> list[tuple[str, Colour]]:
    said = [f"{row.given.shape[1]} × {row.given.shape[0]} px"]
    if row.trouble:
        lines = textwrap.wrap(row.trouble, 22, max_lines=9, placeholder=" …")
        return [(words, canvas.QUIET) for words in said] + [(words, canvas.RED) for words in lines]
    said.append(canvas.counted(len(row.understood), "stroke", "strokes"))
    said += [] if row.f1 is None else [f"f1 {row.f1:.3f}"]
    said += [] if row.seconds is None else [in_words(row.seconds)]
    return [(words, canvas.QUIET) for words in said]


def _tile_left(number: int) -> int:
    return _MARGIN_PX + _SIDE_PX + number * _PITCH_PX


def _on_tile(points: Points, given: Picture) -> Points:
    height, width = given.shape[:2]
    scale = _TILE_PX / max(height, width)
    margin = (_TILE_PX - np.rint(np.array([width, height], float) * scale)) // 2
    return np.asarray((points + 0.5) * scale - 0.5 + margin, np.float64)
