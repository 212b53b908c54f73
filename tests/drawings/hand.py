"""A hand that is not quite steady, and the pen, pencil, marker or chalk in it."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.shapes import Grey, Points

Pairs = Sequence[tuple[float, float]]
_SHIFT = 4


def line(*pairs: tuple[float, float]) -> Points:
    """Straight from point to point."""
    return np.array(pairs, float)


def curve(*pairs: tuple[float, float], closed: bool = False) -> Points:
    """Smooth through the points (Catmull and Rom 1974)."""
    points = np.array(pairs, float)
    around = [points[-1:], points, points[:2]] if closed else [2 * points[:1] - points[1:2], points]
    around += [] if closed else [2 * points[-1:] - points[-2:-1]]
    p = np.concatenate(around)
    t = np.linspace(0, 1, 16, endpoint=False)[:, None]
    pieces = [
        0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t**2 + (3 * b - a - 3 * c + d) * t**3)
        for a, b, c, d in zip(p[:-3], p[1:-2], p[2:-1], p[3:], strict=True)
    ]
    return np.concatenate([*pieces, p[-2:-1]])


def ring(x: float, y: float, radius: float, squash: float = 1.0, *, start: float = 0.0, turn: float = 360.0) -> Points:
    """A circle, ellipse or arc, from `start` over `turn` degrees."""
    angle = np.radians(start + np.linspace(0, turn, max(12, int(abs(turn) / 6))))
    return np.stack([x + radius * np.cos(angle), y + squash * radius * np.sin(angle)], axis=1)


def by_hand(points: Points, rng: np.random.Generator, *, wobble_px: float) -> Points:
    """The stroke as an unsteady hand draws it: off by a slow, smooth wander; a closed stroke stays closed."""
    length_px = float(np.hypot(*np.diff(points, axis=0).T).sum())
    along = _resampled(points, min(3.0, length_px / 16))
    if len(along) < 4:
        return along
    wander = rng.normal(0, 1, (len(along) // 8 + 4, 2))
    places = np.linspace(0, len(wander) - 1, len(along))
    rough = np.stack([np.interp(places, np.arange(len(wander)), column) for column in wander.T], axis=1)
    smooth = cv2.blur(rough, (1, 9), borderType=cv2.BORDER_REFLECT)
    if np.allclose(along[0], along[-1]):
        smooth += (smooth[0] - smooth[-1]) * np.linspace(0, 1, len(smooth))[:, None]
    return along + min(wobble_px, length_px / 30) * smooth


def _resampled(points: Points, step_px: float) -> Points:
    """Points at about equal steps, the given corners kept."""
    pieces = [points[:1]]
    for a, b in pairwise(points):
        count = max(1, round(float(np.hypot(*(b - a))) / step_px))
        pieces.append(a + (b - a) * np.linspace(0, 1, count + 1)[1:, None])
    return np.concatenate(pieces)


def inked(strokes: Sequence[Points], size: tuple[int, int], *, width_px: float) -> NDArray[np.float32]:
    """How much of each pixel is ink, (H, W) float32 in 0..1; drawn at four times the size and averaged."""
    wide, high = size
    fine = np.zeros((4 * high, 4 * wide), np.uint8)
    for points in strokes:
        # The centre of pixel 0 lies at 1.5 on the fine grid.
        fixed = np.rint((4 * points + 1.5) * (1 << _SHIFT)).astype(np.int32)
        cv2.polylines(fine, [fixed], False, 255, round(4 * width_px), cv2.LINE_AA, _SHIFT)
        if len(points) == 1:
            cv2.circle(fine, fixed[0].tolist(), round(2 * width_px * (1 << _SHIFT)), 255, -1, cv2.LINE_AA, _SHIFT)
    return np.asarray(cv2.resize(fine, size, interpolation=cv2.INTER_AREA), np.float32) / np.float32(255)


def pen(ink: NDArray[np.float32], rng: np.random.Generator) -> Grey:
    """Black on white."""
    del rng
    return _bytes(255 * (1 - ink))


def pencil(ink: NDArray[np.float32], rng: np.random.Generator) -> Grey:
    """Faint graphite that catches on the grain of grey paper, lit from one corner."""
    grain = cv2.GaussianBlur(rng.normal(0, 1, ink.shape), (0, 0), 1.2) * 3
    y, x = np.indices(ink.shape) / max(ink.shape)
    light = 1.0 - 0.22 * x - 0.16 * y**2
    paper = 222 * light + 2.2 * grain
    return _bytes(paper * (1 - 0.42 * ink * np.clip(1 + 0.18 * grain, 0.5, 1.2)) + rng.normal(0, 1.5, ink.shape))


def chalk(ink: NDArray[np.float32], rng: np.random.Generator) -> Grey:
    """White on a dark board, with some dust."""
    grain = cv2.GaussianBlur(rng.normal(0, 1, ink.shape), (0, 0), 1.0) * 2.5
    board = 46 + 8 * cv2.GaussianBlur(rng.normal(0, 1, ink.shape), (0, 0), 25) * 25 + 2 * grain
    return _bytes(board + (232 - board) * ink * np.clip(1 - 0.08 * grain, 0.6, 1.0))


def _bytes(values: NDArray[np.floating]) -> Grey:
    return np.asarray(np.rint(np.clip(values, 0, 255)), np.uint8)
