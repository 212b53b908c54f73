"""Whether lines are what a page looks like."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from daemon.polyline import lengths_along, places_at
from daemon.shapes import Grey, Points

_NEAR_PX = 2
_STEP_PX = 1.0


def share_seen(grey: Grey, lines: Sequence[Points]) -> float:
    """The share, 0 to 1, of the length of lines beside which the page is not of one tone; 1 where there are none.

    grey: the page. lines: each (N, 2) in px, from the upper left corner of the first one on.
    """
    samples = np.concatenate([np.empty((0, 2)), *map(_sampled, lines)])
    height_px, width_px = grey.shape
    x, y = (np.clip(samples[:, axis].astype(int), 0, most - 1) for axis, most in ((0, width_px), (1, height_px)))
    darkest, lightest = np.full(len(samples), 255, np.uint8), np.zeros(len(samples), np.uint8)
    around = range(-_NEAR_PX, _NEAR_PX + 1)
    for down in around:
        for across in around:
            tones = grey[np.clip(y + down, 0, height_px - 1), np.clip(x + across, 0, width_px - 1)]
            darkest, lightest = np.minimum(darkest, tones), np.maximum(lightest, tones)
    return float((lightest > darkest).mean()) if len(samples) else 1.0


def _sampled(line: Points) -> Points:
    along = lengths_along(line)
    return places_at(np.arange(0.0, along[-1] + _STEP_PX, _STEP_PX), line, along)
