"""When each line of a program will have been executed, as GRBL 1.1 plans its motion."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import ceil

from firmware_protocol.gcode import clean_line
from firmware_protocol.grbl.simulator.actions import Action, Dwell, Move, Probe
from firmware_protocol.grbl.simulator.interpreter import Interpreter
from firmware_protocol.grbl.simulator.lookahead import Block, Lookahead, Vector
from firmware_protocol.grbl.simulator.modal import Memory
from firmware_protocol.grbl.simulator.settings import Settings
from firmware_protocol.grbl.simulator.stepper import Stepper

DWELL_STEP_S = 0.05
"""GRBL waits in steps of this length: G4 P0.01 takes one."""


@dataclass(frozen=True, slots=True)
class LineEnd:
    """When a line has been executed, counted from the start of the program, and where the machine is then."""

    time_s: float
    position_mm: Vector


def line_times_s(lines: Sequence[str], settings: Mapping[int, float] | None = None) -> list[float]:
    """The time in s at which each line of a program has been executed; see `line_ends`."""
    return [end.time_s for end in line_ends(lines, settings)]


def line_ends(lines: Iterable[str], settings: Mapping[int, float] | None = None) -> list[LineEnd]:
    """When and where each line of a program ends, on a machine with these `$` settings that begins at rest at 0, 0, 0.

    Acceleration, junctions, the planner's 15 blocks and dwells are included; the wire and the chip's speed are not:
    more than about 400 lines a second take longer than this. `M0` and probing take no time.
    Raises GcodeError for a line that GRBL refuses and ValueError for an unknown setting.
    """
    forecast = _Forecast(Settings(settings))
    for line in lines:
        forecast.execute(line)
    return forecast.ends()


def dwell_s(seconds: float) -> float:
    """How long GRBL takes for `G4 P seconds`."""
    return ceil(round(seconds / DWELL_STEP_S, 6)) * DWELL_STEP_S


class _Forecast:
    """A controller without a wire: lines go into the planner as soon as there is a place."""

    def __init__(self, settings: Settings) -> None:
        self._lookahead = Lookahead(settings)
        self._stepper = Stepper(self._lookahead, self._finished, lambda block, done: None)
        self._interpreter = Interpreter(Memory(settings))
        self._now = 0.0
        self._ends: list[LineEnd | None] = []

    def execute(self, line: str) -> None:
        self._ends.append(None)
        moved = False
        for action in self._interpreter.run(clean_line(line.encode("latin-1"))):
            moved |= self._perform(action)
        if not moved and not self._lookahead.blocks:
            self._ends[-1] = LineEnd(self._now, self._stepper.position_mm)

    def ends(self) -> list[LineEnd]:
        """A line without motion of its own ends with the one before it."""
        self._rest()
        last, whole = LineEnd(0.0, (0.0, 0.0, 0.0)), []
        for end in self._ends:
            last = end or last
            whole.append(last)
        return whole

    def _perform(self, action: Action) -> bool:
        if isinstance(action, Move):
            return self._move(action)
        moved = isinstance(action, Probe) and self._move(action.move)
        self._rest()
        if isinstance(action, Dwell):
            self._now += dwell_s(action.seconds)
        return moved

    def _move(self, move: Move) -> bool:
        while self._lookahead.full:
            self._stepper.start(self._now)
            self._now = max(self._now, self._stepper.next_s())
            self._stepper.advance(self._now)
        planned = self._lookahead.add(move, len(self._ends) - 1)
        self._stepper.planned()
        return planned

    def _rest(self) -> None:
        self._stepper.start(self._now)
        while self._stepper.moving:
            self._now = max(self._now, self._stepper.next_s())
            self._stepper.advance(self._now)

    def _finished(self, time_s: float, block: Block) -> None:
        self._ends[block.tag] = LineEnd(time_s, block.end_mm)
