"""How likely a straight line joins two vertices: the mean of the lines channel along it (Eq. 2)."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.graph.skeleton import Indices
from daemon.ink import Mask
from daemon.shapes import Map, Points

Floats = NDArray[np.float64]
_STAGES = (0.5, 0.25, 0.75, 0.125, 0.375, 0.625, 0.875)
_PAIRS_AT_ONCE = 1 << 20


@dataclass(frozen=True, slots=True, eq=False)
class Samples:
    """Points about one px apart along many segments: row i belongs to segment `segment[i]`."""

    points: Points
    segment: Indices
    first: Indices
    """Index of each segment's first point; every segment has at least one."""
    normals: Points
    """Unit normal of each segment, (P, 2)."""


def sampled(starts: Points, ends: Points, *, trim_px: float = 0.0) -> Samples:
    """Sample segments every px from `trim_px` after their start to `trim_px` before their end.

    starts, ends: (P, 2) in px. A segment shorter than twice `trim_px` gets its middle alone.
    """
    along = ends - starts
    lengths = np.hypot(*along.T)
    unit = along / np.maximum(lengths, 1e-9)[:, None]
    spans = np.maximum(lengths - 2 * trim_px, 0.0)
    counts = np.floor(spans).astype(np.intp) + 1
    first = np.concatenate([[0], np.cumsum(counts)[:-1]]).astype(np.intp)
    segment = np.repeat(np.arange(len(counts)), counts)
    step = np.arange(len(segment)) - first[segment]
    at = (lengths - np.floor(spans))[segment] / 2 + step
    points = starts[segment] + unit[segment] * at[:, None]
    return Samples(points, segment, first, np.stack([-unit[:, 1], unit[:, 0]], axis=1))


def values_at(image: NDArray[np.float32], points: Points) -> Floats:
    """The pixel of a float32 (H, W) image nearest to each point (N, 2); 0 outside it."""
    x, y = np.rint(points).astype(np.intp).T
    height, width = image.shape
    inside = (x >= 0) & (y >= 0) & (x < width) & (y < height)
    values = np.zeros(len(points))
    values[inside] = image[y[inside], x[inside]]
    return values


def mean_along(samples: Samples, values: Floats) -> Floats:
    """Mean over each segment's samples."""
    if not len(samples.first):
        return np.empty(0)
    counts = np.bincount(samples.segment, minlength=len(samples.first))
    return np.asarray(np.add.reduceat(values, samples.first) / counts)


def plausibilities(lines: Map, starts: Points, ends: Points, *, width_px: float, trim_px: float = 0.0) -> Floats:
    """Mean response of the lines channel in a strip along each segment (Raghav et al. 2020, Eq. 2, eta).

    lines: float32 (H, W) in 0..1. starts, ends: (P, 2) in px. width_px: beta, full width of the strip. trim_px:
    length left out at both ends, where the corners channel takes over from the lines channel. Returns (P,) in 0..1;
    samples outside the page count as 0.
    """
    samples = sampled(starts, ends, trim_px=trim_px)
    across = (-width_px / 3, 0.0, width_px / 3)
    normals = samples.normals[samples.segment]
    strip = sum((values_at(lines, samples.points + offset * normals) for offset in across), np.zeros(len(normals)))
    return mean_along(samples, strip / len(across))


def pairs_on_ink(vertices: Points, ink: Mask) -> Indices:
    """All pairs of vertices that have ink at seven points between them, (P, 2), first index lower.

    ink: bool (H, W). Each point rules out most of the pairs that the one before it left, so what costs is the first:
    time grows with the square of the number of vertices, memory does not.
    """
    wide = np.asarray(cv2.dilate(ink.astype(np.float32), np.ones((3, 3), np.uint8)), np.float32)
    found = [np.empty((0, 2), np.intp)]
    rows = max(1, _PAIRS_AT_ONCE // max(1, len(vertices)))
    for top in range(0, len(vertices), rows):
        pairs = np.argwhere(np.arange(top, min(top + rows, len(vertices)))[:, None] < np.arange(len(vertices)))
        pairs[:, 0] += top
        for share in _STAGES:
            p, q = vertices[pairs[:, 0]], vertices[pairs[:, 1]]
            pairs = pairs[values_at(wide, p + share * (q - p)) > 0]
        found.append(pairs)
    return np.concatenate(found)
