"""The threshold of each pair of vertices, adapted by what the rendering lacks and what it has too much (Eq. 3)."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.components import components
from daemon.graph.plausibility import Floats
from daemon.graph.skeleton import Indices
from daemon.ink import Mask
from daemon.shapes import Points

_MOST_BOXES = 1024
_LEAST_AREA_PX = 4
_MARGIN_PX = 3.0
"""A line's vertices lie on its ends, its blob ends where the ink does: boxes are widened by this much."""
_SHIFT = 4
"""Bits of a pixel's fraction that OpenCV draws with."""


@dataclass(frozen=True, slots=True)
class Adaptation:
    """The constants of Eqs. 2 and 3 (Raghav et al. 2020, Sec. 5.3): beta, tau, lambda and N of the adaptive method."""

    beta_px: float = 1.8
    """Full width of the strip of Eq. 2."""
    tau0: float = 0.35
    rate: float = 0.05
    rounds: int = 10


def select(
    vertices: Points,
    pairs: Indices,
    eta: Floats,
    ink: Mask,
    adaptation: Adaptation,
    *,
    width_px: float,
) -> NDArray[np.bool_]:
    """Which pairs are edges: eta above a threshold of their own, which feedback adapts (Eqs. 1 and 3).

    pairs: (P, 2) indices of vertices. eta: (P,). ink: bool (H, W). width_px: of the rendered line. Returns (P,) bool.
    Stops early when no later round can change a decision: the rendering would stay, and so would its blobs.
    """
    tau = np.full(len(pairs), adaptation.tau0)
    chosen, near_ink = eta > tau, grown(ink)
    for left in range(adaptation.rounds, 0, -1):
        drawn = rendering(vertices, pairs[chosen], ink.shape, width_px=width_px)
        superfluous, absent = blobs(drawn & ~near_ink), blobs(ink & ~grown(drawn))
        delta = _deltas(vertices, pairs, superfluous, absent)
        if not (((eta > tau * (1 + adaptation.rate * delta) ** left) != chosen) & (delta != 0)).any():
            break
        tau = tau * (1 + adaptation.rate * delta)
        chosen = eta > tau
    return chosen


def rendering(vertices: Points, edges: Indices, shape: tuple[int, ...], *, width_px: float) -> Mask:
    """Straight edges drawn with a line of width_px. Returns bool (H, W)."""
    canvas = np.zeros(shape, np.uint8)
    segments = np.rint(vertices[edges] * (1 << _SHIFT)).astype(np.int32)
    cv2.polylines(canvas, list(segments), False, 1, max(1, round(width_px)), cv2.LINE_8, _SHIFT)
    return canvas.view(np.bool_)


def blobs(difference: Mask) -> Points:
    """Bounding boxes of connected components, largest first, as (left, top, right, bottom), widened by a margin."""
    stats = components(difference).stats[1:].astype(np.float64)
    stats = stats[stats[:, cv2.CC_STAT_AREA] >= _LEAST_AREA_PX]
    stats = stats[np.argsort(-stats[:, cv2.CC_STAT_AREA], kind="stable")][:_MOST_BOXES]
    corner = stats[:, :2]
    return np.concatenate([corner - _MARGIN_PX, corner + stats[:, 2:4] - 1 + _MARGIN_PX], axis=1)


def grown(mask: Mask) -> Mask:
    """The mask and the pixels around it."""
    return np.asarray(cv2.dilate(mask.view(np.uint8), np.ones((3, 3), np.uint8)), np.uint8).view(np.bool_)


def _deltas(vertices: Points, pairs: Indices, superfluous: Points, absent: Points) -> Floats:
    """delta of Eq. 3: -1 for pairs inside an absent blob's box, +1 inside a superfluous one's, else 0."""
    lacking, too_much = _inside(vertices, pairs, absent), _inside(vertices, pairs, superfluous)
    return np.where(lacking, -1.0, np.where(too_much, 1.0, 0.0))


def _inside(vertices: Points, pairs: Indices, boxes: Points) -> NDArray[np.bool_]:
    """Which pairs have both vertices in one of the boxes."""
    x, y = vertices.T[:, :, None]
    left, top, right, bottom = boxes.T
    within = np.packbits((x >= left) & (x <= right) & (y >= top) & (y <= bottom), axis=1)
    return np.asarray((within[pairs[:, 0]] & within[pairs[:, 1]]).any(axis=1))
