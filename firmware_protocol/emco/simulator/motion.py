"""Moves in time: how long a control needs for each, and for each line of a program."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, radians, sqrt

from firmware_protocol.emco.simulator.interpreter import Interpreter, Move
from firmware_protocol.ink import Vector

ACCELERATION_MM_S2 = 500.0
"""EMCO states none. This is on the slow side for a machine of its size, so an estimate is late rather than early."""

_STRAIGHT_ON = cos(radians(20))
"""With G64 a control runs through a bend of less than this; at a sharper one the model stops."""


class Clock:
    """Gives each move its seconds, knowing the one before: length by speed, and a stop where the path bends."""

    def __init__(self, *, acceleration_mm_s2: float = ACCELERATION_MM_S2) -> None:
        self._acceleration = acceleration_mm_s2
        self._direction: Vector | None = None
        self._mm_s = 0.0

    def seconds(self, move: Move) -> float:
        """How long this move takes behind the moves that were asked about before."""
        length = move.length_mm
        if length == 0:
            return 0.0
        direction = _direction(move, length)
        goes_on = self._direction is not None and move.mm_s == self._mm_s
        goes_on = goes_on and _dot(direction, self._direction) >= _STRAIGHT_ON
        self._direction, self._mm_s = direction, move.mm_s
        if goes_on:
            return length / move.mm_s
        # From rest to rest: a trapezoid, or a triangle where the move is too short for its speed.
        if length < move.mm_s**2 / self._acceleration:
            return 2 * sqrt(length / self._acceleration)
        return length / move.mm_s + move.mm_s / self._acceleration


def line_times_s(lines: Sequence[str]) -> list[float]:
    """When each line of a program will have been executed, in s from the start, by speeds and a usual acceleration.

    Raises firmware_protocol.emco.blocks.Alarm for a line that no control takes.
    """
    reader, clock = Interpreter(), Clock()
    times, now = [], 0.0
    for line in lines:
        now += sum(clock.seconds(move) for move in reader.take(line))
        times.append(now)
    return times


def _direction(move: Move, length: float) -> Vector:
    (ax, ay, az), (bx, by, bz) = move.start, move.end
    return (bx - ax) / length, (by - ay) / length, (bz - az) / length


def _dot(a: Vector, b: Vector | None) -> float:
    return 0.0 if b is None else a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
