"""A picture whose strokes are known, and the ink that a pen leaves of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from daemon.shapes import Grey, Map, Points

PEN_PX = 3.0
_FINE = 4
_PIECE_PX = 12.0


@dataclass(frozen=True, slots=True, eq=False)
class Known:
    """A drawing of `side_px` x `side_px` px with its true strokes, each (N, 2) in px; one point is a dot."""

    name: str
    strokes: Sequence[Points]
    side_px: int
    pen_px: float = PEN_PX

    @property
    def fine(self) -> Map:
        """The ink, 0..1, on a grid four times as fine as the picture's."""
        return fine_ink(self.strokes, self.side_px, self.pen_px)

    @property
    def ink(self) -> Map:
        """How much of each pixel is inked, (side, side) in 0..1."""
        return _averaged(self.fine)

    @property
    def grey(self) -> Grey:
        """Black on white."""
        return np.asarray(np.rint(255 * (1 - self.ink)), np.uint8)


def fine_ink(strokes: Sequence[Points], side_px: int, pen_px: float) -> Map:
    """The ink of a round pen on a grid of 4 x side_px: exact distances to the lines, soft over one fine pixel."""
    away = np.full((side_px * _FINE, side_px * _FINE), np.inf, np.float32)
    for a, b in zip(*pieces(strokes, _PIECE_PX), strict=True):
        _nearer(away, _on_fine(a), _on_fine(b), pen_px / 2 * _FINE + 1)
    return np.asarray(np.clip(0.5 + pen_px / 2 * _FINE - away, 0, 1), np.float32)


def _averaged(fine: Map) -> Map:
    side = fine.shape[0] // _FINE
    return np.asarray(fine.reshape(side, _FINE, side, _FINE).mean(axis=(1, 3)), np.float32)


def pieces(strokes: Sequence[Points], longest_px: float) -> tuple[Points, Points]:
    """Starts and ends, each (M, 2), of straight pieces of at most that length; a dot is a piece of no length."""
    starts = [s[:-1] if len(s) > 1 else s for s in strokes]
    ends = [s[1:] if len(s) > 1 else s for s in strokes]
    a, b = np.concatenate([np.empty((0, 2)), *starts]), np.concatenate([np.empty((0, 2)), *ends])
    counts = np.maximum(1, np.ceil(np.hypot(*(b - a).T) / longest_px)).astype(int)
    part = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    a, step = np.repeat(a, counts, axis=0), np.repeat((b - a) / counts[:, None], counts, axis=0)
    return a + step * part[:, None], a + step * (part + 1)[:, None]


def _on_fine(point: Points) -> Points:
    return np.asarray((point + 0.5) * _FINE - 0.5)


def _nearer(away: Map, a: Points, b: Points, reach: float) -> None:
    """Lower the distances around one piece, in place: a page of its own for every piece would cost seconds."""
    low = np.clip(np.floor(np.minimum(a, b) - reach), 0, away.shape[0]).astype(int)
    high = np.clip(np.ceil(np.maximum(a, b) + reach) + 1, 0, away.shape[0]).astype(int)
    x, y = np.arange(low[0], high[0])[None] - a[0], np.arange(low[1], high[1])[:, None] - a[1]
    along, squared = b - a, float((b - a) @ (b - a))
    part = np.clip((x * along[0] + y * along[1]) / squared, 0, 1) if squared else np.zeros((1, 1))
    window = away[low[1] : high[1], low[0] : high[0]]
    np.minimum(window, np.hypot(x - part * along[0], y - part * along[1]), out=window)
