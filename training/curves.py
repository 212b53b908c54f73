"""Curved ink from raw pen paths: smooth, at sub-pixel places, of several widths, with corners only where a person sees one.

A corner is an end, a crossing, or a sharp bend: a local maximum of the turning angle over +-5 px above 50 degrees.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from training.render import Points, Sample, crossings, draw, label

BEND_PX = 5
BEND_DEGREES = 50.0
_STEP_PX = 1.0


def smooth(stroke: NDArray[np.float32], sigma_points: float) -> Points:
    """Gaussian along the path, ends kept."""
    reach = int(np.ceil(3 * sigma_points))
    if len(stroke) < 3 or reach == 0:
        return stroke.astype(float)
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma_points) ** 2)
    # Mirrored through the end points, so that the ends stay where they are.
    before = 2 * stroke[0] - stroke[1 : reach + 1][::-1]
    after = 2 * stroke[-1] - stroke[-reach - 1 : -1][::-1]
    padded = np.concatenate([_lengthen(before, reach, 0), stroke, _lengthen(after, reach, -1)])
    return np.stack([np.convolve(padded[:, k], kernel / kernel.sum(), "valid") for k in (0, 1)], axis=1)


def curves(strokes: Sequence[Points], canvas_px: int, line_px: int) -> Sample:
    """Strokes in canvas px, already smooth."""
    even = [resample(stroke, _STEP_PX) for stroke in strokes if _length(stroke) >= 2.0]
    ink = np.zeros((canvas_px, canvas_px), np.uint8)
    if not even:
        return Sample(ink, np.zeros_like(ink))
    draw(ink, even, line_px)
    corners = [stroke[[0, -1]] for stroke in even if _length(stroke[[0, -1]]) > 1.5]
    corners += [stroke[sharp_bends(stroke)] for stroke in even]
    corners.append(_far_from(crossings([resample(s, 3.0) for s in even]), corners))
    return Sample(ink, label(ink, np.rint(np.concatenate(corners)).astype(np.int32)))


def sharp_bends(even: Points) -> NDArray[np.intp]:
    """Indices of sharp bends on a polyline resampled at 1 px."""
    k = int(round(BEND_PX / _STEP_PX))
    if len(even) < 2 * k + 1:
        return np.zeros(0, np.intp)
    into, out = even[k:-k] - even[: -2 * k], even[2 * k :] - even[k:-k]
    turn = np.abs(np.arctan2(into[:, 0] * out[:, 1] - into[:, 1] * out[:, 0], (into * out).sum(axis=1)))
    padded = np.pad(turn, k)
    highest = np.max([padded[i : i + len(turn)] for i in range(2 * k + 1)], axis=0)
    found = np.nonzero((turn >= np.radians(BEND_DEGREES)) & (turn == highest))[0]
    return found + k


def splines(random: np.random.Generator) -> list[Points]:
    """Round shapes as an illustrator draws them: 2 to 6 open or closed smooth curves in a unit square."""
    return [_spline(random) for _ in range(random.integers(2, 7))]


def _spline(random: np.random.Generator) -> Points:
    """A circle's harmonics, or a walk of smooth turns: 160 points."""
    t = np.linspace(0.0, 1.0, 160)
    centre, size = random.random(2), random.uniform(0.08, 0.5)
    if random.random() < 0.4:
        angle = 2 * np.pi * t * random.choice([1.0, random.uniform(0.2, 1.0)]) + random.uniform(0, 2 * np.pi)
        radius = size * (1 + random.uniform(0, 0.3) * np.cos(random.integers(2, 6) * angle + random.uniform(0, 6)))
        return centre + radius[:, None] * np.stack([np.cos(angle), random.uniform(0.4, 1.0) * np.sin(angle)], axis=1)
    waves = np.arange(1, 5)
    heading = random.uniform(0, 2 * np.pi) + np.sin(np.outer(t, waves * np.pi) + random.uniform(0, 6, 4)) @ (
        random.normal(0, 1.6, 4) / waves
    )
    return centre + size * np.cumsum(np.stack([np.cos(heading), np.sin(heading)], axis=1), axis=0) / 80


def resample(points: Points, step_px: float) -> Points:
    """Points at about equal distances along the polyline, both ends kept."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    count = max(2, int(round(along[-1] / step_px)) + 1)
    at = np.linspace(0.0, along[-1], count)
    return np.stack([np.interp(at, along, points[:, k]) for k in (0, 1)], axis=1)


def _far_from(points: Points, others: Sequence[Points], least_px: float = 3.0) -> Points:
    """Crossings of a dense polyline with itself within a bend are the bend, not another corner."""
    taken = np.concatenate(others) if others else np.zeros((0, 2))
    if not len(points) or not len(taken):
        return points
    distance = np.hypot(*(points[:, None] - taken[None]).transpose(2, 0, 1)).min(axis=1)
    return points[distance > least_px]


def _length(points: Points) -> float:
    return float(np.hypot(*np.diff(points, axis=0).T).sum())


def _lengthen(points: NDArray[np.floating], count: int, end: int) -> NDArray[np.floating]:
    """Exactly `count` rows: the outermost one repeated where the stroke was shorter."""
    missing = count - len(points)
    if missing <= 0:
        return points
    extra = np.repeat(points[[end if end else 0]], missing, axis=0)
    return np.concatenate([points, extra]) if end else np.concatenate([extra, points])
