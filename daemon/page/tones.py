"""A page looked at from afar: its two tones, ink and paper, and the page made small."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np

from daemon.ink import ink_threshold
from daemon.remembered import remembered
from daemon.shapes import Grey

_SAMPLE_PX = 1 << 20


@dataclass(frozen=True, slots=True)
class Tones:
    """Grey levels. full_ink: of the darkest tenth of the ink; ink: of a third of it; paper: the middle of the paper.

    grain: by how much a sixth of the paper is darker than its middle (one standard deviation of a normal grain).
    """

    full_ink: float
    ink: float
    paper: float
    grain: float


@remembered
def tones(grey: Grey) -> Tones | None:
    """grey: uint8 (H, W). None where the page holds no ink. Of a large page about a million pixels are looked at."""
    sample = _sample(grey)
    threshold = ink_threshold(sample)
    if threshold is None:
        return None
    full_ink, ink = np.percentile(sample[sample <= threshold], [10, 33])
    dark_paper, paper = np.percentile(sample[sample > threshold], [16, 50])
    return Tones(float(full_ink), float(ink), float(paper), float(paper - dark_paper))


def reduced(grey: Grey, side_px: int) -> Grey:
    """The page with its longer side at most side_px, by area averaging; grain and thin lines fade."""
    scale = min(1.0, side_px / max(grey.shape))
    size = (max(1, round(grey.shape[1] * scale)), max(1, round(grey.shape[0] * scale)))
    return np.asarray(cv2.resize(grey, size, interpolation=cv2.INTER_AREA), np.uint8)


def _sample(grey: Grey) -> Grey:
    """Every n-th pixel, n without a common divisor with the width: no row or column is left out, as a raster would."""
    step = max(1, grey.size // _SAMPLE_PX)
    while math.gcd(step, grey.shape[1]) > 1:
        step += 1
    return grey.reshape(1, -1)[:, ::step]
