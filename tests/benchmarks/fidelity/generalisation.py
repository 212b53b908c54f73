"""The paper's comparison: given, segmented and drawn, beside a rule-based tracer (Raghav et al. 2020, Sec. 5.5).

`python -m tests.benchmarks.fidelity.generalisation docs/generalisation.png`; needs `make peers` for autotrace.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from daemon.intake.decode import decode
from daemon.report import canvas
from daemon.report.canvas import Picture
from daemon.shapes import Grey, Points, Segmentation
from tests.benchmarks.fidelity import peers
from tests.benchmarks.fidelity.ours import understood

TILE_PX = 360
_GAP_PX, _MARGIN_PX, _HEAD_PX, _WORDS_PX = 16, 28, 96, 30
_PITCH_PX = TILE_PX + _GAP_PX
_COLUMNS = ("given", "segmentation: lines, corners", "strokes of linedrawd", "strokes of autotrace, by rules")
_DRAWINGS = Path(__file__).parents[2] / "drawings"


@dataclass(frozen=True, slots=True)
class View:
    """Part of a drawing: its left upper corner and its side as shares of the picture's side."""

    file: str
    left: float = 0.0
    top: float = 0.0
    side: float = 1.0


VIEWS = (
    View("star.png"),
    View("face.png"),
    View("hatch.png"),
    View("hatch.png", left=0.12, top=0.30, side=0.22),
    View("hatch.png", left=0.38, top=0.66, side=0.22),
)


def sheet(views: Sequence[View]) -> Picture:
    """A row of four tiles for each view, uint8 (H, W, 3)."""
    greys = {view.file: decode(_DRAWINGS / view.file).grey for view in views}
    by_rules = peers.traced("autotrace", {Path(file).stem: grey for file, grey in greys.items()})
    rows = {file: _row(grey, by_rules[Path(file).stem][0]) for file, grey in greys.items()}
    width_px, deep_px = len(_COLUMNS) * _PITCH_PX + 2 * _MARGIN_PX - _GAP_PX, TILE_PX + _WORDS_PX + _GAP_PX
    picture = canvas.blank(width_px, _HEAD_PX + len(views) * deep_px + _MARGIN_PX, canvas.DESK)
    canvas.write(picture, "One line, one stroke", (_MARGIN_PX, 44), size_px=24, weight=600)
    for column, words in enumerate(_COLUMNS):
        canvas.write(picture, words, (_MARGIN_PX + column * _PITCH_PX, _HEAD_PX - 12), canvas.QUIET, size_px=16)
    for index, view in enumerate(views):
        _show(picture, rows[view.file], view, _HEAD_PX + index * deep_px)
    return picture


@dataclass(frozen=True, slots=True, eq=False)
class _Row:
    """What is shown of one drawing; strokes in px of the given picture."""

    grey: Grey
    segmentation: Segmentation
    ours: Sequence[Points]
    by_rules: Sequence[Points]


def _row(grey: Grey, by_rules: Sequence[Points]) -> _Row:
    seen = understood(grey)
    return _Row(grey, seen.segmentation, seen.strokes, by_rules)


def _show(picture: Picture, row: _Row, view: View, top_px: int) -> None:
    part = "" if view.side == 1 else f", {1 / view.side:.1f} times as large"
    counts = [canvas.counted(len(strokes), "stroke", "strokes") for strokes in (row.ours, row.by_rules)]
    words = (f"{view.file}{part}", "", *(["", ""] if part else counts))
    tiles = [_of_grey(row.grey, view), _of_maps(row.segmentation, view)]
    tiles += [_of_strokes(row.grey, strokes, view) for strokes in (row.ours, row.by_rules)]
    for column, (tile, below) in enumerate(zip(tiles, words, strict=True)):
        left_px = _MARGIN_PX + column * _PITCH_PX
        canvas.paste(picture, tile, left_px, top_px)
        canvas.box(picture, (left_px - 1, top_px - 1), (left_px + TILE_PX, top_px + TILE_PX), canvas.FRAME)
        canvas.write(picture, below, (left_px, top_px + TILE_PX + 20))


def _of_grey(grey: Grey, view: View) -> Picture:
    return np.asarray(cv2.cvtColor(_cut(grey, view), cv2.COLOR_GRAY2BGR), np.uint8)


def _of_maps(segmentation: Segmentation, view: View) -> Picture:
    paper = np.full(3, 255, np.float32)
    seen = paper + segmentation.lines[..., None] * (np.array(canvas.BLUE, np.float32) - paper)
    seen += segmentation.corners[..., None] * (np.array(canvas.ORANGE, np.float32) - seen)
    return _cut(np.asarray(np.rint(np.clip(seen, 0, 255)), np.uint8), view)


def _of_strokes(grey: Grey, strokes: Sequence[Points], view: View) -> Picture:
    """Each stroke in its colour from a ring on, over the pale picture."""
    tile = _of_grey(np.asarray(200 + grey * (55 / 255), np.uint8), view)
    scale = TILE_PX / (view.side * grey.shape[0])
    corner = np.array([view.left, view.top]) * grey.shape[0]
    for points, colour in zip(strokes, canvas.many_colours(), strict=False):
        placed = (points + 0.5 - corner) * scale - 0.5
        canvas.line(tile, placed, colour, 3)
        canvas.dot(tile, placed[0], 4.0, canvas.PAPER, colour)
    return tile


def _cut(picture: Grey, view: View) -> Grey:
    """That part of a square picture, as large as a tile."""
    scale = TILE_PX / (view.side * picture.shape[0])
    corner = np.array([view.left, view.top]) * picture.shape[0]
    if view.side == 1:
        how = cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR
        return np.asarray(cv2.resize(picture, (TILE_PX, TILE_PX), interpolation=how), np.uint8)
    # Pixel centres are integers on both sides.
    turn = np.array([[scale, 0, (0.5 - corner[0]) * scale - 0.5], [0, scale, (0.5 - corner[1]) * scale - 0.5]])
    return np.asarray(cv2.warpAffine(picture, turn, (TILE_PX, TILE_PX), flags=cv2.INTER_NEAREST), np.uint8)


def main(path: Path) -> None:
    if not peers.installed():
        raise SystemExit("the rule-based tracer is not installed: make peers")
    path.write_bytes(canvas.png(sheet(VIEWS)))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
