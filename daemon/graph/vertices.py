"""The corners channel becomes vertices: components, melted ones split into discs, each at its centroid."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.components import components
from daemon.ink import Mask
from daemon.shapes import Map, Points

CORNER = 0.5
"""A pixel belongs to a corner when the network gives it more than this."""
DISC = np.array([(dx, dy) for dy in range(-2, 3) for dx in range(-2, 3) if dx * dx + dy * dy <= 4])
"""The 13 pixels of a corner in the training truth, as (dx, dy)."""
_KERNEL = np.array([[dx * dx + dy * dy <= 4 for dx in range(-2, 3)] for dy in range(-2, 3)], np.float32)
_LEAST_NEW_PX = 5
"""Pixels that a further disc of a melted component must explain: two corners one pixel apart leave five."""
_LARGEST_SINGLE_PX = 16
_SMALLEST_PX = 2


def centroids(corners: Map) -> Points:
    """One vertex a connected component of the corners channel, at its centroid (Raghav et al. 2020, Sec. 3.3).

    corners: float32 (H, W) in 0..1. Returns (V, 2) float64 in px.
    """
    _, _, _, centres = cv2.connectedComponentsWithStats((corners > CORNER).astype(np.uint8), connectivity=8)
    return np.asarray(centres[1:], np.float64).reshape(-1, 2)


def corner_vertices(corners: Map, ink: Mask) -> Points:
    """Vertices of the corners channel on the ink; a component larger than one disc is split into discs.

    corners: float32 (H, W) in 0..1. ink: bool (H, W). Corners away from the ink, and components of one pixel, are
    left out. Returns (V, 2) float64 in px, no two on one pixel. Discs are placed greedily: each where it lies on the
    component and explains the most pixels that no disc before it did.
    """
    near: Mask = np.asarray(cv2.dilate(ink.view(np.uint8), np.ones((3, 3), np.uint8))).view(np.bool_)
    near &= corners > CORNER
    blobs = components(near)
    stats = blobs.stats
    areas = stats[:, cv2.CC_STAT_AREA]
    small = (areas <= _LARGEST_SINGLE_PX) & (stats[:, 2:4].max(axis=1) <= 6)
    sound = (areas >= _SMALLEST_PX) & (np.arange(len(stats)) > 0)
    found = [blobs.centres[sound & small]]
    found += [_discs(blobs.piece(label)) + stats[label, :2] for label in np.flatnonzero(sound & ~small).tolist()]
    return distinct(np.concatenate(found))


def distinct(vertices: Points) -> Points:
    """Of vertices that lie on one pixel, the first."""
    _, first = np.unique(np.rint(vertices).astype(int), axis=0, return_index=True)
    return vertices[np.sort(first)]


def _discs(blob: NDArray[np.bool_]) -> Points:
    """Centres (x, y) of the discs that make up a melted component."""
    uncovered = np.pad(blob, 2).astype(np.float32)
    inside = cv2.filter2D(uncovered, -1, _KERNEL, borderType=cv2.BORDER_CONSTANT)
    fits = inside >= min(11.0, float(inside.max()))
    centres: list[tuple[int, int]] = []
    while True:
        fresh = cv2.filter2D(uncovered, -1, _KERNEL, borderType=cv2.BORDER_CONSTANT)
        score = np.where(fits, fresh + 0.3 * inside, 0.0)
        y, x = np.unravel_index(int(score.argmax()), score.shape)
        if centres and fresh[y, x] < _LEAST_NEW_PX:
            return np.array(centres, np.float64) - 2
        centres.append((int(x), int(y)))
        uncovered[y + DISC[:, 1], x + DISC[:, 0]] = 0
        fits[y, x] = False
