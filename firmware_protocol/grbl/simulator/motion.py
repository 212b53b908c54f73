"""How the simulated controller carries out the actions of a line (`motion_control.c` of GRBL 1.1h)."""

from __future__ import annotations

from math import ceil

from firmware_protocol.grbl.simulator import status
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
from firmware_protocol.grbl.simulator.chip import Chip, Signal, State
from firmware_protocol.grbl.simulator.lookahead import Vector
from firmware_protocol.grbl.simulator.planner import DWELL_STEP_S
from firmware_protocol.grbl.simulator.realtime import Routine, execute_realtime, set_overrides, start_cycle, synchronize

PLAN_S = 0.00032
MOVING_FACTOR = 1.3
"""How much longer everything takes while the step interrupts run."""


def perform(chip: Chip, action: Action) -> Routine:
    """Carry out one action; ends early when a reset has been asked for."""
    if isinstance(action, Move):
        yield from move(chip, action)
    elif chip.state is State.CHECK:
        if isinstance(action, ProgramEnd):
            _end(chip)
        elif isinstance(action, Remember):
            chip.write_memory(action.changed)
    elif isinstance(action, Probe):
        yield from _probe(chip, action)
    else:
        yield from synchronize(chip)
        if not chip.abort:
            yield from _at_rest(chip, action)


def move(chip: Chip, wanted: Move) -> Routine:
    """`mc_line`: into the planner, as soon as there is a place."""
    if chip.settings[20] and not wanted.jog and beyond_travel(chip, wanted.target_mm):
        yield from _soft_limit(chip)
        return
    if chip.state is State.CHECK:
        return
    while True:
        if chip.attention:
            yield from execute_realtime(chip)
        if chip.abort:
            return
        if not chip.lookahead.full:
            break
        start_cycle(chip)
        if not chip.attention:
            yield None
    yield chip.now + slowed(chip, PLAN_S)
    chip.lookahead.add(wanted)
    chip.stepper.planned()


def beyond_travel(chip: Chip, target_mm: Vector) -> bool:
    """Whether a target lies outside the travel, which goes from minus $130 to 0."""
    return any(value > 0 or value < -travel for value, travel in zip(target_mm, chip.settings.axes(130), strict=True))


def slowed(chip: Chip, seconds: float) -> float:
    """How long so much computing takes now."""
    return seconds * MOVING_FACTOR if chip.stepper.moving else seconds


def _at_rest(chip: Chip, action: Action) -> Routine:
    if isinstance(action, Dwell):
        yield from _dwell(chip, action.seconds)
    elif isinstance(action, Spindle):
        chip.set_spindle(action.direction, action.speed)
    elif isinstance(action, Coolant):
        chip.set_coolant(flood=action.flood)
    elif isinstance(action, Remember):
        chip.write_memory(action.changed)
    elif isinstance(action, Pause):
        chip.signals |= Signal.HOLD
        yield from execute_realtime(chip)
    elif isinstance(action, ProgramEnd):
        chip.set_spindle(5, 0.0)
        chip.set_coolant(flood=False)
        chip.reports_to_wco = 0
        _end(chip)


def _end(chip: Chip) -> None:
    set_overrides(chip, 100, 100)
    chip.spindle_percent = 100
    chip.say("[MSG:Pgm End]\r\n")


def _dwell(chip: Chip, seconds: float) -> Routine:
    for _ in range(ceil(round(seconds / DWELL_STEP_S, 6))):
        if chip.attention:
            yield from execute_realtime(chip)
        if chip.abort:
            return
        yield chip.now + DWELL_STEP_S


def _soft_limit(chip: Chip) -> Routine:
    chip.soft_limit = True
    if chip.state is State.RUN:
        chip.signals |= Signal.HOLD
        yield from _until_idle(chip)
        if chip.abort:
            return
    chip.reset()
    chip.alarm = 2
    yield from execute_realtime(chip)


def _until_idle(chip: Chip) -> Routine:
    while True:
        yield from execute_realtime(chip)
        if chip.state is State.IDLE or chip.abort:
            return
        if not chip.attention:
            yield None


def _probe(chip: Chip, action: Probe) -> Routine:
    """Move until the contact is as it is looked for, or to the end."""
    yield from synchronize(chip)
    if chip.abort:
        return
    chip.probed = False
    if chip.contact != action.away:
        chip.alarm = 4
        yield from execute_realtime(chip)
        chip.interpreter.modal.position_mm = chip.stepper.position_mm
        return
    chip.probe_for = not action.away
    yield from move(chip, action.move)
    chip.signals |= Signal.START
    yield from _until_idle(chip)
    if chip.abort:
        return
    yield from _probed(chip, action)


def _probed(chip: Chip, action: Probe) -> Routine:
    if not chip.probed and action.alarm:
        chip.alarm = 5
    elif not chip.probed:
        chip.probe_mm = chip.stepper.position_mm
    chip.probe_for, chip.holding = None, False
    yield from execute_realtime(chip)
    chip.stepper.stop(chip.now)
    chip.interpreter.modal.position_mm = chip.stepper.position_mm
    chip.say(status.probe(chip))
