"""How the printed lines of a paper lean: they are parallel on it, and nearly so in its picture."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from daemon.ink import Mask
from daemon.shapes import Grey, Points

_MOST_DEGREES, _STEP_DEGREES = 10.0, 0.5
_FANS = np.linspace(-0.12, 0.12, 5)
_POINTS = 12_000
_LEAST_POINTS = 400
_LEAST_SHARPNESS = 1.25
"""So much sharper than lines of no direction the sum over rows must become."""


@dataclass(frozen=True, slots=True)
class Slant:
    """A line that crosses the middle column at row m has the slope `slope + fan * (m / height - 1 / 2)`."""

    slope: float
    fan: float
    height: int
    width: int

    def rows(self, middle: float, columns: Points) -> Points:
        """The rows of one line at those columns."""
        slope = self.slope + self.fan * (middle / self.height - 0.5)
        return np.asarray(middle + slope * (columns - (self.width - 1) / 2))

    def level(self, grey: Grey) -> Grey:
        """The page with these lines made level; what comes from outside it is 0."""
        y = np.arange(self.height, dtype=np.float32)[:, None]
        x = np.arange(self.width, dtype=np.float32)[None]
        slopes = np.float32(self.slope) + np.float32(self.fan) * (y / np.float32(self.height) - np.float32(0.5))
        rows = y + slopes * (x - np.float32((self.width - 1) / 2))
        return np.asarray(
            cv2.remap(grey, np.broadcast_to(x, rows.shape).copy(), rows, cv2.INTER_LINEAR, borderValue=0.0), np.uint8
        )


def slant(faint: Mask) -> Slant | None:
    """How the lines lean that the pixels lie on; None where they lie on none.

    faint: bool (H, W), pixels that may be of a printed line. The rows that the pixels gather in are the fewest when
    they are added up along the lines (projection profile, Postl 1986): coarsely first, then ever more finely.
    """
    height, width = faint.shape
    at = np.flatnonzero(faint)
    if len(at) < _LEAST_POINTS:
        return None
    at = at[:: max(1, len(at) // _POINTS)]
    y, x = at // width, at % width - (width - 1) / 2
    slopes = np.tan(np.radians(np.arange(-_MOST_DEGREES, _MOST_DEGREES + 0.1, _STEP_DEGREES)))
    coarse = max(2.0, width * float(slopes[1] - slopes[0]) / 4)
    scores = {(b, f): _sharpness(y, x, (b, f), height, coarse) for b in slopes for f in _FANS}
    slope, fan = max(scores, key=lambda each: scores[each])
    if scores[slope, fan] < _LEAST_SHARPNESS * float(np.median(list(scores.values()))):
        return None
    step, turn = float(slopes[1] - slopes[0]), float(_FANS[1] - _FANS[0])
    while step * width > 1.0:
        step, turn, coarse = step / 2, turn / 2, max(1.0, coarse / 2)
        near = [(slope + i * step, fan + j * turn) for i in (-1, 0, 1) for j in (-1, 0, 1)]
        slope, fan = max(near, key=lambda each: _sharpness(y, x, each, height, coarse))
    return Slant(slope, fan, height, width)


def _sharpness(y: Points, x: Points, lean: tuple[float, float], height: int, row_px: float) -> float:
    """Sum of squares of the pixels in each row once the lines are level."""
    slope, fan = lean
    # To first order: the fan is small.
    middles = (y - (slope + fan * (y / height - 0.5)) * x) / row_px
    rows = np.bincount(np.maximum(middles.astype(np.intp), 0))
    return float((rows.astype(float) ** 2).sum())
