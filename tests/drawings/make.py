"""Makes the drawings of this folder, and beside each the strokes it was made of: `python -m tests.drawings.make`."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.shapes import Grey, Points
from daemon.toolpath.simplify import simplify
from tests.drawings import scenes, signs
from tests.drawings.hand import by_hand, chalk, inked, pen, pencil

Medium = Callable[[NDArray[np.float32], np.random.Generator], Grey]


@dataclass(frozen=True, slots=True)
class Sheet:
    """side_px: of the square picture. width_px: of the pen's line. wobble: in thousandths of the side."""

    file: str
    subject: Callable[[], list[Points]]
    side_px: int
    width_px: float
    medium: Medium = pen
    wobble: float = 2.0


SHEETS = (
    Sheet("house.png", scenes.house, 512, 3.0),
    Sheet("spiral.png", scenes.spiral, 400, 2.5, wobble=1.5),
    Sheet("hatch.png", scenes.hatch, 512, 2.0),
    Sheet("face.png", scenes.face, 512, 3.0),
    Sheet("script.png", signs.script, 640, 3.0, wobble=0.8),
    Sheet("star.png", scenes.star, 256, 2.5),
    Sheet("crossing_grid.png", scenes.grid, 480, 2.5),
    Sheet("thick_marker.jpg", scenes.fish, 1024, 18.0),
    Sheet("faint_pencil.jpg", scenes.flower, 600, 2.5, medium=pencil),
    Sheet("dark_paper.jpg", scenes.house, 640, 4.5, medium=chalk, wobble=3.0),
    Sheet("floor_plan.png", signs.plan, 800, 2.5, wobble=0.8),
    Sheet("flower.png", scenes.flower, 300, 1.5),
    Sheet("cat.jpg", scenes.cat, 450, 3.0),
    Sheet("dot_and_dash.png", signs.dashes, 560, 3.0),
)


def draw(sheet: Sheet) -> tuple[Grey, list[Points]]:
    """The picture, (side, side) uint8, and its true strokes in px. The same sheet gives the same picture."""
    rng = np.random.default_rng(list(sheet.file.encode()))
    # A subject spans 0..100 and the sheet -0.5..side - 0.5.
    scale = sheet.side_px / 100
    strokes = [
        by_hand(points * scale - 0.5, rng, wobble_px=sheet.wobble * sheet.side_px / 1000) for points in sheet.subject()
    ]
    ink = inked(strokes, (sheet.side_px, sheet.side_px), width_px=sheet.width_px)
    return sheet.medium(ink, rng), strokes


def encode(sheet: Sheet, picture: Grey) -> bytes:
    options = [cv2.IMWRITE_JPEG_QUALITY, 82] if sheet.file.endswith(".jpg") else [cv2.IMWRITE_PNG_COMPRESSION, 9]
    done, data = cv2.imencode(Path(sheet.file).suffix, picture, options)
    if not done:
        raise ValueError(f"{sheet.file} cannot be encoded: choose .png or .jpg")
    return data.tobytes()


def truth(sheet: Sheet, strokes: list[Points]) -> str:
    """As strokes.json of a job, and the width of the line."""
    size = {"width_px": sheet.side_px, "height_px": sheet.side_px, "px_per_mm": None, "line_width_px": sheet.width_px}
    return (
        json.dumps({**size, "strokes": [np.round(simplify(points, error=0.02), 2).tolist() for points in strokes]})
        + "\n"
    )


def main(folder: Path) -> None:
    for sheet in SHEETS:
        picture, strokes = draw(sheet)
        (folder / sheet.file).write_bytes(encode(sheet, picture))
        (folder / sheet.file).with_suffix(".json").write_text(truth(sheet, strokes))


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
