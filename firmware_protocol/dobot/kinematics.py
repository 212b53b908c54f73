"""The arm as a chain of links: joint angles to the place of the tool, back again, and how far it reaches.

x forward from the base axis, y to its left, z up from the height of the shoulder, in mm; joints in degrees: j1 turns
the base, j2 leans the rear arm forward from upright, j3 the forearm down from level, r = j1 + j4 turns the tool.
Links: user guide of the Magician, figure 2.9. The offset of the tool is the one that makes the farthest point the
stated reach of 320 mm: a model, to be measured on the arm at hand, which is why there is a margin.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeAlias

from firmware_protocol.ink import Vector

Joints: TypeAlias = tuple[float, float, float]
"""j1, j2, j3 in degrees."""
Range: TypeAlias = tuple[float, float]
Flat: TypeAlias = tuple[float, float]
"""x, y in mm."""

REAR_MM, FORE_MM = 135.0, 147.0
FARTHEST_MM = 320.0
TOOL_MM = FARTHEST_MM - (REAR_MM * math.sin(math.radians(85.0)) + FORE_MM)

SHEET_ORIGIN_MM = (190.0, -57.0)
"""Where the lower left corner of the sheet lies on the arm unless stated otherwise: with the sheet at the height 0, so
level with the base, a square of 114 mm is in reach from there on, which is about the largest that is."""
MARGIN_MM = 10.0
"""Kept from every end of the reach, because the model has not been compared with an arm."""

_TOLERANCE_DEG = 1e-6


@dataclass(frozen=True, slots=True)
class Limits:
    """How far each joint goes, in degrees."""

    j1: Range
    j2: Range
    j3: Range

    def allow(self, joints: Joints) -> bool:
        """Whether every joint is within."""
        ranges = (self.j1, self.j2, self.j3)
        return all(
            low - _TOLERANCE_DEG <= angle <= high + _TOLERANCE_DEG
            for angle, (low, high) in zip(joints, ranges, strict=True)
        )


GUIDE = Limits((-90.0, 90.0), (0.0, 85.0), (-10.0, 90.0))
"""Of the user guide V2.3.1."""
NARROW = Limits((-90.0, 90.0), (0.0, 85.0), (-10.0, 70.0))
"""What the user guide and drivers that were used on real arms agree on."""


def forward(joints: Joints) -> Vector:
    """Where the tool is."""
    j1, j2, j3 = map(math.radians, joints)
    radius_mm = REAR_MM * math.sin(j2) + FORE_MM * math.cos(j3) + TOOL_MM
    return radius_mm * math.cos(j1), radius_mm * math.sin(j1), REAR_MM * math.cos(j2) - FORE_MM * math.sin(j3)


def inverse(place: Vector) -> Joints | None:
    """The joint angles that put the tool there, elbow up; None where the links are too short or too long for it."""
    x, y, z = place
    radius_mm = math.hypot(x, y) - TOOL_MM
    away_mm = math.hypot(radius_mm, z)
    if not abs(FORE_MM - REAR_MM) <= away_mm <= REAR_MM + FORE_MM:
        return None
    cosine = (REAR_MM**2 + away_mm**2 - FORE_MM**2) / (2 * REAR_MM * away_mm)
    j2 = math.atan2(radius_mm, z) - math.acos(max(-1.0, min(1.0, cosine)))
    j3 = math.atan2(REAR_MM * math.cos(j2) - z, radius_mm - REAR_MM * math.sin(j2))
    return math.degrees(math.atan2(y, x)), math.degrees(j2), math.degrees(j3)


def reaches(place: Vector, limits: Limits = NARROW) -> bool:
    """Whether the tool gets there."""
    joints = inverse(place)
    return joints is not None and limits.allow(joints)


def radii_mm(height_mm: float, limits: Limits = NARROW) -> Range | None:
    """The least and the greatest distance from the base axis that are in reach at a height; None where none is.

    At one height the radius grows with j2 while j3 falls, so that the ends lie at an end of one of their ranges.
    """
    j2 = [limits.j2[0], limits.j2[1]]
    for angle, end in ((limits.j3[1], 0), (limits.j3[0], 1)):
        cosine = (height_mm + FORE_MM * math.sin(math.radians(angle))) / REAR_MM
        if (end == 0 and cosine < -1) or (end == 1 and cosine > 1):
            return None
        if -1 <= cosine <= 1:
            bound = math.degrees(math.acos(cosine))
            j2[end] = max(j2[0], bound) if end == 0 else min(j2[1], bound)
    if j2[0] > j2[1]:
        return None
    low, high = (_radius_mm(angle, height_mm) for angle in j2)
    return None if low is None or high is None else (low, high)


def _radius_mm(j2_deg: float, height_mm: float) -> float | None:
    sine = (REAR_MM * math.cos(math.radians(j2_deg)) - height_mm) / FORE_MM
    if not -1 <= sine <= 1:
        return None
    return REAR_MM * math.sin(math.radians(j2_deg)) + FORE_MM * math.sqrt(1 - sine * sine) + TOOL_MM


@dataclass(frozen=True, slots=True)
class Reach:
    """The flat area that the pen gets to at every height between the sheet and the lifted pen, less the margin."""

    low_mm: float
    high_mm: float

    @classmethod
    def between(cls, *heights_mm: float) -> Reach | None:
        """Of these heights and all between them; None where the heights are out of reach."""
        ranges = [radii_mm(height) for height in _steps(min(heights_mm), max(heights_mm))]
        lows = [pair[0] for pair in ranges if pair is not None]
        highs = [pair[1] for pair in ranges if pair is not None]
        if len(lows) < len(ranges) or max(lows) + MARGIN_MM > min(highs) - MARGIN_MM:
            return None
        return cls(max(lows) + MARGIN_MM, min(highs) - MARGIN_MM)

    def holds(self, start: Flat, end: Flat) -> bool:
        """Whether a straight line is in reach on its whole length."""
        outside = math.hypot(*start) > self.high_mm or math.hypot(*end) > self.high_mm
        behind = min(start[0], end[0]) < MARGIN_MM
        return not outside and not behind and _nearest_mm(start, end) >= self.low_mm

    def holds_box(self, corner: Flat, width_mm: float, height_mm: float) -> bool:
        """Whether a whole rectangle is in reach: no corner too far, its nearest side not too near."""
        x, y = corner
        right, top = x + width_mm, y + height_mm
        sides = [((x, y), (right, y)), ((right, y), (right, top)), ((right, top), (x, top)), ((x, top), (x, y))]
        return all(self.holds(*side) for side in sides)

    def largest_box_mm(self, corner: Flat, proportion: float) -> tuple[float, float]:
        """Size of the largest rectangle with this proportion of width to height from a corner on; 0, 0: none."""
        low, high = 0.0, 2 * self.high_mm
        if not self.holds_box(corner, 0.0, 0.0):
            return 0.0, 0.0
        while high - low > 0.01:
            middle = (low + high) / 2
            low, high = (middle, high) if self.holds_box(corner, middle * proportion, middle) else (low, middle)
        return low * proportion, low


def _steps(low_mm: float, high_mm: float) -> Iterator[float]:
    """The ends, and what lies between them millimetre by millimetre."""
    count = max(1, math.ceil(high_mm - low_mm))
    return (low_mm + (high_mm - low_mm) * step / count for step in range(count + 1))


def _nearest_mm(start: Flat, end: Flat) -> float:
    """Distance of the base axis from a straight line."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    length = dx * dx + dy * dy
    share = 0.0 if length == 0 else max(0.0, min(1.0, -(start[0] * dx + start[1] * dy) / length))
    return math.hypot(start[0] + share * dx, start[1] + share * dy)
