"""A simulated machine whose axes are not what its controller believes: wrong scale, skew and backlash."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

from firmware_protocol.ink import Ink, PenRule, Vector


@dataclass(frozen=True, slots=True)
class Crooked:
    """scale_x, scale_y: mm that the pen goes for one mm asked for. skew_deg: so far the Y axis leans towards +X.

    backlash_mm: so far X and Y run before the pen follows, when they turn round.
    """

    scale_x: float = 1.0
    scale_y: float = 1.0
    skew_deg: float = 0.0
    backlash_mm: tuple[float, float] = (0.0, 0.0)

    def place(self, x_mm: float, y_mm: float) -> tuple[float, float]:
        """Where on the sheet the pen is when its axes stand there."""
        lean = math.radians(self.skew_deg)
        along_mm = self.scale_y * y_mm
        return self.scale_x * x_mm + along_mm * math.sin(lean), along_mm * math.cos(lean)


class CrookedInk(Ink):
    """The ink of a crooked machine. Each axis lags half its backlash behind the way it last went; at first nowhere."""

    def __init__(self, rule: PenRule, crooked: Crooked) -> None:
        super().__init__(rule)
        self._crooked, self._lag_mm = crooked, (0.0, 0.0)

    def servo(self, speed: float, at: Vector) -> None:
        super().servo(speed, self._on_sheet(at))

    def travel(self, start: Vector, end: Vector) -> None:
        for before, after in pairwise(list(self._stops(start, end))):
            begin = self._on_sheet(before)
            self._lag_mm = self._lag_behind(before, after)
            super().travel(begin, self._on_sheet(after))

    def copy(self) -> Ink:
        other = CrookedInk(self.rule, self._crooked)
        other.__dict__.update(super().copy().__dict__)
        other._lag_mm = self._lag_mm
        return other

    def _stops(self, start: Vector, end: Vector) -> Iterator[Vector]:
        """From start to end, by way of where an axis has run through its backlash."""
        parts = {0.0, 1.0}
        for axis in (0, 1):
            way_mm = end[axis] - start[axis]
            left_mm = math.copysign(self._crooked.backlash_mm[axis] / 2, way_mm) - self._lag_mm[axis]
            if way_mm and 0 < left_mm / way_mm < 1:
                parts.add(left_mm / way_mm)
        for part in sorted(parts):
            x, y, z = (a + (b - a) * part for a, b in zip(start, end, strict=True))
            yield x, y, z

    def _lag_behind(self, before: Vector, after: Vector) -> tuple[float, float]:
        x_mm, y_mm = (
            max(-play_mm / 2, min(play_mm / 2, self._lag_mm[axis] + after[axis] - before[axis]))
            for axis, play_mm in enumerate(self._crooked.backlash_mm)
        )
        return x_mm, y_mm

    def _on_sheet(self, at: Vector) -> Vector:
        x_mm, y_mm = self._crooked.place(at[0] - self._lag_mm[0], at[1] - self._lag_mm[1])
        return x_mm, y_mm, at[2]
