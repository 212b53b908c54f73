"""Straight moves and arcs: how far a place is from one, and where a part of it ends."""

from __future__ import annotations

import math
from typing import NamedTuple, TypeAlias

from firmware_protocol.grbl.replies import Triple


class Straight(NamedTuple):
    """From start to end in mm."""

    start: Triple
    end: Triple

    @property
    def length_mm(self) -> float:
        return math.dist(self.start, self.end)

    def at(self, part: float) -> Triple:
        """The place after `part` (0 to 1) of the move."""
        return _between(self.start, self.end, part)

    def nearest(self, place: Triple) -> tuple[float, float]:
        """How far `place` is from the move in mm, and the part of the move that lies nearest."""
        along = [b - a for a, b in zip(self.start, self.end, strict=True)]
        square = math.fsum(d * d for d in along)
        dot = math.fsum(d * (p - a) for d, p, a in zip(along, place, self.start, strict=True))
        part = min(1.0, max(0.0, dot / square)) if square else 1.0
        return math.dist(place, self.at(part)), part

    @property
    def corners(self) -> tuple[Triple, ...]:
        """Places whose bounding box is that of the move."""
        return self.start, self.end


class Arc(NamedTuple):
    """An arc in the XY plane about `centre`, with Z going on evenly; start = end is a full circle."""

    start: Triple
    end: Triple
    centre: tuple[float, float]
    clockwise: bool

    @property
    def radius_mm(self) -> float:
        return math.dist(self.start[:2], self.centre)

    @property
    def off_circle_mm(self) -> float:
        """How far its end lies off the circle: GRBL takes 0.1 % of the radius, and goes straight there at the end."""
        return abs(math.dist(self.end[:2], self.centre) - self.radius_mm)

    @property
    def sweep(self) -> float:
        """The angle that is run through, in rad, always positive."""
        return self._turned(self.end) or math.tau

    @property
    def length_mm(self) -> float:
        return math.hypot(self.sweep * self.radius_mm, self.end[2] - self.start[2])

    def at(self, part: float) -> Triple:
        """The place after `part` (0 to 1) of the arc; the end is the programmed one."""
        if part >= 1.0:
            return self.end
        angle = self._angle(self.start) + (-1 if self.clockwise else 1) * part * self.sweep
        x, y = self.centre
        z = self.start[2] + part * (self.end[2] - self.start[2])
        return x + self.radius_mm * math.cos(angle), y + self.radius_mm * math.sin(angle), z

    def nearest(self, place: Triple) -> tuple[float, float]:
        """How far `place` is from the arc in mm, and the part of the arc that lies nearest."""
        part = self._turned(place) / self.sweep
        parts = [part] if part <= 1.0 else []
        return min((math.dist(place, self.at(each)), each) for each in [*parts, 0.0, 1.0])

    @property
    def corners(self) -> tuple[Triple, ...]:
        """Places whose bounding box is that of the arc."""
        (x, y), r, z = self.centre, self.radius_mm, self.start[2]
        extremes: list[Triple] = [(x + r, y, z), (x, y + r, z), (x - r, y, z), (x, y - r, z)]
        return self.start, self.end, *(each for each in extremes if self._turned(each) <= self.sweep)

    def _angle(self, place: Triple) -> float:
        return math.atan2(place[1] - self.centre[1], place[0] - self.centre[0])

    def _turned(self, place: Triple) -> float:
        turned = self._angle(place) - self._angle(self.start)
        turned = (-turned if self.clockwise else turned) % math.tau
        # What rounding has put just before the start lies at the start, not a whole turn behind it.
        return 0.0 if math.tau - turned < _SAME_RAD else turned


Move: TypeAlias = Straight | Arc

_SAME_RAD = 1e-9


def _between(start: Triple, end: Triple, part: float) -> Triple:
    x, y, z = (a + (b - a) * part for a, b in zip(start, end, strict=True))
    return x, y, z
