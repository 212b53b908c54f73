"""A session and a simulated arm on one clock, moved as the loop moves them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from firmware_protocol.dobot.session import DobotSession
from firmware_protocol.dobot.simulator.simulator import DobotSimulator
from firmware_protocol.dobot.states import State
from firmware_protocol.ink import PenRule
from firmware_protocol.session import Ended, Event, Status

UP_MM, DOWN_MM = 10.0, -5.0
LATEST = 20
"""More events than one turn tells."""
T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Line:
    """One line of a job."""

    text: str
    stroke: int | None = None


def stroke(number: int, *points: tuple[float, float], mm_s: float = 50.0) -> list[Line]:
    """One stroke, in the arm's coordinates: above, down, along, up."""
    (x, y), (end_x, end_y) = points[0], points[-1]
    texts = [f"PTP 2 {x:.3f} {y:.3f} {UP_MM:.3f} 0.000", f"PTP 2 {x:.3f} {y:.3f} {DOWN_MM:.3f} 0.000"]
    texts += [f"CP 1 {x:.3f} {y:.3f} {DOWN_MM:.3f} {mm_s:.3f}" for x, y in points[1:]]
    return [Line(text, number) for text in (*texts, f"PTP 2 {end_x:.3f} {end_y:.3f} {UP_MM:.3f} 0.000")]


def strokes(count: int, *, segments: int = 10, step_mm: float = 4.0, mm_s: float = 50.0) -> list[Line]:
    """So many parallel lines, and a way to park."""
    lines: list[Line] = []
    for number in range(count):
        y = -20.0 + 5.0 * number
        lines += stroke(number, *((200.0 + step_mm * k, y) for k in range(segments + 1)), mm_s=mm_s)
    return [*lines, Line(f"PTP 2 220.000 0.000 {UP_MM:.3f} 0.000")]


class Bench:
    """`arm`: options of the simulator; the others are the session's. late_s: how much later than due the host acts."""

    def __init__(self, *, arm: dict[str, Any] | None = None, late_s: float = 0.0, **options: Any) -> None:
        self.sim = DobotSimulator(**({"pen": PenRule(down_at_mm=0.0)} | (arm or {})))
        self.now = 0.0
        self.late_s = late_s
        self.sim.open(0.0)
        self.session = DobotSession(**({"now": 0.0, "home": False, "up_mm": UP_MM} | options))
        self.events: list[Event] = []
        self.times: list[tuple[float, Event]] = []
        self.sent: list[tuple[float, bytes]] = []

    def until(self, done: Callable[[], bool], *, within_s: float = 600.0) -> None:
        """Let the time pass until `done`, or an assertion that it never will be."""
        end = self.now + within_s
        while not done():
            assert self.now < end, f"still {self.session.state.value} after {within_s} s"
            self.turn(end)

    def wait(self, seconds: float) -> None:
        """Let the time pass."""
        end = self.now + seconds
        while self.now < end:
            self.turn(end)

    def ready(self) -> Bench:
        """The arm has introduced itself."""
        self.until(lambda: self.session.state in {State.READY, State.LOST})
        return self

    def start(self, lines: Sequence[Line]) -> Bench:
        self.session.start(lines, self.now)
        return self

    def draw(self, lines: Sequence[Line]) -> Ended:
        """A job from its start to its end."""
        self.ready().start(lines)
        self.until(lambda: self.over)
        return self.ended

    @property
    def over(self) -> bool:
        return any(isinstance(event, Ended) for event in self.events[-LATEST:])

    @property
    def ended(self) -> Ended:
        """The one end of the job."""
        (end,) = [event for event in self.events if isinstance(event, Ended)]
        return end

    @property
    def told(self) -> list[Event]:
        """All events but the status reports."""
        return [event for event in self.events if not isinstance(event, Status)]

    def all_of(self, kind: type[T]) -> list[T]:
        return [event for event in self.events if isinstance(event, kind)]

    def time_of(self, kind: type[Event]) -> float:
        """When the first such event was told."""
        return next(at for at, event in self.times if isinstance(event, kind))

    def drain(self) -> None:
        """The host is gone; the arm does what it still does."""
        while (event := self.sim.next_time()) is not None:
            self.sim.advance(event)

    def turn(self, end: float) -> None:
        """To the next moment at which anything happens, `end` at the latest."""
        self.act()
        times = [at for at in (self.sim.next_time(), self.session.deadline()) if at is not None]
        self.now = min(end, max(self.now, min(times, default=end)) + self.late_s)
        if self.sim.unplugged:
            self._tell(self.session.unplugged(self.now))
            self.now = end
            return
        self._tell(self.session.receive(self.sim.advance(self.now), self.now))
        self._tell(self.session.expire(self.now))
        self.act()

    def act(self) -> None:
        """Say what the session has to say."""
        data = self.session.data_to_send(self.now)
        if data and not self.sim.unplugged:
            self.sent.append((self.now, data))
            self.sim.receive(data, self.now)

    def _tell(self, events: list[Event]) -> None:
        self.events += events
        self.times += [(self.now, event) for event in events]
