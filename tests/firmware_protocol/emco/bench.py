"""A session and a simulated control on one clock, and a program for them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from firmware_protocol.emco.blocks import rapid, straight
from firmware_protocol.emco.dialects import DIALECTS, DialectName
from firmware_protocol.emco.session import BlockSession, Control, XonXoffSession
from firmware_protocol.emco.simulator.motion import line_times_s
from firmware_protocol.emco.simulator.setup import Setup
from firmware_protocol.emco.simulator.simulator import EmcoSimulator
from firmware_protocol.session import Ended, Event

STROKES = 6
NAMES: dict[DialectName, str] = {"siemens": "LD_TEST", "fanuc": "O0001"}


@dataclass(frozen=True, slots=True)
class Line:
    """One line of a job."""

    text: str
    stroke: int | None = None


def end_lines(dialect: DialectName) -> tuple[str, ...]:
    """Lift, and end the program."""
    return ("G90", rapid(z=5), "M5", "M9", "M30", *DIALECTS[dialect].tail)


def program(dialect: DialectName = "siemens", *, strokes: int = STROKES, parts: int = 8) -> list[Line]:
    """Vertical lines of 10 mm in `parts` blocks each, 2 mm apart."""
    spoken = DIALECTS[dialect]
    lines = [*map(Line, spoken.head(NAMES[dialect])), Line(f"G90 G17 {spoken.metric} G94 G64"), Line(rapid(z=5))]
    for stroke in range(strokes):
        lines += [
            Line(rapid(x=2 * stroke, y=0), stroke),
            Line(straight(z=0, feed_mm_min=600), stroke),
            *(
                Line(straight(x=2 * stroke, y=10 * part / parts, feed_mm_min=600), stroke)
                for part in range(1, parts + 1)
            ),
            Line(rapid(z=5), stroke),
        ]
    return [*lines, Line(rapid(x=0, y=0)), *map(Line, end_lines(dialect)[2:])]


class Bench:
    """One clock for both."""

    def __init__(self, simulator: EmcoSimulator, session: Callable[[], Any]) -> None:
        self.sim, self.now, self.events = simulator, 0.0, list[Event]()
        self.sim.open(0.0)
        self.session = session()
        self.sent = b""

    def step(self, limit_s: float) -> None:
        data = self.session.data_to_send(self.now)
        self.sent += data
        self.sim.receive(data, self.now)
        times = [at for at in (self.sim.next_time(), self.session.deadline(), limit_s) if at is not None]
        self.now = max(self.now, min(times))
        heard = self.sim.advance(self.now)
        if self.sim.unplugged:
            self.events += self.session.unplugged(self.now)
        else:
            self.events += [*self.session.receive(heard, self.now), *self.session.expire(self.now)]

    def draw(self, lines: Sequence[Line], *, stop_at: float | None = None, within_s: float = 4000.0) -> Ended:
        """Draw a job to its end; stop_at: seconds behind its start."""
        begun, limit_s = self.now, self.now + within_s
        self.session.start(lines, self.now)
        while not self.ends:
            if stop_at is not None and self.now >= begun + stop_at:
                self.session.stop(self.now)
                stop_at = None
            self.step(limit_s if stop_at is None else begun + stop_at)
            assert self.now < limit_s, "the job does not end"
        (end,) = self.ends
        return end

    @property
    def ends(self) -> list[Ended]:
        return [event for event in self.events if isinstance(event, Ended)]

    @property
    def whole(self) -> int:
        """The first so many strokes are whole on the sheet."""
        full = {round(line[0][0]) for line in self.sim.ink if abs(line[-1][1] - line[0][1]) > 9.99}
        return next(stroke for stroke in range(1000) if 2 * stroke not in full)

    @property
    def touched(self) -> int:
        """No stroke from this number on has any ink."""
        return max((round(line[0][0]) // 2 + 1 for line in self.sim.ink), default=0)


def on_xonxoff(simulator: EmcoSimulator, *, control: Control | None = None, **options: Any) -> Bench:
    """A plain serial line; the session knows its format."""
    setup = simulator.setup
    usual = {"bytes_per_s": setup.line.bytes_per_s(setup.baud), "times": line_times_s}
    usual |= {"seven_bit": setup.software_parity, "control": control or Control()}
    return Bench(simulator, lambda: XonXoffSession(now=0.0, **(usual | options)))


def on_blocks(simulator: EmcoSimulator, *, control: Control | None = None, **options: Any) -> Bench:
    """Acknowledged blocks."""
    usual = {"times": line_times_s, "ack": simulator.setup.ack, "nak": simulator.setup.nak}
    usual |= {"control": control or Control()}
    return Bench(simulator, lambda: BlockSession(now=0.0, **(usual | options)))


def knowing(setup: Setup, dialect: DialectName = "siemens") -> Control:
    """An owner who knows what the control holds."""
    most_bytes = setup.buffer_bytes + 81 * (setup.ahead + 1)
    return Control(on_stop=end_lines(dialect), holds_bytes=most_bytes, holds_blocks=setup.ahead + 1)
