"""A session and a simulated controller on one clock, at wire speed."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any, TypeVar

from firmware_protocol.grbl.session import GrblSession
from firmware_protocol.grbl.simulator.simulator import GrblSimulator
from firmware_protocol.ink import PenRule, Polyline
from firmware_protocol.session import Ended, Event, Ready
from tests.firmware_protocol.grbl.driver import Line

LIFT = ("G90 G21", "G0 Z5")
FAST = {1: 255, 10: 3, 110: 3000, 111: 3000, 112: 3000, 120: 200, 121: 200, 122: 200}
TOUCHES_MM = 0.05

E = TypeVar("E", bound=Event)


class Pair:
    """Both, and what was sent and told so far."""

    def __init__(self, sim: GrblSimulator, **options: Any) -> None:
        self.sim, self.now, self.events = sim, 0.0, list[Event]()
        sim.open(0.0)
        self.session = GrblSession(now=0.0, **({"lift": LIFT} | options))
        self.sent = b""
        self.told_at: list[tuple[float, Event]] = []

    def ready(self) -> Pair:
        """Let time pass until a job is taken, then forget what was told."""
        self.until(Ready)
        self.events.clear()
        return self

    def until(self, kind: type[E], *, within_s: float = 300.0) -> E:
        """Let time pass until an event of that kind is told, and return it."""
        first, limit_s = len(self.events), self.now + within_s
        while self.now < limit_s:
            for event in self.events[first:]:
                if isinstance(event, kind):
                    return event
            first = len(self.events)
            self.turn(limit_s)
        raise AssertionError(f"no {kind.__name__} within {within_s:g} s: {self.events[-5:]}")

    def wait(self, seconds: float) -> None:
        """Let time pass."""
        limit_s = self.now + seconds
        while self.now < limit_s:
            self.turn(limit_s)

    def wait_for(self, what: Callable[[], bool], *, within_s: float = 120.0) -> None:
        """Let time pass until something is so."""
        limit_s = self.now + within_s
        while not what():
            assert self.now < limit_s, "it has not come"
            self.turn(min(limit_s, self.now + 0.05))

    def turn(self, limit_s: float) -> None:
        """One turn of the loop that carries bytes and time."""
        if self.sim.unplugged:
            self._tell(self.session.unplugged(self.now))
            return
        data = self.session.data_to_send(self.now)
        self.sent += data
        self.sim.receive(data, self.now)
        times = [at for at in (self.sim.next_time(), self.session.deadline(), limit_s) if at is not None]
        self.now = max(self.now, min(times))
        self._tell(self.session.receive(self.sim.advance(self.now), self.now))
        self._tell(self.session.expire(self.now))

    def draw(self, lines: Sequence[Line]) -> Ended:
        """A whole job on a controller that is ready."""
        self.session.start(lines, self.now)
        return self.until(Ended)

    @property
    def pen_up(self) -> bool:
        return self.sim.position_mm[2] > 0

    def _tell(self, events: list[Event]) -> None:
        self.events += events
        self.told_at += [(self.now, event) for event in events]


def plotter(**options: Any) -> GrblSimulator:
    """A brisk machine whose pen hangs on Z."""
    return GrblSimulator(**({"settings": FAST, "pen": PenRule()} | options))


def stroke_lines(strokes: Sequence[Sequence[tuple[float, float]]], *, feed: float = 1500) -> list[Line]:
    """A program as linedrawd writes it for a pen on Z."""
    lines = [Line("G21 G90"), Line("G0 Z5")]
    for number, points in enumerate(strokes):
        (x, y), *rest = points
        lines += [Line(f"G0 X{x:.3f} Y{y:.3f}", number), Line("G1 Z0 F600", number)]
        lines += [
            Line(f"{'' if index else 'G1 '}X{x:.3f} Y{y:.3f}{'' if index else f' F{feed:g}'}", number)
            for index, (x, y) in enumerate(rest)
        ]
        lines.append(Line("G0 Z5", number))
    return [*lines, Line("G0 X0 Y0")]


def missing_mm(wanted: Sequence[Sequence[tuple[float, float]]], ink: Sequence[Polyline]) -> float:
    """The farthest that a point of the wanted polylines, every 0.05 mm, lies from the ink."""
    segments = [(a, b) for line in ink for a, b in ([*pairwise(line)] or [(line[0], line[0])])]
    points = [point for line in wanted for point in _every(line, 0.05)]
    return max((min((_off(point, a, b) for a, b in segments), default=math.inf) for point in points), default=0.0)


def _every(line: Sequence[tuple[float, float]], step_mm: float) -> list[tuple[float, float]]:
    points = [*line]
    for (ax, ay), (bx, by) in pairwise(line):
        count = int(math.dist((ax, ay), (bx, by)) / step_mm)
        points += [(ax + (bx - ax) * n / count, ay + (by - ay) * n / count) for n in range(1, count)]
    return points


def _off(point: tuple[float, float], a: tuple[float, float], b: tuple[float, float]) -> float:
    along, square = (b[0] - a[0], b[1] - a[1]), math.dist(a, b) ** 2
    dot = along[0] * (point[0] - a[0]) + along[1] * (point[1] - a[1])
    part = min(1.0, max(0.0, dot / square)) if square else 0.0
    return math.dist(point, (a[0] + along[0] * part, a[1] + along[1] * part))
