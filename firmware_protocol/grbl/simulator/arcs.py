"""Arcs as the chords that GRBL 1.1 draws for them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import atan2, cos, floor, hypot, pi, sin, sqrt

from firmware_protocol.gcode import GcodeError
from firmware_protocol.grbl.simulator.lookahead import Move, Vector

PLANE_AXES = {170: (0, 1, 2), 180: (2, 0, 1), 190: (1, 2, 0)}
"""G17, G18, G19 times ten: the two axes of the plane and the one across it."""

END_OFF_CIRCLE = 33
RADIUS_TOO_SMALL = 34

_FULL_TURN_RAD = 5e-7


def centre_of_radius(x_mm: float, y_mm: float, radius_mm: float, *, clockwise: bool) -> tuple[float, float]:
    """Start to centre for an arc of that radius whose end lies (x, y) from its start; negative: the long way.

    Raises GcodeError(34) when the radius does not reach.
    """
    square = 4.0 * radius_mm * radius_mm - x_mm * x_mm - y_mm * y_mm
    if square < 0:
        raise GcodeError(RADIUS_TOO_SMALL)
    height = -sqrt(square) / hypot(x_mm, y_mm)
    if clockwise == (radius_mm < 0):
        height = -height
    return 0.5 * (x_mm - y_mm * height), 0.5 * (y_mm + x_mm * height)


def check_end(x_mm: float, y_mm: float, centre: tuple[float, float]) -> None:
    """Raise GcodeError(33) when the end is off the circle by more than 0.005 mm and 0.1 % of the radius, or 0.5 mm."""
    radius = hypot(*centre)
    off = abs(hypot(x_mm - centre[0], y_mm - centre[1]) - radius)
    if off > 0.005 and (off > 0.5 or off > 0.001 * radius):
        raise GcodeError(END_OFF_CIRCLE)


def chords(
    move: Move, start: Vector, centre: tuple[float, float], *, plane: int, clockwise: bool, tolerance_mm: float
) -> Iterator[Move]:
    """The straight moves of an arc from `start` to the move's target (`mc_arc`); `centre` is counted from the start."""
    first, second, across = PLANE_AXES[plane]
    target = move.target_mm
    rx, ry = -centre[0], -centre[1]
    tx, ty = target[first] - start[first] + rx, target[second] - start[second] + ry
    travel = _travel_rad(rx, ry, tx, ty, clockwise=clockwise)
    radius = hypot(rx, ry)
    count = floor(abs(0.5 * travel * radius) / sqrt(max(tolerance_mm * (2 * radius - tolerance_mm), 1e-12)))
    if move.inverse_time and count:
        move = replace(move, feed=move.feed * count)
    for index in range(1, count):
        angle, place = travel * index / count, [0.0, 0.0, 0.0]
        place[first] = start[first] - rx + rx * cos(angle) - ry * sin(angle)
        place[second] = start[second] - ry + rx * sin(angle) + ry * cos(angle)
        place[across] = start[across] + (target[across] - start[across]) * index / count
        yield replace(move, target_mm=(place[0], place[1], place[2]))
    yield move


def _travel_rad(rx: float, ry: float, tx: float, ty: float, *, clockwise: bool) -> float:
    travel = atan2(rx * ty - ry * tx, rx * tx + ry * ty)
    if clockwise and travel >= -_FULL_TURN_RAD:
        return travel - 2 * pi
    if not clockwise and travel <= _FULL_TURN_RAD:
        return travel + 2 * pi
    return travel
