"""The homing cycle of the simulated controller (`limits_go_home` of GRBL 1.1h), Z first, then X and Y."""

from __future__ import annotations

from firmware_protocol.grbl.simulator.actions import Move
from firmware_protocol.grbl.simulator.chip import Chip, State
from firmware_protocol.grbl.simulator.inputs import Inputs
from firmware_protocol.grbl.simulator.lookahead import Vector
from firmware_protocol.grbl.simulator.realtime import Routine, execute_realtime

SEARCH_FACTOR = 1.5
_STILL_CLOSED, _NO_SWITCH = 8, 9


def home(chip: Chip) -> Routine:
    """Seek the switches. ALARM:9 when one is not found, ALARM:8 when one stays closed."""
    chip.state = State.HOMING
    for axes in ((2,), (0, 1)):
        yield from _axes(chip, axes)
        if chip.abort:
            return
    yield from execute_realtime(chip)
    if not chip.abort:
        chip.state = State.IDLE
        chip.drivers_off()


def _axes(chip: Chip, axes: tuple[int, ...]) -> Routine:
    seek, locate, pull_off = chip.settings[25], chip.settings[24], chip.settings[27]
    yield from _approach(chip, axes, seek)
    switches = [chip.stepper.position_mm[axis] for axis in axes]
    away = [end - _direction(chip, axis) * pull_off for axis, end in zip(axes, switches, strict=True)]
    for places, feed in ((away, seek), (switches, locate), (away, seek)):
        if chip.abort:
            return
        yield from _go(chip, axes, places, feed)
        if places is away and chip.limits.intersection(axes):
            yield from _fail(chip, _STILL_CLOSED)
        yield from _settle(chip)
    if not chip.abort:
        chip.set_position(_homed(chip, axes))


def _approach(chip: Chip, axes: tuple[int, ...], feed: float) -> Routine:
    """To the switches; whoever presses one by hand meanwhile makes it the place of its axis."""
    while not chip.abort:
        wired = chip.inputs
        contacts = [_contact(chip, axis) for axis in axes]
        ends = [_far(chip, axis) if contact is None else contact for axis, contact in zip(axes, contacts, strict=True)]
        yield from _go(chip, axes, ends, feed, while_wired=wired)
        if chip.inputs is wired:
            if None in contacts:
                yield from _fail(chip, _NO_SWITCH)
            break
    yield from _settle(chip)


def _go(
    chip: Chip, axes: tuple[int, ...], places: list[float], feed: float, *, while_wired: Inputs | None = None
) -> Routine:
    target = list(chip.stepper.position_mm)
    for axis, place in zip(axes, places, strict=True):
        target[axis] = place
    chip.lookahead.add(Move((target[0], target[1], target[2]), feed, jog=True))
    chip.stepper.start(chip.now)
    while chip.stepper.moving and not chip.abort:
        yield None
        if chip.alarm:
            yield from execute_realtime(chip)
        if while_wired is not None and chip.inputs is not while_wired:
            chip.stepper.stop(chip.now)


def _fail(chip: Chip, alarm: int) -> Routine:
    if not chip.abort:
        chip.alarm = alarm
        chip.reset()
        yield from execute_realtime(chip)


def _settle(chip: Chip) -> Routine:
    if not chip.abort and chip.settings[26]:
        yield chip.now + chip.settings[26] / 1000


def _direction(chip: Chip, axis: int) -> int:
    return -1 if int(chip.settings[23]) >> axis & 1 else 1


def _far(chip: Chip, axis: int) -> float:
    return chip.stepper.position_mm[axis] + _direction(chip, axis) * SEARCH_FACTOR * chip.settings[130 + axis]


def _contact(chip: Chip, axis: int) -> float | None:
    """Where the axis meets its switch, in machine coordinates; None when the search ends before."""
    here = chip.stepper.position_mm[axis]
    if axis in chip.limits:
        return here
    switch, direction = chip.inputs.switches.get(axis), _direction(chip, axis)
    if switch is None or switch.upwards != (direction > 0):
        return None
    place = switch.place_mm - chip.sheet_mm[axis]
    return place if 0 <= (place - here) * direction <= SEARCH_FACTOR * chip.settings[130 + axis] else None


def _homed(chip: Chip, axes: tuple[int, ...]) -> Vector:
    position = list(chip.stepper.position_mm)
    for axis in axes:
        pull_off = chip.settings[27]
        position[axis] = -pull_off if _direction(chip, axis) > 0 else pull_off - chip.settings[130 + axis]
    return position[0], position[1], position[2]
