"""What a command of the queue makes the arm do: moves, or an alarm because its target is out of reach."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeAlias

from firmware_protocol.dobot import commands
from firmware_protocol.dobot.commands import Command, Values
from firmware_protocol.dobot.kinematics import forward, inverse
from firmware_protocol.dobot.simulator.motion import Move, Pace, straight, turning, why_not
from firmware_protocol.ink import Vector

Settings: TypeAlias = Mapping[int, Values]
"""What was last written to each command that keeps it, by id."""

HOME_PARAMS, JOG_JOINT, JOG_XYZ, JOG_COMMON = 30, 70, 71, 72
PTP_JOINT, PTP_XYZ, PTP_JUMP, PTP_COMMON, CP_PARAMS = 80, 81, 82, 83, 90

DEFAULTS: dict[int, Values] = {
    HOME_PARAMS: (200.0, 0.0, 50.0, 0.0),
    JOG_JOINT: (50.0,) * 8,
    JOG_XYZ: (50.0,) * 8,
    JOG_COMMON: (50.0, 50.0),
    PTP_JOINT: (300.0,) * 4 + (400.0,) * 4,
    PTP_XYZ: (300.0, 300.0, 400.0, 400.0),
    PTP_JUMP: (20.0, 150.0),
    PTP_COMMON: (50.0, 50.0),
    CP_PARAMS: (100.0, 100.0, 100.0, 0),
}
"""Of the vendor's arm in software."""

_JUMPS, _TURNS = {0, 3, 9}, {0, 1, 3, 4, 6, 8}
_ANGLES, _ANGLE_STEPS, _STEPS = {3, 4, 5}, {6}, {7, 8}
_STILL_MM = 1e-6


class OutOfReach(Exception):
    """A target that no joint angles reach; `code` is the alarm."""

    def __init__(self, code: int) -> None:
        super().__init__(code)
        self.code = code


def ptp(command: Command, at: Vector, settings: Settings) -> list[Move]:
    """Raises OutOfReach."""
    mode, values = int(command.values[0]), _floats(command.values[1:])
    target = _target(mode, values, at)
    _check(target)
    across = turning if mode in _TURNS else straight
    pace = _turn_pace(settings) if mode in _TURNS else _xyz_pace(settings)
    if mode not in _JUMPS:
        return _moves(across(at, target, pace))
    height_mm, limit_mm = _floats(settings[PTP_JUMP])
    top_mm = min(max(at[2], target[2]) + height_mm, max(limit_mm, at[2], target[2]))
    above, over = (at[0], at[1], top_mm), (target[0], target[1], top_mm)
    _check(above)
    _check(over)
    up = straight(at, above, _xyz_pace(settings))
    return _moves(up, across(above, over, pace), straight(over, target, _xyz_pace(settings)))


def cp(command: Command, at: Vector, settings: Settings) -> list[Move]:
    """Without ramps: where one segment follows the other the arm does not stop. Raises OutOfReach."""
    mode, x, y, z, *last = _floats(command.values)
    target = (at[0] + x, at[1] + y, at[2] + z) if int(mode) == commands.RELATIVE else (x, y, z)
    _check(target)
    asked = last[0] if command.kind.name == "CP" and last else 0.0
    return _moves(straight(at, target, Pace(asked if asked > 0 else _floats(settings[CP_PARAMS])[1])))


def home(at: Vector, settings: Settings) -> list[Move]:
    """Up, and with all joints at once to the place that was set."""
    x, y, z, _ = _floats(settings[HOME_PARAMS])
    above = (at[0], at[1], max(at[2], z))
    start = above if why_not(above) is None else at
    return _moves(straight(at, start, Pace(50.0)), turning(start, (x, y, z), Pace(30.0)))


def jog(joint: bool, direction: int, at: Vector, settings: Settings) -> Move:
    """As far as the reach goes, in one axis or one joint; directions 7 and 8 turn the tool, which moves no pen."""
    axis, sign = (direction - 1) // 2, 1.0 if direction % 2 else -1.0
    share = _floats(settings[JOG_COMMON])[0] / 100
    way, here = [at], at
    while axis < 3 and why_not(here := _jogged(here, joint, axis, sign)) is None:
        way.append(here)
    return Move(tuple(way) if len(way) > 1 else (at, at), len(way) - 1.0, Pace(50.0 * share))


def _jogged(at: Vector, joint: bool, axis: int, step: float) -> Vector:
    turned = inverse(at) if joint else at
    if turned is None:
        return at[0], at[1], float("inf")
    a, b, c = (value + step * (number == axis) for number, value in enumerate(turned))
    return forward((a, b, c)) if joint else (a, b, c)


def _target(mode: int, values: tuple[float, ...], at: Vector) -> Vector:
    a, b, c, _ = values
    if mode in _STEPS:
        return at[0] + a, at[1] + b, at[2] + c
    if mode in _ANGLES:
        return forward((a, b, c))
    if mode in _ANGLE_STEPS:
        j1, j2, j3 = inverse(at) or (0.0, 0.0, 0.0)
        return forward((j1 + a, j2 + b, j3 + c))
    return a, b, c


def _check(target: Vector) -> None:
    if (alarm := why_not(target)) is not None:
        raise OutOfReach(alarm)


def _moves(*moves: Move) -> list[Move]:
    return [move for move in moves if move.length > _STILL_MM or move.alarm is not None]


def _xyz_pace(settings: Settings) -> Pace:
    return _pace(settings, PTP_XYZ, 0, 2)


def _turn_pace(settings: Settings) -> Pace:
    return _pace(settings, PTP_JOINT, 0, 4)


def _pace(settings: Settings, which: int, speed: int, acceleration: int) -> Pace:
    values, (speed_percent, acceleration_percent) = _floats(settings[which]), _floats(settings[PTP_COMMON])
    return Pace(
        max(0.1, values[speed] * speed_percent / 100), max(0.1, values[acceleration] * acceleration_percent / 100)
    )


def _floats(values: Values) -> tuple[float, ...]:
    return tuple(float(value) for value in values)
