"""Curved ink: smooth, at sub-pixel places, of several widths, with corners only where a person sees one.

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
_CLOSED_WITHIN_PX = 1.5


def smooth(stroke: NDArray[np.float32], sigma_points: float) -> Points:
    """Gaussian along the path, ends kept."""
    reach = int(np.ceil(3 * sigma_points))
    if len(stroke) < 3 or reach == 0:
        return stroke.astype(float)
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma_points) ** 2)
    # Mirrored through the end points; a stroke shorter than the kernel is pulled back to its ends.
    before, after = 2 * stroke[0] - stroke[reach:0:-1], 2 * stroke[-1] - stroke[-2 : -reach - 2 : -1]
    padded = np.concatenate([before, stroke, after])
    padded = np.pad(padded, ((reach - len(before), reach - len(after)), (0, 0)), mode="edge")
    done = np.stack([np.convolve(padded[:, k], kernel / kernel.sum(), "valid") for k in (0, 1)], axis=1)
    done[[0, -1]] = stroke[[0, -1]]
    return done


def curves(strokes: Sequence[Points], canvas_px: int, line_px: int) -> Sample:
    """Strokes in canvas px, already smooth."""
    even = [resample(stroke, _STEP_PX) for stroke in strokes if _length(stroke) >= 2.0]
    ink = np.zeros((canvas_px, canvas_px), np.uint8)
    if not even:
        return Sample(ink, np.zeros_like(ink))
    draw(ink, even, line_px)
    corners = [stroke[[0, -1]] for stroke in even if not _closed(stroke)]
    corners += [stroke[sharp_bends(stroke)] for stroke in even]
    # Where a closed stroke meets itself is no crossing, only a corner if it bends there.
    known = [*corners, *(stroke[:1] for stroke in even if _closed(stroke))]
    corners.append(_far_from(crossings([resample(s, 3.0) for s in even]), known))
    return Sample(ink, label(ink, np.rint(np.concatenate(corners)).astype(np.int32)))


def sharp_bends(even: Points) -> NDArray[np.intp]:
    """Indices of sharp bends on a polyline resampled at 1 px."""
    k = round(BEND_PX / _STEP_PX)
    if len(even) < 2 * k + 1:
        return np.zeros(0, np.intp)
    if _closed(even):
        turned = sharp_bends_open(np.concatenate([even[-2 * k - 1 : -1], even, even[1 : 2 * k + 1]]), k) - 2 * k
        return turned[(turned >= 0) & (turned < len(even) - 1)]
    return sharp_bends_open(even, k)


def sharp_bends_open(even: Points, k: int) -> NDArray[np.intp]:
    """Indices, none of the first or last k, where the angle between the k steps before and after has a high maximum."""
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
    count = max(2, round(along[-1] / step_px) + 1)
    at = np.linspace(0.0, along[-1], count)
    return np.stack([np.interp(at, along, points[:, k]) for k in (0, 1)], axis=1)


def _far_from(points: Points, others: Sequence[Points], least_px: float = 3.0) -> Points:
    """Crossings of a dense polyline with itself within a bend are the bend, not another corner."""
    taken = np.concatenate(others) if others else np.zeros((0, 2))
    if not len(points) or not len(taken):
        return points
    distance = np.hypot(*(points[:, None] - taken[None]).transpose(2, 0, 1)).min(axis=1)
    return points[distance > least_px]


def _closed(even: Points) -> bool:
    return len(even) > 4 and float(np.hypot(*(even[-1] - even[0]))) <= _CLOSED_WITHIN_PX


def _length(points: Points) -> float:
    return float(np.hypot(*np.diff(points, axis=0).T).sum())
