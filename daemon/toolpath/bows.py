"""The arcs between two places, to about half a turn on either side, and which of them are near to all samples."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from daemon.shapes import Arc, Line, Points

Floats = NDArray[np.float64]

_LARGEST_RADIUS_MM = 1000.0
"""Flatter arcs are straight enough to be drawn in pieces; their centres are beyond a controller's single precision."""
_LARGEST_BULGE = 1.1
"""A little more than half a turn, so that two of them are a circle wherever the samples lie."""

_LEAST_HEIGHT = 0.1


class Bow(NamedTuple):
    """start, end: (2,) in mm. bulge: twice the height by the length of the chord, above 0 where it lies to the left."""

    start: Floats
    end: Floats
    bulge: float

    @property
    def height(self) -> float:
        return abs(self.bulge) * math.dist(self.start, self.end) / 2

    def move(self, end: tuple[float, float]) -> Line | Arc:
        """As a move to `end`, which is its end as plain numbers."""
        if self.bulge == 0:
            return Line(end)
        along = self.end - self.start
        aside = (self.bulge - 1 / self.bulge) / 4
        x, y = ((self.start + self.end) / 2 + aside * np.array([-along[1], along[0]])).tolist()
        return Arc(end, (x, y), clockwise=self.bulge > 0)


def bow(samples: Points, *, error_mm: float) -> Bow | None:
    """One from the first to the last sample that no sample is further from than error_mm; None where there is none.

    samples: (N, 2), N >= 2. A straight line where that is near enough, else the arc in the middle of those that are.
    The samples also follow each other along it: none lies further back than error_mm behind one before it.
    """
    seen = _seen(samples)
    if seen is None:
        return None
    u, v, chord = seen
    least, most = _bulges(u, v, chord, error_mm)
    if least > most or least > _LARGEST_BULGE or most < -_LARGEST_BULGE:
        return None
    bulge = 0.0 if least <= 0 <= most else min(_LARGEST_BULGE, max(-_LARGEST_BULGE, (least + most) / 2))
    return Bow(samples[0], samples[-1], bulge) if _holds(u, v, chord, bulge, error_mm) else None


def nearest(samples: Points, found: Bow, *, error_mm: float) -> Bow:
    """The bow between the same ends that lies in the midst of the samples, where it is as near to all of them.

    Least squares of how far samples are from the arc, to first order: the bulge through each, weighed by how far its
    place moves with the bulge. Straight where the arc would be no higher than a tenth of the error.
    """
    seen = _seen(samples)
    if seen is None or len(seen[0]) == 0:
        return found
    u, v, chord = seen
    lever = np.square(np.maximum(u * (chord - u), 0.0) + v * v)
    bulge = float(lever @ _bulge_through(u, v, chord) / max(float(lever.sum()), 1e-12))
    bulge = 0.0 if abs(bulge) * chord / 2 < _LEAST_HEIGHT * error_mm else bulge
    better = abs(bulge) <= _LARGEST_BULGE and _holds(u, v, chord, bulge, error_mm)
    return found._replace(bulge=bulge) if better else found


def _seen(samples: Points) -> tuple[Floats, Floats, float] | None:
    """The inner samples along the chord and to its left, and its length; None where the ends are one place."""
    chord = math.dist(samples[0], samples[-1])
    if chord == 0:
        return None
    along, off = (samples[-1] - samples[0]) / chord, samples[1:-1] - samples[0]
    return off @ along, off[:, 1] * along[0] - off[:, 0] * along[1], chord


def _holds(u: Floats, v: Floats, chord: float, bulge: float, error_mm: float) -> bool:
    """Whether all samples are near enough to the bow, and follow each other along it."""
    if bulge and chord * (abs(bulge) + 1 / abs(bulge)) / 4 > _LARGEST_RADIUS_MM:
        return False
    away, place = _along_arc(u, v, chord, bulge) if bulge else _along_chord(u, v, chord)
    back = (np.maximum.accumulate(place) - place).max(initial=0.0)
    return bool(max(away.max(initial=0.0), back) <= error_mm)


def _bulges(u: Floats, v: Floats, chord: float, error_mm: float) -> tuple[float, float]:
    """The range of bulges whose arcs are near enough to every sample, those near the ends aside, which all are near.

    u, v: along the chord and to its left. The arcs between two places fill the plane without crossing, so the arcs
    within error_mm of a sample are those between the one through a place so far above it and the one below.
    """
    far = np.minimum(u * u, (u - chord) ** 2) + v * v > error_mm * error_mm
    u, v = u[far], v[far]
    if not len(u):
        return 0.0, 0.0
    # From the centre of the circle through the ends and the sample; on the chord itself it is straight up.
    across, up = (u - chord / 2) * v, (v * v - u * u + chord * u) / 2
    length = np.hypot(across, up)
    flat = length < 1e-12
    length[flat], up[flat] = 1.0, 1.0
    step = np.copysign(error_mm / length, up)
    higher = _bulge_through(u + step * across, v + step * up, chord)
    lower = _bulge_through(u - step * across, v - step * up, chord)
    return float(lower.max()), float(higher.min())


def _bulge_through(u: Floats, v: Floats, chord: float) -> Floats:
    """The bulge of the arc through a place, on the side of the chord where the place lies."""
    aside = u * u + v * v - chord * u
    height = np.maximum(np.abs(v), 1e-12)
    ratio = aside / (chord * height)
    # Of the two forms of one number each is exact where the other cancels.
    root = np.hypot(1.0, ratio)
    return np.copysign(np.where(ratio > 0, root + ratio, 1 / (root - np.minimum(ratio, 0.0))), v)


def _along_chord(u: Floats, v: Floats, chord: float) -> tuple[Floats, Floats]:
    """How far each sample is from the chord, and how far along it the nearest place is."""
    place = np.clip(u, 0.0, chord)
    return np.hypot(u - place, v), place


def _along_arc(u: Floats, v: Floats, chord: float, bulge: float) -> tuple[Floats, Floats]:
    """How far each sample is from the arc, and how far along it the nearest place is."""
    side = math.copysign(1.0, bulge)
    radius = chord * (abs(bulge) + 1 / abs(bulge)) / 4
    x, y = u - chord / 2, v * side - chord * (abs(bulge) - 1 / abs(bulge)) / 4
    half = 2 * math.atan(abs(bulge))
    angle = np.arctan2(x, y)
    to_ends = np.minimum(np.hypot(u, v), np.hypot(u - chord, v))
    away = np.where(np.abs(angle) <= half, np.abs(np.hypot(x, y) - radius), to_ends)
    return away, radius * np.clip(angle, -half, half)
