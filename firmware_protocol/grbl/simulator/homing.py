"""The homing cycle of the simulated controller (`limits_go_home` of GRBL 1.1h), Z first, then X and Y."""

from __future__ import annotations

from firmware_protocol.grbl.simulator.actions import Move
from firmware_protocol.grbl.simulator.chip import Chip, State
from firmware_protocol.grbl.simulator.lookahead import Vector
from firmware_protocol.grbl.simulator.realtime import Routine, execute_realtime

SEARCH_FACTOR = 1.5
_NO_SWITCH = 9


def home(chip: Chip, switches_mm: Vector | None) -> Routine:
    """Seek the switches, which lie at `switches_mm` on the sheet; None: there are none, which ends in ALARM:9."""
    chip.state = State.HOMING
    for axes in ((2,), (0, 1)):
        yield from _axes(chip, axes, switches_mm)
        if chip.abort:
            return
    chip.state = State.IDLE
    chip.drivers_off()


def _axes(chip: Chip, axes: tuple[int, ...], switches_mm: Vector | None) -> Routine:
    seek, locate, pull_off = chip.settings[25], chip.settings[24], chip.settings[27]
    contacts = [_contact(chip, axis, switches_mm) for axis in axes]
    found = all(contact is not None for contact in contacts)
    ends = [_far(chip, axis) if contact is None else contact for axis, contact in zip(axes, contacts, strict=True)]
    yield from _go(chip, axes, ends, seek)
    if not found and not chip.abort:
        chip.alarm = _NO_SWITCH
        chip.reset()
        yield from execute_realtime(chip)
    away = [end - _direction(chip, axis) * pull_off for axis, end in zip(axes, ends, strict=True)]
    for places, feed in ((away, seek), (ends, locate), (away, seek)):
        if not chip.abort:
            yield from _go(chip, axes, places, feed)
    if not chip.abort:
        chip.set_position(_homed(chip, axes))


def _go(chip: Chip, axes: tuple[int, ...], places: list[float], feed: float) -> Routine:
    target = list(chip.stepper.position_mm)
    for axis, place in zip(axes, places, strict=True):
        target[axis] = place
    chip.lookahead.add(Move((target[0], target[1], target[2]), feed, jog=True))
    chip.stepper.start(chip.now)
    while chip.stepper.moving and not chip.abort:
        yield None
        if chip.alarm:
            yield from execute_realtime(chip)
    if not chip.abort and chip.settings[26]:
        yield chip.now + chip.settings[26] / 1000


def _direction(chip: Chip, axis: int) -> int:
    return -1 if int(chip.settings[23]) >> axis & 1 else 1


def _far(chip: Chip, axis: int) -> float:
    return chip.stepper.position_mm[axis] + _direction(chip, axis) * SEARCH_FACTOR * chip.settings[130 + axis]


def _contact(chip: Chip, axis: int, switches_mm: Vector | None) -> float | None:
    """Where the axis meets its switch, in machine coordinates; None when the search ends before."""
    if switches_mm is None:
        return None
    place = switches_mm[axis] - chip.sheet_mm[axis]
    way = (place - chip.stepper.position_mm[axis]) * _direction(chip, axis)
    return place if 0 <= way <= SEARCH_FACTOR * chip.settings[130 + axis] else None


def _homed(chip: Chip, axes: tuple[int, ...]) -> Vector:
    position = list(chip.stepper.position_mm)
    for axis in axes:
        pull_off = chip.settings[27]
        position[axis] = -pull_off if _direction(chip, axis) > 0 else pull_off - chip.settings[130 + axis]
    return position[0], position[1], position[2]
