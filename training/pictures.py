"""What a network makes of pictures whose truth nobody knows: is a smooth curve painted as one long corner?"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.intake.decode import decode
from daemon.page.prepare import prepare
from daemon.vision import segmenter
from training.render import CORNERS

LINE_PX = 3.0
"""Corner pixels are stated for lines of this width: a corner's area grows with its square."""


@dataclass(frozen=True, slots=True)
class Corners:
    """Of one picture: components of the corners channel, and the pixels of the largest at 3 px line width."""

    name: str
    line_width_px: float
    components: int
    largest_px: float


def corners_of(picture: Path, label_of: Callable[[NDArray[np.float32]], NDArray[np.uint8]], tile_px: int) -> Corners:
    """Read as the daemon reads it: put right, scaled to the network's line width, through its windows."""
    page = prepare(decode(picture, max_megapixels=100))
    grey = segmenter.soft_edged(page.grey)
    label = np.zeros(grey.shape, np.uint8)
    for tile in segmenter.tiles(grey < 192, size_px=tile_px, margin_px=segmenter.MARGIN_PX):
        answer = label_of(segmenter.cut(grey, tile, tile_px)[None])[0]
        rows = slice(tile.core_top - tile.top, tile.core_bottom - tile.top)
        columns = slice(tile.core_left - tile.left, tile.core_right - tile.left)
        label[tile.core_top : tile.core_bottom, tile.core_left : tile.core_right] = answer[rows, columns]
    count, _, stats, _ = cv2.connectedComponentsWithStats((label == CORNERS).astype(np.uint8), connectivity=8)
    width_px = page.line_width_px or LINE_PX
    largest = float(stats[1:, cv2.CC_STAT_AREA].max()) if count > 1 else 0.0
    return Corners(picture.name, width_px, count - 1, largest * (LINE_PX / width_px) ** 2)
