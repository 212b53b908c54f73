"""A picture whose strokes are known, and the ink that a pen leaves of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from daemon.shapes import Grey, Map, Points

PEN_PX = 3.0
WITHIN_PX = 1.5
FINER = 4
_PIECE_PX = 12.0


@dataclass(frozen=True, slots=True, eq=False)
class Known:
    """A drawing of `side_px` x `side_px` px with its true strokes, each (N, 2) in px; one point is a dot."""

    name: str
    strokes: Sequence[Points]
    side_px: int
    pen_px: float = PEN_PX
    finer: int = FINER
    """How many times as fine as the picture's the grid is on which the ink is drawn."""
    given: Grey | None = None
    """What somebody gives of it, (H, W), longer side `side_px`: a photo, a scan; None: the ink, black on white."""

    @property
    def within_px(self) -> float:
        """So near to a true line a drawn one is on it: half a line's width, at least a pixel and a half."""
        return max(WITHIN_PX, self.pen_px / 2)

    @property
    def fine(self) -> Map:
        """The ink, 0..1, on a grid `finer` times as fine as the picture's."""
        return fine_ink(self.strokes, self.side_px, self.pen_px, finer=self.finer)

    @property
    def ink(self) -> Map:
        """How much of each pixel is inked, (side, side) in 0..1."""
        return averaged(self.fine, finer=self.finer)

    @property
    def grey(self) -> Grey:
        """What is given."""
        if self.given is not None:
            return self.given
        return np.asarray(np.rint(255 * (1 - self.ink)), np.uint8)


def fine_ink(strokes: Sequence[Points], side_px: int, pen_px: float, *, finer: int = FINER) -> Map:
    """The ink of a round pen on a grid of finer x side_px: exact distances to the lines, soft over one fine pixel."""
    away = np.full((side_px * finer, side_px * finer), np.inf, np.float32)
    for a, b in zip(*pieces(strokes, _PIECE_PX), strict=True):
        _nearer(away, (a + 0.5) * finer - 0.5, (b + 0.5) * finer - 0.5, pen_px / 2 * finer + 1)
    return np.asarray(np.clip(0.5 + pen_px / 2 * finer - away, 0, 1), np.float32)


def averaged(fine: Map, *, finer: int = FINER) -> Map:
    """Each pixel the mean of its finer x finer fine ones."""
    side = fine.shape[0] // finer
    return np.asarray(fine.reshape(side, finer, side, finer).mean(axis=(1, 3)), np.float32)


def pieces(strokes: Sequence[Points], longest_px: float) -> tuple[Points, Points]:
    """Starts and ends, each (M, 2), of straight pieces of at most that length; a dot is a piece of no length."""
    starts = [s[:-1] if len(s) > 1 else s for s in strokes]
    ends = [s[1:] if len(s) > 1 else s for s in strokes]
    a, b = np.concatenate([np.empty((0, 2)), *starts]), np.concatenate([np.empty((0, 2)), *ends])
    counts = np.maximum(1, np.ceil(np.hypot(*(b - a).T) / longest_px)).astype(int)
    part = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    a, step = np.repeat(a, counts, axis=0), np.repeat((b - a) / counts[:, None], counts, axis=0)
    return a + step * part[:, None], a + step * (part + 1)[:, None]


def _nearer(away: Map, a: Points, b: Points, reach: float) -> None:
    """Lower the distances around one piece, in place: a page of its own for every piece would cost seconds."""
    low = np.clip(np.floor(np.minimum(a, b) - reach), 0, away.shape[0]).astype(int)
    high = np.clip(np.ceil(np.maximum(a, b) + reach) + 1, 0, away.shape[0]).astype(int)
    x, y = np.arange(low[0], high[0])[None] - a[0], np.arange(low[1], high[1])[:, None] - a[1]
    along, squared = b - a, float((b - a) @ (b - a))
    part = np.clip((x * along[0] + y * along[1]) / squared, 0, 1) if squared else np.zeros((1, 1))
    window = away[low[1] : high[1], low[0] : high[0]]
    np.minimum(window, np.hypot(x - part * along[0], y - part * along[1]), out=window)
