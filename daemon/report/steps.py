"""What was done to a page before it was read, one small picture a step."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from daemon.report import canvas
from daemon.report.canvas import Picture
from daemon.shapes import Step

_MARGIN_PX, _GAP_PX, _WORDS_PX, _A_ROW = 28, 16, 34, 4


def with_steps(picture: Picture, steps: Sequence[Step]) -> Picture:
    """The picture and below it, where something was done, the page as it was given and after each step but the last.

    After the last step it is the page that was read. picture: uint8 (H, W, 3).
    """
    if not steps:
        return picture
    words = ["given", *(f"{number}. {step.words}" for number, step in enumerate(steps, start=1))]
    side_px = (picture.shape[1] - 2 * _MARGIN_PX + _GAP_PX) // _A_ROW - _GAP_PX
    tiles = [_tile(step, side_px) for step in steps]
    high_px = max(tile.shape[0] for tile in tiles) + _WORDS_PX + _GAP_PX
    band = canvas.blank(picture.shape[1], (len(tiles) + _A_ROW - 1) // _A_ROW * high_px + _MARGIN_PX, canvas.DESK)
    for index, (tile, said) in enumerate(zip(tiles, words, strict=False)):
        left, top = _MARGIN_PX + index % _A_ROW * (side_px + _GAP_PX), index // _A_ROW * high_px
        canvas.paste(band, tile, left, top)
        canvas.box(band, (left - 1, top - 1), (left + tile.shape[1], top + tile.shape[0]), canvas.FRAME)
        canvas.write(band, canvas.shortened(said, side_px), (left, top + tile.shape[0] + 22))
    canvas.write(band, f"then: {words[-1]}", (_MARGIN_PX, band.shape[0] - 12), canvas.QUIET)
    return np.concatenate([picture, band])


def _tile(step: Step, side_px: int) -> Picture:
    scale = side_px / max(step.before.shape)
    size = [max(1, round(side * scale)) for side in step.before.shape[::-1]]
    how = cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR
    return np.asarray(cv2.cvtColor(cv2.resize(step.before, size, interpolation=how), cv2.COLOR_GRAY2BGR), np.uint8)
