"""Small pictures, each unlike every other: zigzags one above the other, so that ink says whose it is."""

from __future__ import annotations

from pathlib import Path
from random import Random

import cv2
import numpy as np

SIDE_PX = 160
_BAND_PX = 28


def draw_picture(path: Path, random: Random) -> None:
    """Write a picture of 2 to 5 zigzags that do not touch."""
    grey = np.full((SIDE_PX, SIDE_PX), 255, np.uint8)
    for band in range(random.randint(2, 5)):
        cv2.polylines(grey, [_zigzag(band, random)], False, 0, 2, cv2.LINE_AA)
    cv2.imwrite(str(path), grey)


def _zigzag(band: int, random: Random) -> np.ndarray[tuple[int, ...], np.dtype[np.int32]]:
    top_px = 8 + band * _BAND_PX
    xs = sorted(random.sample(range(8, SIDE_PX - 8, 6), random.randint(3, 6)))
    return np.array([(x, top_px + random.randint(0, _BAND_PX - 12)) for x in xs], np.int32)
