"""The errors of a G-code line that depend on the modal state, and what the line comes to (GRBL 1.1h, step 3)."""

from __future__ import annotations

from dataclasses import dataclass, field

from firmware_protocol.gcode import GcodeError
from firmware_protocol.grbl.simulator import arcs
from firmware_protocol.grbl.simulator import block as groups
from firmware_protocol.grbl.simulator.block import Block
from firmware_protocol.grbl.simulator.lookahead import Vector
from firmware_protocol.grbl.simulator.modal import G28, G30, MM_PER_INCH, Memory, Modal

NO_FEED = 22
AXES_MISSING = 26
LINE_NUMBER_TOO_BIG = 27
VALUE_MISSING = 28
NO_SUCH_OFFSET = 29
G53_NEEDS_LINE = 30
AXES_AFTER_G80 = 31
NO_AXIS_OF_PLANE = 32
NO_CENTRE = 35
UNUSED_WORD = 36
ONLY_Z = 37

ARCS = (20, 30)
"""G2 and G3 times ten."""


@dataclass(slots=True)
class Plan:
    """What the checks have worked out, before anything is done."""

    motion: int
    feed: float
    target: list[float]
    axes_for: int | None
    unit: float
    work: int
    work_mm: Vector
    offset_mm: Vector
    inverse_time: bool = False
    centre: tuple[float, float] = (0.0, 0.0)
    second_mm: Vector | None = None
    remembered: tuple[int, Vector] | None = None
    spare: set[str] = field(default_factory=set)


class LineCheck:
    """Judges lines against the modal state; changes nothing."""

    def __init__(self, memory: Memory, modal: Modal) -> None:
        self.memory, self.modal = memory, modal

    def check(self, block: Block) -> Plan:
        """Work a line out. Raises GcodeError with the code of GRBL's first complaint."""
        if block.words.get("N", 0) > 10_000_000:
            raise GcodeError(LINE_NUMBER_TOO_BIG)
        plan = self._plan(block)
        plan.inverse_time = self._inverse_time(block)
        plan.feed = self._feed(block, plan)
        if block.has(groups.NON_MODAL, 40):
            if "P" not in block.words:
                raise GcodeError(VALUE_MISSING)
            plan.spare.discard("P")
        if block.has(groups.LENGTH, 431) and block.axes_for == groups.LENGTH and block.axes != [2]:
            raise GcodeError(ONLY_Z)
        self._check_non_modal(block, plan)
        self._check_motion(block, plan)
        if plan.spare:
            raise GcodeError(UNUSED_WORD)
        return plan

    def _plan(self, block: Block) -> Plan:
        modal = self.modal
        inches = block.has(groups.UNITS, 200) or (modal.inches and groups.UNITS not in block.groups)
        work = block.groups[groups.WORK] // 10 - 54 if groups.WORK in block.groups else modal.work
        work_mm = self.memory.places[work] if work != modal.work else modal.work_mm
        unit = MM_PER_INCH if inches else 1.0
        target = [block.words.get(letter, 0.0) * unit for letter in "XYZ"]
        sx, sy, sz = modal.shift_mm
        offset = (work_mm[0] + sx, work_mm[1] + sy, work_mm[2] + sz + modal.tool_length_mm)
        motion = block.groups.get(groups.MOTION, 10 if block.jog else modal.motion)
        plan = Plan(motion, 0.0, target, block.axes_for, unit, work, work_mm, offset)
        plan.spare = block.spare - ({"F"} if block.jog else {"F", "S", "T"})
        return plan

    def _feed(self, block: Block, plan: Plan) -> float:
        modal, given = self.modal, block.words.get("F")
        if block.jog:
            if given is None:
                raise GcodeError(NO_FEED)
            return given * plan.unit
        if plan.inverse_time:
            if given is None and block.axes_for == groups.MOTION and plan.motion not in (0, 800):
                raise GcodeError(NO_FEED)
            return given or 0.0
        if modal.inverse_time:
            return given or 0.0
        return modal.feed if given is None else given * plan.unit

    def _inverse_time(self, block: Block) -> bool:
        if block.jog:
            return False
        return block.groups.get(groups.FEED_MODE, 930 if self.modal.inverse_time else 940) == 930

    def _check_non_modal(self, block: Block, plan: Plan) -> None:
        code = block.groups.get(groups.NON_MODAL)
        if code == 100:
            self._check_g10(block, plan)
        elif code == 920:
            self._check_g92(block, plan)
        else:
            self._check_target(block, plan)
            if code in (280, 300):
                self._check_return(block, plan, G28 if code == 280 else G30)
            elif code in (281, 301):
                plan.remembered = (G28 if code == 281 else G30, self.modal.position_mm)
            elif code == 530 and plan.motion not in (0, 10):
                raise GcodeError(G53_NEEDS_LINE)

    def _check_g10(self, block: Block, plan: Plan) -> None:
        words = block.words
        if not block.axes:
            raise GcodeError(AXES_MISSING)
        if "P" not in words and "L" not in words:
            raise GcodeError(VALUE_MISSING)
        number, kind = int(words.get("P", 0)), int(words.get("L", 0)) & 0xFF
        if number > 6:
            raise GcodeError(NO_SUCH_OFFSET)
        if kind not in (2, 20) or (kind == 2 and "R" in words):
            raise GcodeError(groups.UNSUPPORTED)
        plan.spare -= {"L", "P"}
        index = number - 1 if number else plan.work
        place = list(self.memory.places[index])
        for axis in block.axes:
            place[axis] = self._shifted(axis, plan.target[axis]) if kind == 20 else plan.target[axis]
        plan.remembered = (index, vector(place))

    def _shifted(self, axis: int, value_mm: float) -> float:
        modal = self.modal
        length = modal.tool_length_mm if axis == 2 else 0.0
        return modal.position_mm[axis] - modal.shift_mm[axis] - length - value_mm

    def _check_g92(self, block: Block, plan: Plan) -> None:
        if not block.axes:
            raise GcodeError(AXES_MISSING)
        modal = self.modal
        for axis in range(3):
            if axis in block.axes:
                length = modal.tool_length_mm if axis == 2 else 0.0
                plan.target[axis] = modal.position_mm[axis] - plan.work_mm[axis] - length - plan.target[axis]
            else:
                plan.target[axis] = modal.shift_mm[axis]

    def _check_target(self, block: Block, plan: Plan) -> None:
        if block.axes_for == groups.LENGTH or not block.axes:
            return
        relative = block.groups.get(groups.DISTANCE, 910 if self.modal.relative else 900) == 910
        machine = block.has(groups.NON_MODAL, 530)
        for axis in range(3):
            if axis not in block.axes:
                plan.target[axis] = self.modal.position_mm[axis]
            elif not machine:
                plan.target[axis] += (self.modal.position_mm if relative else plan.offset_mm)[axis]

    def _check_return(self, block: Block, plan: Plan, index: int) -> None:
        place = list(self.memory.places[index])
        if block.axes:
            for axis in {0, 1, 2} - set(block.axes):
                place[axis] = self.modal.position_mm[axis]
        else:
            plan.axes_for = None
        plan.second_mm = vector(place)

    def _check_motion(self, block: Block, plan: Plan) -> None:
        if plan.motion == 800:
            if block.axes:
                raise GcodeError(AXES_AFTER_G80)
        elif plan.axes_for == groups.MOTION:
            if plan.motion != 0 and plan.feed == 0:
                raise GcodeError(NO_FEED)
            if not block.axes:
                if plan.motion not in (0, 10):
                    raise GcodeError(AXES_MISSING)
                plan.axes_for = None
            elif plan.motion in ARCS:
                self._check_arc(block, plan)
            elif plan.motion > 380 and tuple(plan.target) == self.modal.position_mm:
                raise GcodeError(arcs.END_OFF_CIRCLE)
        if plan.axes_for is not None:
            plan.spare -= set("XYZ")

    def _check_arc(self, block: Block, plan: Plan) -> None:
        first, second, _ = arcs.PLANE_AXES[block.groups.get(groups.PLANE, self.modal.plane)]
        if not {first, second} & set(block.axes):
            raise GcodeError(NO_AXIS_OF_PLANE)
        start, words = self.modal.position_mm, block.words
        x, y = plan.target[first] - start[first], plan.target[second] - start[second]
        if "R" in words:
            plan.spare.discard("R")
            if tuple(plan.target) == start:
                raise GcodeError(arcs.END_OFF_CIRCLE)
            plan.centre = arcs.centre_of_radius(x, y, words["R"] * plan.unit, clockwise=plan.motion == 20)
            return
        letters = "IJK"[first], "IJK"[second]
        if not words.keys() & set(letters):
            raise GcodeError(NO_CENTRE)
        plan.spare -= set("IJK")
        plan.centre = (words.get(letters[0], 0.0) * plan.unit, words.get(letters[1], 0.0) * plan.unit)
        arcs.check_end(x, y, plan.centre)


def vector(values: list[float]) -> Vector:
    """Three numbers as a place."""
    return values[0], values[1], values[2]
