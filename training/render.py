"""From strokes to the pair the network learns from: X, the page, and Y, the label of each of its pixels.

`reference` is the rendering on which every IoU of this project is stated (model card): canvas 221 px, the sketch's
longest side 188 px, its box centred; vertices rounded to pixels; lines 2 px wide, antialiased; corners = discs of 13 px
on every distinct vertex and every crossing (Raghav et al. 2020, Sec. 5.1: stroke points plus intersections).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

CANVAS_PX = 221
SKETCH_PX = 188
BORDER_PX = (CANVAS_PX - SKETCH_PX) / 2
LINE_PX = 2
BACKGROUND, LINES, CORNERS, UNSURE = 0, 1, 2, 3
"""UNSURE is no class: ink that may or may not be called a corner; it teaches nothing and is counted nowhere."""
_SHIFT = 4
"""Sub-pixel bits of OpenCV's drawing functions."""
_ROUNDING_PX = 1e-3
_DISC = np.array([(x, y) for y in range(-2, 3) for x in range(-2, 3) if x * x + y * y <= 4])

Points = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """ink: uint8 (S, S), 255 = ink. label: uint8 (S, S) of BACKGROUND, LINES, CORNERS; UNSURE on curved ink only."""

    ink: NDArray[np.uint8]
    label: NDArray[np.uint8]


def reference(strokes: Sequence[NDArray[np.float32]]) -> Sample:
    """The reference rendering of one sketch (simplified form)."""
    return polylines(fit(strokes, CANVAS_PX, SKETCH_PX), CANVAS_PX)


def fit(strokes: Sequence[NDArray[np.float32]], canvas_px: int, sketch_px: float) -> list[Points]:
    """Scale to a longest side of sketch_px, the middle of the box to the middle of the canvas."""
    every = np.concatenate(strokes).astype(float)
    low, high = every.min(axis=0), every.max(axis=0)
    scale = sketch_px / max(float((high - low).max()), 1e-9)
    return [(stroke - (low + high) / 2) * scale + (canvas_px - 1) / 2 for stroke in strokes]


def polylines(strokes: Sequence[Points], canvas_px: int, line_px: int = LINE_PX) -> Sample:
    """Straight segments between rounded vertices; every vertex and every crossing is a corner."""
    whole = [_distinct(np.rint(stroke).astype(np.int32)) for stroke in strokes]
    whole = [stroke for stroke in whole if len(stroke) > 1]
    ink = np.zeros((canvas_px, canvas_px), np.uint8)
    cv2.polylines(ink, [s.reshape(-1, 1, 2) for s in whole], False, 255, line_px, cv2.LINE_AA)
    if not whole:
        return Sample(ink, np.zeros_like(ink))
    corners = np.concatenate([*whole, np.rint(crossings([s.astype(float) for s in whole])).astype(np.int32)])
    return Sample(ink, label(ink, corners))


def draw(ink: NDArray[np.uint8], strokes: Sequence[Points], line_px: int) -> None:
    """Draw polylines at sub-pixel positions."""
    fixed = [np.rint(s * (1 << _SHIFT)).astype(np.int32).reshape(-1, 1, 2) for s in strokes]
    cv2.polylines(ink, fixed, False, 255, line_px, cv2.LINE_AA, _SHIFT)


def label(ink: NDArray[np.uint8], corners: NDArray[np.int32]) -> NDArray[np.uint8]:
    """Discs of 13 px are corners, the rest of the ink above half is lines, everything else background."""
    out = (ink > 127).astype(np.uint8)
    at = (np.unique(corners, axis=0)[:, None] + _DISC[None]).reshape(-1, 2)
    at = at[((at >= 0) & (at < ink.shape[::-1])).all(axis=1)]
    out[at[:, 1], at[:, 0]] = CORNERS
    return out


def crossings(strokes: Sequence[Points]) -> Points:
    """Where two segments meet, end points that touch a segment included: (N, 2); parallel overlaps by their ends."""
    return meetings(strokes)[0]


def meetings(strokes: Sequence[Points]) -> tuple[Points, NDArray[np.float64]]:
    """The crossings, (N, 2), and the sine of the angle at which each pair of segments meets, (N,)."""
    a = np.concatenate([s[:-1] for s in strokes])
    b = np.concatenate([s[1:] for s in strokes])
    # Segments that follow each other meet in a vertex, which is no crossing: a gap in the numbering ends each stroke.
    first = np.cumsum([0, *(len(s) + 1 for s in strokes[:-1])])
    number = np.concatenate([k + np.arange(len(s) - 1) for k, s in zip(first, strokes, strict=True)]).astype(np.int32)
    i, j = _near_pairs(a, b, number)
    p, r, q, s = a[i], b[i] - a[i], a[j], b[j] - a[j]
    cross = r[:, 0] * s[:, 1] - r[:, 1] * s[:, 0]
    offset = q - p
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (offset[:, 0] * s[:, 1] - offset[:, 1] * s[:, 0]) / cross
        u = (offset[:, 0] * r[:, 1] - offset[:, 1] * r[:, 0]) / cross
    tiny = 1e-9
    meet = (cross != 0) & (t >= -tiny) & (t <= 1 + tiny) & (u >= -tiny) & (u <= 1 + tiny)
    # Parallel segments that overlap do so from an end of one of them, which is a vertex, hence a corner, already.
    lengths = np.hypot(*r[meet].T) * np.hypot(*s[meet].T)
    return p[meet] + t[meet, None] * r[meet], np.abs(cross[meet]) / np.maximum(lengths, tiny)


def _near_pairs(a: Points, b: Points, number: NDArray[np.intp]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Pairs of segments whose boxes touch and whose numbers are not neighbours."""
    low, high = np.minimum(a, b).astype(np.float32), np.maximum(a, b).astype(np.float32)
    touch = number[None] - number[:, None] > 1
    for axis in (0, 1):
        touch &= low[:, None, axis] <= high[None, :, axis] + _ROUNDING_PX
        touch &= low[None, :, axis] <= high[:, None, axis] + _ROUNDING_PX
    i, j = np.nonzero(touch)
    return i, j


def _distinct(points: NDArray[np.int32]) -> NDArray[np.int32]:
    keep = np.ones(len(points), bool)
    keep[1:] = (np.diff(points, axis=0) != 0).any(axis=1)
    return points[keep]
