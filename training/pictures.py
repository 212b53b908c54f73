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
from daemon.vision.segmenter import load_manifest, through_windows
from training.measure import CLASSES

LINE_PX = 3.0
"""Corner pixels are stated for lines of this width: a corner's area grows with its square."""


@dataclass(frozen=True, slots=True)
class Corners:
    """Of one picture: components of the corners channel, and the pixels of the largest at 3 px line width."""

    name: str
    line_width_px: float
    components: int
    largest_px: float


def corners_of(picture: Path, label_of: Callable[[NDArray[np.float32]], NDArray[np.uint8]]) -> Corners:
    """Read as the daemon reads it: put right, scaled to the network's line width, through its windows."""
    page = prepare(decode(picture, max_megapixels=100))
    whole = np.eye(len(CLASSES), dtype=np.float32)
    found = through_windows(page, load_manifest(), lambda ink, last: whole[label_of(ink)].transpose(0, 3, 1, 2))
    count, _, stats, _ = cv2.connectedComponentsWithStats(found.corners.astype(np.uint8), connectivity=8)
    width_px = page.line_width_px or LINE_PX
    largest = float(stats[1:, cv2.CC_STAT_AREA].max()) if count > 1 else 0.0
    return Corners(picture.name, width_px, count - 1, largest * (LINE_PX / width_px) ** 2)
