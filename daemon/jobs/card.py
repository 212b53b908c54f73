"""The test card, drawn by a machine: not a job, for a person stands beside it and watches."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from daemon.config import DobotMachine, GrblMachine, Machine, Sheet, ZPenSettings
from daemon.errors import MachineFault
from daemon.jobs.correction import told
from daemon.jobs.devices import program_of, seconds_of
from daemon.jobs.open_machine import InkMm, OpenMachine
from daemon.jobs.sheet import box_origin_mm, reach_low_mm, reach_mm
from daemon.setup.card import Card, card_in, drawing_of, gauge_mm
from daemon.shapes import Points, Program, Stroke, Toolpath
from daemon.toolpath.place import Layout, place, placement
from daemon.toolpath.reach import check_reach
from firmware_protocol.session import Verdict

_NAME = "000001-card"
_STEPS = (3, 2, 1, 0, -1, -2, -3)
"""Of the pen's height, from the highest on: a pen that is too low is only met at the end."""
STEP_MM, STEP_OF_SERVO = 0.1, 0.05
"""By how much one stroke of the gauge is higher than the one below it; of a servo, in parts of its way."""


def card_programs(sheet: Sheet, machine: Machine, *, corrected: bool = False) -> list[Program]:
    """The card in the middle of the box, in true size, as the machine draws it by itself; then its pen gauge.

    corrected: by the errors that the settings of the machine state. A machine that takes whole programs only gets no
    gauge, which is a program for each height. Raises SettingsError without room for a card, OutOfReach.
    """
    card = card_in(sheet.box_mm)
    machine = _not_homed_each_time(machine)
    whole = _toolpath(card, card.strokes_mm, sheet, machine)
    programs = [program_of(_as_told(whole, sheet, machine, corrected=corrected), machine, _NAME)]
    for step, line in zip(_STEPS, reversed(gauge_mm(card, len(_STEPS))), strict=True):
        other = _with_pen_raised(machine, step)
        if other is not None:
            path = _toolpath(card, [line], sheet, machine)
            programs.append(program_of(_as_told(path, sheet, machine, corrected=corrected), other, _NAME))
    return programs


def card_seconds(programs: Sequence[Program], machine: Machine) -> float:
    """How long it will take, about."""
    return sum(seconds_of(program, machine) for program in programs)


def draw_card(programs: Sequence[Program], machine: OpenMachine) -> InkMm | None:
    """One program after the other, on a machine whose port is open. Returns the ink of a simulated one.

    Raises NoMachine and MachineFault.
    """
    machine.connect()
    for program in programs:
        ended = machine.draw(program)
        if ended.verdict is not Verdict.FINISHED:
            raise MachineFault(ended.why)
    return machine.take_ink()


def _toolpath(card: Card, lines: Sequence[Points], sheet: Sheet, machine: Machine) -> Toolpath:
    drawing = drawing_of(card, lines)
    layout = Layout(sheet.box_mm, box_origin_mm(sheet, machine), true_size=True)
    from_px = placement(drawing.width_px, drawing.height_px, layout, px_per_mm=drawing.px_per_mm)
    strokes = tuple(Stroke(place(stroke.points, from_px)) for stroke in drawing.strokes)
    return Toolpath(strokes, from_px, machine.park_mm, machine.park_mm)


def _as_told(path: Toolpath, sheet: Sheet, machine: Machine, *, corrected: bool) -> Toolpath:
    low_mm = reach_low_mm(sheet, machine)
    check_reach(path.strokes, reach_mm=reach_mm(machine), reach_low_mm=low_mm, park_mm=machine.park_mm)
    return told(path, sheet, machine) if corrected else path


def _not_homed_each_time(machine: Machine) -> Machine:
    return machine.model_copy(update={"home": "start"}) if machine.home == "job" else machine


def _with_pen_raised(machine: Machine, steps: int) -> Machine | None:
    """The machine with another height of its lowered pen; None for one that takes whole programs only."""
    if not isinstance(machine, GrblMachine | DobotMachine):
        return None
    pen = machine.pen
    if isinstance(pen, ZPenSettings):
        up = np.sign(pen.up_mm - pen.down_mm)
        return machine.model_copy(
            update={"pen": pen.model_copy(update={"down_mm": round(pen.down_mm + up * steps * STEP_MM, 3)})}
        )
    raised = pen.down_s + (pen.up_s - pen.down_s) * steps * STEP_OF_SERVO
    return machine.model_copy(update={"pen": pen.model_copy(update={"down_s": max(0.0, round(raised, 1))})})


def gauge_words(machine: Machine, tell: Callable[[str], None]) -> None:
    """What the gauge shows a person."""
    if not isinstance(machine, GrblMachine | DobotMachine):
        return
    pen = machine.pen
    if isinstance(pen, ZPenSettings):
        tell(
            f"pen gauge: the long stroke is drawn at down_mm = {pen.down_mm:g}, each one above it {STEP_MM:g} mm "
            "higher and each one below it so much lower; the highest one that is drawn in full is the height to set"
        )
        return
    step = abs(pen.up_s - pen.down_s) * STEP_OF_SERVO
    tell(
        f"pen gauge: the long stroke is drawn at down_s = {pen.down_s:g}, each one above it {step:g} nearer to up_s; "
        "the highest one that is drawn in full is what to set"
    )
