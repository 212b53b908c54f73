"""Curved ink: smooth, at sub-pixel places, of several widths, with corners only where a person sees one.

A corner is an end, a crossing, or a sharp bend: a local maximum of the turning angle over +-5 px above 60 degrees.
Unsure (training/render.py) is what two people would not agree on: bends of 40 to 60 degrees, crossings of lines that
meet at less than 25 degrees and so run together for a while, ends that lie on another line and run along it, and
everything where lines have melted into a blot more than four lines thick.
"""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from training.render import LINES, UNSURE, Points, Sample, draw, label, meetings

BEND_PX = 5
BEND_DEGREES, SOFT_BEND_DEGREES = 60.0, 40.0
FLAT_DEGREES = 25.0
"""Two lines that meet at less have no place where they cross, but a stretch."""
_STEP_PX = 1.0
_CLOSED_WITHIN_PX = 1.5
_LONGEST_MELT_PX = 16.0


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
    free, hidden = _ends(even, line_px)
    sharp = [stroke[sharp_bends(stroke)] for stroke in even]
    soft = [stroke[sharp_bends(stroke, SOFT_BEND_DEGREES)] for stroke in even]
    # Where a closed stroke meets itself is no crossing, only a corner if it bends there.
    known = np.concatenate([free, hidden, *sharp, *(stroke[:1] for stroke in even if _closed(stroke))])
    crossed, sine = meetings([resample(s, 3.0) for s in even])
    flat = sine < np.sin(np.radians(FLAT_DEGREES))
    sure = np.concatenate([free, *sharp, _far_from(crossed[~flat], known)])
    melt_px = np.minimum(line_px / np.maximum(sine[flat], 1e-3), _LONGEST_MELT_PX) / 2
    unsure = np.concatenate([hidden, *soft, crossed[flat]])
    radius_px = np.concatenate([np.full(len(unsure) - len(melt_px), line_px / 2), melt_px]) + 2.5
    labelled = label(ink, np.rint(sure).astype(np.int32))
    labelled[(labelled == LINES) & _discs(unsure, radius_px, canvas_px)] = UNSURE
    labelled[(labelled > 0) & _melted(ink, line_px)] = UNSURE
    return Sample(ink, labelled)


def _melted(ink: NDArray[np.uint8], line_px: int) -> NDArray[np.bool_]:
    """Where ink is more than four lines thick, and a little around: scribbles."""
    deep = cv2.distanceTransform((ink > 127).astype(np.uint8), cv2.DIST_L2, 3) > 2 * line_px
    size = 2 * (3 * line_px) + 1
    return cv2.dilate(deep.astype(np.uint8), np.ones((size, size), np.uint8)).astype(bool)


def _discs(at: Points, radius_px: NDArray[np.float64], canvas_px: int) -> NDArray[np.bool_]:
    mask = np.zeros((canvas_px, canvas_px), np.uint8)
    for (x, y), radius in zip(np.rint(at).astype(int).tolist(), np.rint(radius_px).astype(int).tolist(), strict=True):
        cv2.circle(mask, (x, y), radius, 1, -1)
    return mask.astype(bool)


def _ends(even: Sequence[Points], line_px: int) -> tuple[Points, Points]:
    """Ends that are seen, and ends that lie on another line (or an earlier part of their own) and run along it."""
    free, hidden = [np.zeros((0, 2))], [np.zeros((0, 2))]
    every = np.concatenate(even)
    forward = np.concatenate([np.gradient(stroke, axis=0) for stroke in even])
    first = np.cumsum([0, *(len(stroke) for stroke in even)])
    own = 3 * line_px
    for k, stroke in enumerate(even):
        if _closed(stroke):
            continue
        for end, inner, a, b in (
            (stroke[0], stroke[min(BEND_PX, len(stroke) - 1)], first[k], min(first[k] + own, first[k + 1])),
            (stroke[-1], stroke[-min(BEND_PX + 1, len(stroke))], max(first[k + 1] - own, first[k]), first[k + 1]),
        ):
            distance = np.hypot(*(every - end).T)
            distance[a:b] = np.inf
            nearest = int(distance.argmin())
            along = end - inner
            turn = abs(along[0] * forward[nearest, 1] - along[1] * forward[nearest, 0])
            size = max(float(np.hypot(*along) * np.hypot(*forward[nearest])), 1e-9)
            runs_along = turn / size < np.sin(np.radians(FLAT_DEGREES))
            (hidden if distance[nearest] < line_px / 2 + 0.5 and runs_along else free).append(end[None])
    return np.concatenate(free), np.concatenate(hidden)


def sharp_bends(even: Points, degrees: float = BEND_DEGREES) -> NDArray[np.intp]:
    """Indices of the bends sharper than `degrees` on a polyline resampled at 1 px."""
    k = round(BEND_PX / _STEP_PX)
    if len(even) < 2 * k + 1:
        return np.zeros(0, np.intp)
    if _closed(even):
        around = np.concatenate([even[-2 * k - 1 : -1], even, even[1 : 2 * k + 1]])
        turned = _bends_open(around, k, degrees) - 2 * k
        return turned[(turned >= 0) & (turned < len(even) - 1)]
    return _bends_open(even, k, degrees)


def _bends_open(even: Points, k: int, degrees: float) -> NDArray[np.intp]:
    """Indices, none of the first or last k, where the angle between the k steps before and after has a high maximum."""
    into, out = even[k:-k] - even[: -2 * k], even[2 * k :] - even[k:-k]
    turn = np.abs(np.arctan2(into[:, 0] * out[:, 1] - into[:, 1] * out[:, 0], (into * out).sum(axis=1)))
    padded = np.pad(turn, k)
    highest = np.max([padded[i : i + len(turn)] for i in range(2 * k + 1)], axis=0)
    found = np.nonzero((turn >= np.radians(degrees)) & (turn == highest))[0]
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


def _far_from(points: Points, taken: Points, least_px: float = 3.0) -> Points:
    """Crossings of a dense polyline with itself within a bend are the bend, not another corner."""
    if not len(points) or not len(taken):
        return points
    distance = np.hypot(*(points[:, None] - taken[None]).transpose(2, 0, 1)).min(axis=1)
    return points[distance > least_px]


def _closed(even: Points) -> bool:
    return len(even) > 4 and float(np.hypot(*(even[-1] - even[0]))) <= _CLOSED_WITHIN_PX


def _length(points: Points) -> float:
    return float(np.hypot(*np.diff(points, axis=0).T).sum())
