"""How likely a straight line joins two vertices: the mean of the lines channel along it (Eq. 2)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.graph.skeleton import Indices
from daemon.ink import Mask
from daemon.shapes import Map, Points

Floats = NDArray[np.float64]
Number = TypeVar("Number", np.float64, np.bool_)
_STAGES = (0.5, 0.25, 0.75, 0.125, 0.375, 0.625, 0.875)
_PAIRS_AT_ONCE = 1 << 17
_SEGMENTS_AT_ONCE = 1 << 13


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
    first = np.cumsum(counts) - counts
    segment = np.repeat(np.arange(len(counts)), counts)
    step = np.arange(len(segment)) - first[segment]
    at = (lengths - np.floor(spans))[segment] / 2 + step
    points = starts[segment] + unit[segment] * at[:, None]
    return Samples(points, segment, first, np.stack([-unit[:, 1], unit[:, 0]], axis=1))


def values_at(image: NDArray[Any], points: Points) -> Floats:
    """The pixel of a (H, W) image of any type nearest to each point (N, 2); 0 outside it."""
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
    samples outside the page count as 0. The strip is sampled at three places across, a wide one about every px.
    """
    places = max(3, math.ceil(width_px))
    across = [width_px * (2 * place + 1 - places) / (2 * places) for place in range(places)]

    def mean_of(starts: Points, ends: Points) -> Floats:
        samples = sampled(starts, ends, trim_px=trim_px)
        normals = samples.normals[samples.segment]
        strip = sum((values_at(lines, samples.points + offset * normals) for offset in across), np.zeros(len(normals)))
        return mean_along(samples, strip / len(across))

    return in_parts(mean_of, starts, ends, np.float64)


def in_parts(
    what: Callable[[Points, Points], NDArray[Number]], starts: Points, ends: Points, kind: type[Number]
) -> NDArray[Number]:
    """What is true of each of many segments (P, 2), asked of some thousands of them at a time: samples are many."""
    answers = np.empty(len(starts), kind)
    for first in range(0, len(starts), _SEGMENTS_AT_ONCE):
        part = slice(first, first + _SEGMENTS_AT_ONCE)
        answers[part] = what(starts[part], ends[part])
    return answers


def pairs_on_ink(vertices: Points, ink: Mask, *, within_px: float = np.inf) -> Indices:
    """Pairs of vertices at most `within_px` apart that have ink at seven points between them, (P, 2), lower first.

    ink: bool (H, W). Vertices are compared with those in a strip of the page alone; each of the seven points rules out
    most of the pairs that the one before it left.
    """
    wide = np.asarray(cv2.dilate(ink.view(np.uint8), np.ones((3, 3), np.uint8)), np.uint8)
    order = np.argsort(vertices[:, 1], kind="stable")
    height = vertices[order, 1]
    past = np.searchsorted(height, height + within_px, side="right")
    found = [np.empty((0, 2), np.intp)]
    first = 0
    while first < len(order):
        counts = past[first:] - np.arange(first, len(order))
        last = first + max(1, int(np.searchsorted(np.cumsum(counts), _PAIRS_AT_ONCE, side="right")))
        p = np.repeat(np.arange(first, last), counts[: last - first])
        q = (
            np.arange(len(p))
            - np.repeat(np.cumsum(counts[: last - first]) - counts[: last - first], counts[: last - first])
            + p
        )
        found.append(_on_ink(order[p], order[q], vertices, wide, within_px))
        first = last
    return np.sort(np.concatenate(found), axis=1)


def _on_ink(p: Indices, q: Indices, vertices: Points, wide: NDArray[np.uint8], within_px: float) -> Indices:
    """Those of the pairs p-q that are near enough and have ink between them, (P, 2)."""
    kept = (p != q) & (np.abs(vertices[p, 0] - vertices[q, 0]) <= within_px)
    p, q = p[kept], q[kept]
    for share in _STAGES:
        kept = values_at(wide, vertices[p] + share * (vertices[q] - vertices[p])) > 0
        p, q = p[kept], q[kept]
    return np.stack([p, q], axis=1)
