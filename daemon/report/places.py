"""Where on a picture something is missing or too much."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from daemon.ink import Mask

MOST = 100
"""A report names no more places than this, the largest."""


@dataclass(frozen=True, slots=True)
class Place:
    """A connected component: its box in px of the picture, and how many pixels it has."""

    left_px: int
    top_px: int
    width_px: int
    height_px: int
    area_px: int


def places(mask: Mask, *, longer_than_px: float) -> tuple[Place, ...]:
    """The components of a mask that are longer than that in one direction, largest first, at most a hundred.

    mask: bool (H, W). A component holds pixels that touch by a side or a corner.
    """
    stats = cv2.connectedComponentsWithStats(mask.view(np.uint8), connectivity=8)[2][1:]
    long = stats[stats[:, 2:4].max(axis=1) > longer_than_px]
    largest = long[np.argsort(-long[:, cv2.CC_STAT_AREA], kind="stable")][:MOST]
    return tuple(Place(*row) for row in largest.tolist())
