"""The ink on the simulated sheet: what the pen has drawn while it was down."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

Vector: TypeAlias = tuple[float, float, float]
"""x, y, z in mm."""
Polyline: TypeAlias = list[tuple[float, float]]
"""(x, y) in mm; a single point is a dot."""

_SAME_MM = 1e-6


@dataclass(frozen=True, slots=True)
class PenRule:
    """When the pen touches the sheet: at or below a height; with a servo when S is nearer `down_s` than `up_s`.

    up_is_minus: the height is counted downwards, so the pen touches at or above `down_at_mm`.
    """

    down_at_mm: float = 0.0
    up_is_minus: bool = False
    down_s: float | None = None
    up_s: float = 0.0

    def servo_down(self, speed: float) -> bool:
        """Whether the servo that gets this S (0: spindle off) holds the pen down."""
        return self.down_s is not None and abs(speed - self.down_s) < abs(speed - self.up_s)

    def part(self, start: Vector, end: Vector, speed: float) -> tuple[float, float] | None:
        """The part of a straight move, as fractions, on which the pen is down; None: nowhere."""
        if self.down_s is not None:
            return (0.0, 1.0) if self.servo_down(speed) else None
        up = -1.0 if self.up_is_minus else 1.0
        limit = up * self.down_at_mm + _SAME_MM
        from_mm, to_mm = up * start[2], up * end[2]
        if from_mm <= limit:
            return 0.0, 1.0 if to_mm <= limit else (limit - from_mm) / (to_mm - from_mm)
        return None if to_mm > limit else ((from_mm - limit) / (from_mm - to_mm), 1.0)


class Ink:
    """Gathers polylines in the coordinates of the sheet, which stay when the controller forgets where it is."""

    def __init__(self, rule: PenRule) -> None:
        self.rule = rule
        self.polylines: list[Polyline] = []
        self._open = False
        self._speed = 0.0

    def servo(self, speed: float, at: Vector) -> None:
        """The servo gets another S, at rest: where it puts the pen down there is a dot at least."""
        self._speed = speed
        if self.rule.down_s is not None:
            if self.rule.servo_down(speed):
                self._to(at[:2])
            else:
                self._open = False

    def travel(self, start: Vector, end: Vector) -> None:
        """A straight move that has been executed."""
        part = self.rule.part(start, end, self._speed)
        if part is not None:
            first, last = _between(start, end, part[0]), _between(start, end, part[1])
            if part[1] == 1.0 or not _same(first, last):  # a pen that is lifted straight up draws nothing
                self._to(first)
                self._to(last)
        self._open = part is not None and part[1] == 1.0

    def cut(self) -> None:
        """Motion was cut: what follows is another line, even from the same place."""
        self._open = False

    def clear(self) -> None:
        """A new sheet: a line that is under way begins anew."""
        self.polylines = []

    def copy(self) -> Ink:
        """The same ink, to draw on without changing this one."""
        other = Ink(self.rule)
        other.polylines = [list(line) for line in self.polylines]
        other._open, other._speed = self._open, self._speed
        return other

    def _to(self, point: tuple[float, float]) -> None:
        if not self._open or not self.polylines:
            self.polylines.append([point])
            self._open = True
            return
        line = self.polylines[-1]
        if not _same(line[-1], point):
            line.append(point)


def _same(a: tuple[float, float], b: tuple[float, float]) -> bool:
    return abs(a[0] - b[0]) <= _SAME_MM and abs(a[1] - b[1]) <= _SAME_MM


def _between(start: Vector, end: Vector, part: float) -> tuple[float, float]:
    return start[0] + (end[0] - start[0]) * part, start[1] + (end[1] - start[1]) * part
