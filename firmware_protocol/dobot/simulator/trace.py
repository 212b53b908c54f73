"""What the tool has really done, in the coordinates of the sheet, and the ink of it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

from firmware_protocol.dobot.kinematics import Flat
from firmware_protocol.ink import Ink, PenRule, Polyline, Vector


class Trace:
    """origin_mm: where the sheet's lower left corner lies on the arm."""

    def __init__(self, pen: PenRule, origin_mm: Flat) -> None:
        self._ink, self._origin_mm = Ink(pen), origin_mm
        self.astray_deg = 0.0
        """How far the base is turned from what the arm believes: lost at a power cut, found by homing."""

    def draw(self, way: Sequence[Vector]) -> None:
        """A way that has been gone, in the arm's own belief."""
        self._draw(way, self._ink)

    def cut(self) -> None:
        """The motion was cut."""
        self._ink.cut()

    def clear(self) -> None:
        self._ink.clear()

    def ink(self, way: Sequence[Vector]) -> list[Polyline]:
        """What is on the sheet, `way` of the present move included."""
        ink = self._ink.copy()
        self._draw(way, ink)
        return ink.polylines

    def touches(self, place: Vector) -> bool:
        """Whether the pen is on the sheet there."""
        at = self._on_sheet(place)
        return self._ink.rule.part(at, at, 0.0) is not None

    def _draw(self, way: Sequence[Vector], ink: Ink) -> None:
        for start, end in pairwise(map(self._on_sheet, way)):
            ink.travel(start, end)

    def _on_sheet(self, place: Vector) -> Vector:
        turn = math.radians(self.astray_deg)
        x_mm = place[0] * math.cos(turn) - place[1] * math.sin(turn)
        y_mm = place[0] * math.sin(turn) + place[1] * math.cos(turn)
        return x_mm - self._origin_mm[0], y_mm - self._origin_mm[1], place[2]
