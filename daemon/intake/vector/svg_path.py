"""The shapes of an SVG file as curves in its own units (SVG 1.1, chapters 8 and 9)."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np

from daemon.intake.vector.common import MOST_POINTS
from daemon.shapes import Points

Map: TypeAlias = Callable[[complex], complex]

_NUMBER = re.compile(r"[\s,]*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)")
_FLAG = re.compile(r"[\s,]*([01])")
_COMMAND = re.compile(r"[\s,]*([MmLlHhVvCcSsQqTtAaZz])")
_TAKES = {"M": 2, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2, "A": 7, "Z": 0}
_ARC_RAD = math.pi / 4
"""Cubic curves of this angle leave their arc by a hundred-thousandth of its radius at most."""


@dataclass(slots=True)
class Run:
    """One subpath: where it starts, and the control points of its pieces, each (2, 2), (3, 2) or (4, 2)."""

    start: tuple[float, float]
    pieces: list[Points] = field(default_factory=list)
    closed: bool = False

    def to(self, *points: complex) -> None:
        last = self.pieces[-1][-1] if self.pieces else np.array(self.start)
        self.pieces.append(np.array([last, *((p.real, p.imag) for p in points)]))

    def close(self) -> None:
        if self.pieces and not np.array_equal(self.pieces[-1][-1], self.start):
            self.to(complex(*self.start))
        self.closed = True


def runs_of_path(text: str) -> list[Run]:
    """The subpaths of the attribute `d`, up to its first mistake, as every viewer draws it.

    Raises ValueError for more than MOST_POINTS pieces.
    """
    return _Path(text).runs


def runs_of_shape(tag: str, attributes: Mapping[str, float], points: str) -> list[Run]:
    """The outline of line, rect, circle, ellipse, polyline or polygon; none where a size is not positive.

    attributes: its numbers by name, 0 where they are missing. points: those of polyline and polygon.
    """
    at = attributes.__getitem__
    if tag == "line":
        return runs_of_path(f"M{at('x1')!r} {at('y1')!r}L{at('x2')!r} {at('y2')!r}")
    if tag in ("polyline", "polygon"):
        return runs_of_path(f"M{points}{'Z' if tag == 'polygon' else ''}")
    if tag == "rect":
        return _rectangle(at("x"), at("y"), at("width"), at("height"), (at("rx"), at("ry")))
    rx, ry = (at("r"), at("r")) if tag == "circle" else (at("rx"), at("ry"))
    if min(rx, ry) <= 0:
        return []
    x, y = at("cx"), at("cy")
    half = f"A{rx!r} {ry!r} 0 1 1 "
    return runs_of_path(f"M{x + rx!r} {y!r}{half}{x - rx!r} {y!r}{half}{x + rx!r} {y!r}Z")


def _rectangle(x: float, y: float, width: float, height: float, rounded: tuple[float, float]) -> list[Run]:
    if min(width, height) <= 0:
        return []
    rx, ry = (value if value > 0 else max(rounded) for value in rounded)
    rx, ry = min(rx, width / 2), min(ry, height / 2)
    if min(rx, ry) <= 0:
        return runs_of_path(f"M{x!r} {y!r}h{width!r}v{height!r}h{-width!r}Z")
    arc, across, down = f"a{rx!r} {ry!r} 0 0 1 ", width - 2 * rx, height - 2 * ry
    return runs_of_path(
        f"M{x + rx!r} {y!r}h{across!r}{arc}{rx!r} {ry!r}v{down!r}{arc}{-rx!r} {ry!r}"
        f"h{-across!r}{arc}{-rx!r} {-ry!r}v{-down!r}{arc}{rx!r} {-ry!r}Z"
    )


class _Path:
    def __init__(self, text: str) -> None:
        self.runs: list[Run] = []
        self._text, self._at = text, 0
        self._pen, self._count = 0j, 0
        self._reflected: tuple[str, complex] = ("", 0j)
        """The kind of the last curve and its last control point."""
        self._read()

    def _read(self) -> None:
        command = ""
        while True:
            found = _COMMAND.match(self._text, self._at)
            if found:
                command, self._at = found[1], found.end()
            elif command in ("", "Z", "z"):
                return
            if not self.runs and command not in "Mm":
                return
            numbers = self._numbers(command.upper())
            if numbers is None:
                return
            self._draw(command, numbers)
            command = {"M": "L", "m": "l"}.get(command, command)

    def _numbers(self, kind: str) -> list[float] | None:
        values = []
        for index in range(_TAKES[kind]):
            pattern = _FLAG if kind == "A" and index in (3, 4) else _NUMBER
            found = pattern.match(self._text, self._at)
            if found is None:
                return None
            values.append(float(found[1]))
            self._at = found.end()
        return values

    def _draw(self, command: str, numbers: list[float]) -> None:
        kind = command.upper()
        self._count += 1
        if self._count > MOST_POINTS:
            raise ValueError(f"holds a path of more than {MOST_POINTS} pieces: simplify it")
        origin = self._pen if command.islower() else 0j
        points = [origin + complex(x, y) for x, y in zip(numbers[::2], numbers[1::2], strict=False)]
        reflected, self._reflected = self._reflected, ("", 0j)
        match kind:
            case "M":
                self._pen = points[0]
                self.runs.append(Run((self._pen.real, self._pen.imag)))
            case "Z":
                self.runs[-1].close()
                self._pen = complex(*self.runs[-1].start)
            case "H":
                self._to(complex(origin.real + numbers[0], self._pen.imag))
            case "V":
                self._to(complex(self._pen.real, origin.imag + numbers[0]))
            case "L":
                self._to(points[0])
            case "A":
                end = origin + complex(numbers[5], numbers[6])
                self._arc((numbers[0], numbers[1]), numbers[2], numbers[3] != 0, numbers[4] != 0, end)
            case _:
                self._curve(kind, points, reflected)

    def _curve(self, kind: str, points: list[complex], reflected: tuple[str, complex]) -> None:
        if kind in "ST":
            family = {"S": "C", "T": "Q"}[kind]
            mirrored = 2 * self._pen - reflected[1] if reflected[0] == family else self._pen
            points, kind = [mirrored, *points], family
        self._to(*points)
        self._reflected = (kind, points[-2])

    def _to(self, *points: complex) -> None:
        if self.runs[-1].closed:
            self.runs.append(Run((self._pen.real, self._pen.imag)))
        self.runs[-1].to(*points)
        self._pen = points[-1]

    def _arc(self, radii: tuple[float, float], turned: float, large: bool, sweep: bool, end: complex) -> None:
        """SVG 1.1, appendix F.6: the centre from the ends; radii that are too small grow."""
        rx, ry = abs(radii[0]), abs(radii[1])
        if end == self._pen:
            return
        if min(rx, ry) == 0:
            self._to(end)
            return
        turn = complex(math.cos(math.radians(turned)), math.sin(math.radians(turned)))
        half = (self._pen - end) / 2 / turn
        u = complex(half.real / rx, half.imag / ry)
        grown = max(1.0, abs(u))
        rx, ry, u = rx * grown, ry * grown, u / grown
        aside = math.sqrt(max(0.0, 1 / abs(u) ** 2 - 1)) * (1 if large != sweep else -1)
        centre = complex(u.imag, -u.real) * aside
        first, last = u - centre, -u - centre
        angle = math.remainder(math.atan2(last.imag, last.real) - math.atan2(first.imag, first.real), math.tau)
        if sweep != (angle > 0):
            angle += math.tau if sweep else -math.tau
        middle = (self._pen + end) / 2 + complex(centre.real * rx, centre.imag * ry) * turn
        count = max(1, math.ceil(abs(angle) / _ARC_RAD))
        self._arc_pieces(first, angle / count, count, lambda p: middle + complex(p.real * rx, p.imag * ry) * turn, end)

    def _arc_pieces(self, point: complex, step: float, count: int, out: Map, end: complex) -> None:
        reach = 4 / 3 * math.tan(step / 4)
        spin = complex(math.cos(step), math.sin(step))
        for index in range(count):
            following = point * spin
            last = end if index == count - 1 else out(following)
            self._to(out(point + 1j * point * reach), out(following - 1j * following * reach), last)
            point = following
