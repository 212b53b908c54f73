"""G-code lines become actions: the parser of GRBL 1.1h (`gcode.c`, step 4) and its modal state."""

from __future__ import annotations

from collections.abc import Iterator

from firmware_protocol.gcode import GcodeError
from firmware_protocol.grbl.simulator import arcs
from firmware_protocol.grbl.simulator import block as groups
from firmware_protocol.grbl.simulator.actions import (
    Action,
    Coolant,
    Dwell,
    Move,
    Pause,
    Probe,
    ProgramEnd,
    Remember,
    Spindle,
)
from firmware_protocol.grbl.simulator.block import Block, read_block
from firmware_protocol.grbl.simulator.checks import ARCS, LineCheck, Plan, vector
from firmware_protocol.grbl.simulator.lookahead import Vector
from firmware_protocol.grbl.simulator.modal import HERE, Memory, Modal

JOG_WORD = 16


class Interpreter:
    """Holds the modal state; `run` takes a cleaned line and says what is to be done. A refused line changes nothing."""

    def __init__(self, memory: Memory) -> None:
        self.memory = memory
        self.modal = Modal()
        self.offsets_changed = False
        """Set when the next status report has to carry WCO."""

    def reset(self, position_mm: Vector) -> None:
        """The state after any reset: G54 of the chip's memory, everything else at its default."""
        self.modal = Modal(position_mm=position_mm, work_mm=self.memory.places[0])

    def run(self, line: str) -> Iterator[Action]:
        """The actions of a line. Raises GcodeError at once, before the first action, when GRBL refuses it."""
        block = read_block(line)
        plan = LineCheck(self.memory, self.modal).check(block)
        return iter(self._perform(block, plan))

    def jog(self, line: str) -> Move:
        """What `$J=line` moves; the modal state stays, only the position goes on. Raises GcodeError."""
        block = read_block(line, jog=True)
        plan = LineCheck(self.memory, self.modal).check(block)
        if set(block.groups) - {groups.DISTANCE, groups.UNITS, groups.NON_MODAL}:
            raise GcodeError(JOG_WORD)
        if block.groups.get(groups.NON_MODAL, 530) != 530:
            raise GcodeError(JOG_WORD)
        return Move(vector(plan.target), plan.feed, jog=True)

    def _perform(self, block: Block, plan: Plan) -> Iterator[Action]:
        modal = self.modal
        modal.inverse_time, modal.feed = plan.inverse_time, plan.feed
        yield from self._machine_words(block)
        if block.has(groups.NON_MODAL, 40):
            yield Dwell(block.words["P"])
        modal.plane = block.groups.get(groups.PLANE, modal.plane)
        modal.inches = plan.unit != 1.0
        self._offsets(block, plan)
        modal.relative = block.groups.get(groups.DISTANCE, 910 if modal.relative else 900) == 910
        yield from self._non_modal(block, plan)
        yield from self._motion(plan)
        yield from self._flow(block)

    def _machine_words(self, block: Block) -> Iterator[Action]:
        modal, speed = self.modal, block.words.get("S", self.modal.speed)
        if speed != modal.speed and modal.spindle != 5:
            yield Spindle(modal.spindle, speed)
        modal.speed = speed
        modal.tool = int(block.words.get("T", 0))
        spindle = block.groups.get(groups.SPINDLE, modal.spindle)
        if spindle != modal.spindle:
            yield Spindle(spindle, speed)
            modal.spindle = spindle
        flood = block.groups.get(groups.COOLANT, 8 if modal.flood else 9) == 8
        if flood != modal.flood:
            yield Coolant(flood)
            modal.flood = flood

    def _offsets(self, block: Block, plan: Plan) -> None:
        modal = self.modal
        if block.axes_for == groups.LENGTH:
            length = plan.target[2] if block.has(groups.LENGTH, 431) else 0.0
            self.offsets_changed |= length != modal.tool_length_mm
            modal.tool_length_mm = length
        if plan.work != modal.work:
            modal.work, modal.work_mm = plan.work, plan.work_mm
            self.offsets_changed = True

    def _non_modal(self, block: Block, plan: Plan) -> Iterator[Action]:
        modal, code = self.modal, block.groups.get(groups.NON_MODAL)
        if plan.remembered is not None:
            index, place = plan.remembered
            yield Remember(self.memory.place(index, place))
            if index == modal.work:
                modal.work_mm = place
                self.offsets_changed = True
        elif plan.second_mm is not None:
            if plan.axes_for is not None:
                yield Move(vector(plan.target), 0.0, rapid=True)
            yield Move(plan.second_mm, 0.0, rapid=True)
            modal.position_mm = plan.second_mm
        elif code in (920, 921):
            modal.shift_mm = vector(plan.target) if code == 920 else HERE
            self.offsets_changed = True

    def _motion(self, plan: Plan) -> Iterator[Action]:
        modal = self.modal
        modal.motion = plan.motion
        if plan.axes_for != groups.MOTION or plan.motion == 800:
            return
        move = Move(vector(plan.target), plan.feed, rapid=plan.motion == 0, inverse_time=plan.inverse_time)
        start, modal.position_mm = modal.position_mm, move.target_mm
        if plan.motion in ARCS:
            tolerance, clockwise = self.memory.settings[12], plan.motion == 20
            yield from arcs.chords(
                move, start, plan.centre, plane=modal.plane, clockwise=clockwise, tolerance_mm=tolerance
            )
        elif plan.motion > 380:
            yield Probe(move, away=plan.motion >= 384, alarm=plan.motion in (382, 384))
        else:
            yield move

    def _flow(self, block: Block) -> Iterator[Action]:
        flow = block.groups.get(groups.FLOW)
        if flow == 0:
            yield Pause()
        elif flow in (2, 30):
            modal = self.modal
            modal.motion, modal.plane, modal.relative, modal.inverse_time = 10, 170, False, False
            modal.work, modal.work_mm, modal.spindle, modal.flood = 0, self.memory.places[0], 5, False
            yield ProgramEnd()
