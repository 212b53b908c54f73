"""What the blocks of a program make the machine do: modal state, known words, limits of travel and feed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from math import atan2, cos, hypot, pi, sin, sqrt

from firmware_protocol.emco.blocks import Alarm, Word, read_block
from firmware_protocol.emco.dialects import RAPID_MM_MIN, SIEMENS, Dialect, dialect_of
from firmware_protocol.errors import LocalProtocolError
from firmware_protocol.ink import Vector

ARC_TOLERANCE_MM = 0.01
"""How far the end of an arc may lie off its circle."""
CHORD_MM = 0.005
"""How far the chord of an arc may lie off it."""

_MOTION = frozenset({0.0, 1.0, 2.0, 3.0})
_SETTINGS = frozenset({17.0, 54.0, 64.0, 90.0, 94.0})
_KNOWN_M = frozenset({0.0, 5.0, 9.0, 30.0})
_ADDRESSES = frozenset({"G", "M", "X", "Y", "Z", "I", "J", "R", "CR=", "F", "T", "D"})
_AXES = ("X", "Y", "Z")


@dataclass(frozen=True, slots=True)
class Move:
    """A straight move in the coordinates of the program, in mm, at `mm_s`."""

    start: Vector
    end: Vector
    mm_s: float

    @property
    def length_mm(self) -> float:
        return math.dist(self.start, self.end)


@dataclass(frozen=True, slots=True)
class Room:
    """Where the axes can go, in the coordinates of the program (mm), and the fastest feed."""

    low_mm: Vector
    high_mm: Vector
    feed_mm_min: float = RAPID_MM_MIN


class Interpreter:
    """Reads one program, line by line, as the control does.

    dialect: None takes the one that the first line belongs to. room: None checks neither travel nor feed.
    """

    def __init__(self, dialect: Dialect | None = None, *, room: Room | None = None, at_mm: Vector = (0, 0, 0)) -> None:
        self.dialect, self._room = dialect, room
        """Known at the latest behind the first line."""
        self._lines = 0
        self._motion: float | None = None
        self._feed_mm_min = 0.0
        self.position_mm = at_mm
        self.ended = False
        """M30 has been read: what follows is passed over."""
        self.stopped = False
        """M0 has been read: the control waits for START."""

    def take(self, line: str) -> list[Move]:
        """The moves of the next line. Raises Alarm, with which the control stops reading."""
        self._lines += 1
        if self._lines == 1:
            self._begin(line)
            return []
        if self.ended or line.strip() == "":
            return []
        if self._lines == 2 and self._named(line):
            return []
        assert self.dialect is not None
        return self._execute(read_block(line, self.dialect), line)

    def _begin(self, line: str) -> None:
        try:
            found, _ = dialect_of(line)
        except LocalProtocolError:
            raise Alarm(f"no program begins with {line[:40]!r}") from None
        if self.dialect is not None and found is not self.dialect:
            raise Alarm(f"the control speaks {self.dialect.name}, the program is for {found.name}")
        self.dialect = found

    def _named(self, line: str) -> bool:
        if self.dialect is SIEMENS:
            return False
        assert self.dialect is not None
        try:
            self.dialect.check_name(line.strip())
        except LocalProtocolError:
            raise Alarm(f"no program number: {line[:40]}") from None
        return True

    def _execute(self, words: list[Word], line: str) -> list[Move]:
        values: dict[str, float] = {}
        for address, value in words:
            if address not in _ADDRESSES:
                raise Alarm(f"address {address} is not known: {line[:40]}")
            if address == "G":
                self._prepare(value)
            elif address == "M":
                self._miscellaneous(value)
            elif address in values:
                raise Alarm(f"address {address} stands twice: {line[:40]}")
            else:
                values[address] = value
        if "F" in values:
            self._set_feed(values["F"])
        return self._move(values, line) if any(axis in values for axis in _AXES) else []

    def _prepare(self, code: float) -> None:
        assert self.dialect is not None
        if code in _MOTION:
            self._motion = code
        elif code not in _SETTINGS and f"G{code:g}" != self.dialect.metric:
            raise Alarm(f"G{code:g} is not known")

    def _miscellaneous(self, code: float) -> None:
        if code not in _KNOWN_M:
            raise Alarm(f"M{code:g} is not known")
        self.ended = self.ended or code == 30
        self.stopped = self.stopped or code == 0

    def _set_feed(self, mm_min: float) -> None:
        limit = self._room.feed_mm_min if self._room else math.inf
        if not 0 < mm_min <= limit:
            raise Alarm(f"feed F{mm_min:g} is not allowed")
        self._feed_mm_min = mm_min

    def _move(self, values: dict[str, float], line: str) -> list[Move]:
        if self._motion is None:
            raise Alarm(f"no G0, G1, G2 or G3 is active: {line[:40]}")
        if self._motion and not self._feed_mm_min:
            raise Alarm(f"no feed is programmed: {line[:40]}")
        start = self.position_mm
        end = tuple(values.get(axis, at) for axis, at in zip(_AXES, start, strict=True))
        places = self._places(start, (end[0], end[1], end[2]), values)
        for place in places:
            self._check_room(place)
        mm_s = (self._feed_mm_min if self._motion else RAPID_MM_MIN) / 60
        self.position_mm = places[-1]
        return [Move(a, b, mm_s) for a, b in zip([start, *places], places, strict=False)]

    def _places(self, start: Vector, end: Vector, values: dict[str, float]) -> list[Vector]:
        assert self._motion is not None
        if self._motion < 2:
            return [end]
        clockwise = self._motion == 2
        radius = values.get("R", values.get("CR="))
        if radius is not None:
            centre = _centre(end[0] - start[0], end[1] - start[1], radius, clockwise=clockwise)
        else:
            centre = (values.get("I", 0.0), values.get("J", 0.0))
        return chords(start, end, centre, clockwise=clockwise)

    def _check_room(self, place: Vector) -> None:
        if self._room is None:
            return
        for axis, at, low, high in zip(_AXES, place, self._room.low_mm, self._room.high_mm, strict=True):
            if not low - 1e-6 <= at <= high + 1e-6:
                raise Alarm(f"axis {axis} would leave its travel at {axis}{at:.3f}")


def chords(start: Vector, end: Vector, centre: tuple[float, float], *, clockwise: bool) -> list[Vector]:
    """Places along an arc in the plane of X and Y, the end included; `centre` is counted from the start.

    Raises Alarm when the end lies off the circle.
    """
    rx, ry = -centre[0], -centre[1]
    tx, ty = end[0] - start[0] + rx, end[1] - start[1] + ry
    radius = hypot(rx, ry)
    if radius == 0 or abs(hypot(tx, ty) - radius) > ARC_TOLERANCE_MM:
        raise Alarm(f"the end of the arc to X{end[0]:.3f} Y{end[1]:.3f} is not on its circle")
    turn = atan2(rx * ty - ry * tx, rx * tx + ry * ty)
    if clockwise and turn >= -1e-9:
        turn -= 2 * pi
    elif not clockwise and turn <= 1e-9:
        turn += 2 * pi
    count = max(1, math.ceil(abs(turn) * radius / sqrt(8 * radius * CHORD_MM)))
    places: list[Vector] = []
    for index in range(1, count):
        part = index / count
        c, s = cos(turn * part), sin(turn * part)
        x, y = start[0] - rx + rx * c - ry * s, start[1] - ry + rx * s + ry * c
        places.append((x, y, start[2] + (end[2] - start[2]) * part))
    return [*places, end]


def _centre(x: float, y: float, radius: float, *, clockwise: bool) -> tuple[float, float]:
    """Start to centre of the arc with that radius (negative: the long way) whose end lies (x, y) from its start."""
    half = hypot(x, y) / 2
    if half == 0 or abs(radius) < half - ARC_TOLERANCE_MM:
        raise Alarm(f"no arc of radius {radius:g} reaches its end")
    height = sqrt(max(0.0, radius * radius - half * half)) / (2 * half)
    side = -height if clockwise == (radius > 0) else height
    return x / 2 - y * side, y / 2 + x * side
