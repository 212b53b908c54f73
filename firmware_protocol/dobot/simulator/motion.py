"""One move of the tool in time: along a straight line, or of all joints at once."""

from __future__ import annotations

import math
from dataclasses import dataclass

from firmware_protocol.dobot import alarms
from firmware_protocol.dobot.kinematics import GUIDE, Joints, Limits, forward, inverse
from firmware_protocol.ink import Vector

STEP_MM = 2.0
STEP_DEG = 1.0
"""How closely the way is looked at."""


@dataclass(frozen=True, slots=True)
class Pace:
    """Greatest speed and acceleration, in mm or degrees; without acceleration the speed is there at once."""

    speed: float
    acceleration: float = math.inf

    def seconds(self, length: float) -> float:
        """For a move from rest to rest."""
        if length <= 0 or self.speed <= 0:
            return 0.0
        ramp = self.speed**2 / self.acceleration if math.isfinite(self.acceleration) else 0.0
        if length >= ramp:
            return length / self.speed + ramp / self.speed
        return 2 * math.sqrt(length / self.acceleration)

    def done(self, length: float, seconds: float) -> float:
        """How much of the length lies behind after so many seconds."""
        whole_s = self.seconds(length)
        if seconds >= whole_s:
            return length
        if not math.isfinite(self.acceleration):
            return self.speed * seconds
        ramp_s = min(self.speed / self.acceleration, whole_s / 2)
        if seconds <= ramp_s:
            return self.acceleration * seconds**2 / 2
        if seconds >= whole_s - ramp_s:
            return length - self.acceleration * (whole_s - seconds) ** 2 / 2
        return self.acceleration * ramp_s**2 / 2 + self.acceleration * ramp_s * (seconds - ramp_s)


@dataclass(frozen=True, slots=True)
class Move:
    """way: places at equal parts of the length, two at least. alarm: what comes up at its end, None: nothing."""

    way: tuple[Vector, ...]
    length: float
    pace: Pace
    alarm: int | None = None

    @property
    def seconds(self) -> float:
        """How long it takes."""
        return self.pace.seconds(self.length)

    @property
    def end(self) -> Vector:
        """Where it ends."""
        return self.way[-1]

    def until(self, seconds: float) -> list[Vector]:
        """The way that lies behind after so many seconds, from its start to where the tool is then."""
        if seconds >= self.seconds:
            return list(self.way)
        part = self.pace.done(self.length, seconds) / self.length * (len(self.way) - 1)
        whole = int(part)
        a, b, rest = self.way[whole], self.way[whole + 1], part - whole
        here = (a[0] + (b[0] - a[0]) * rest, a[1] + (b[1] - a[1]) * rest, a[2] + (b[2] - a[2]) * rest)
        return [*self.way[: whole + 1], here]


def why_not(place: Vector, limits: Limits = GUIDE) -> int | None:
    """The alarm of a target that is out of reach; None: it is in reach."""
    joints = inverse(place)
    if joints is None:
        return alarms.NO_INVERSE
    return None if limits.allow(joints) else alarms.BEYOND_LIMIT


def straight(start: Vector, end: Vector, pace: Pace) -> Move:
    """In a line, as far as the way is in reach: where it is not, the arm stops with an alarm."""
    length_mm = math.dist(start, end)
    count = max(1, math.ceil(length_mm / STEP_MM))
    places = [_between(start, end, step / count) for step in range(count + 1)]
    way, alarm = _in_reach(places)
    if alarm is None:
        return Move((start, end), length_mm, pace)
    return Move((start, way[-1]), math.dist(start, way[-1]), pace, alarm)


def turning(start: Vector, end: Vector, pace: Pace) -> Move:
    """All joints at once, each on its whole way; start and end are in reach."""
    first, last = inverse(start), inverse(end)
    if first is None or last is None:
        return straight(start, end, pace)
    degrees = max(abs(b - a) for a, b in zip(first, last, strict=True))
    count = max(1, math.ceil(degrees / STEP_DEG))
    places = [forward(_joints_between(first, last, step / count)) for step in range(count + 1)]
    return Move((start, *places[1:-1], end), degrees, pace)


def _in_reach(places: list[Vector]) -> tuple[list[Vector], int | None]:
    """The places up to the first that is out of reach, and the alarm of that one. The first may be anywhere."""
    for number, place in enumerate(places[1:], 1):
        if (alarm := why_not(place)) is not None:
            return places[:number], alarm + alarms.MOVING_OFFSET
    return places, None


def _between(start: Vector, end: Vector, part: float) -> Vector:
    x, y, z = (a + (b - a) * part for a, b in zip(start, end, strict=True))
    return x, y, z


def _joints_between(start: Joints, end: Joints, part: float) -> Joints:
    j1, j2, j3 = (a + (b - a) * part for a, b in zip(start, end, strict=True))
    return j1, j2, j3
