"""A simulated arm as the query of a URL describes it: `sim://dobot?depth=32&first_index=2&cut=@40`."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeVar

from firmware_protocol.dobot.commands import NONE_YET
from firmware_protocol.dobot.kinematics import SHEET_ORIGIN_MM, Flat
from firmware_protocol.dobot.simulator.arm import Build
from firmware_protocol.dobot.simulator.faults import (
    ClosePort,
    CorruptReply,
    CorruptRequest,
    DelayReply,
    DropReply,
    Fault,
    Hang,
    PowerCut,
    RaiseAlarm,
    StopQueue,
    StrayByte,
)
from firmware_protocol.dobot.simulator.simulator import DobotSimulator
from firmware_protocol.ink import PenRule

_REPLIES: Mapping[str, type[DropReply | CorruptReply | StrayByte]] = {
    "drop": DropReply,
    "corrupt": CorruptReply,
    "stray": StrayByte,
}
_MOMENTS: Mapping[str, type[ClosePort | PowerCut | Hang | StopQueue]] = {
    "close": ClosePort,
    "cut": PowerCut,
    "hang": Hang,
    "stop": StopQueue,
}
_FLAGS = {"0": False, "1": True}
_UNUSED = {"0": 0, "none": NONE_YET}

_T = TypeVar("_T")


def simulator_from(
    options: Mapping[str, str], *, pen: PenRule | None = None, faults: Sequence[Fault] = ()
) -> DobotSimulator:
    """The simulated arm of these options; what they say goes before the arguments.

    depth, first_index, left_bytes (4 or 8), unused (0 or none), left_holds_running, clear_resets and abort_counts
    (0 or 1), home_s;
    alarms (codes in hexadecimal, joined by colons), pen_z (height in mm at which the pen touches), origin (X:Y of the
    sheet on the arm, in mm; unless stated that of `kinematics`); faults: drop, corrupt, stray by the number of the
    acknowledgement from 0, or aN for the N-th other answer; delay=N:SECONDS; lose=N for a command that arrives damaged;
    close, cut, hang, stop in seconds or @N for behind the N-th acknowledgement; alarm=CODE:MOMENT. Raises ValueError.
    """
    rest = dict(options)
    build = Build(
        depth=_taken(rest, "depth", int, 32),
        first_index=_taken(rest, "first_index", int, 1),
        unused=_taken(rest, "unused", _UNUSED.__getitem__, 0),
        left_holds_running=_taken(rest, "left_holds_running", _FLAGS.__getitem__, True),
        clear_resets=_taken(rest, "clear_resets", _FLAGS.__getitem__, False),
        abort_counts=_taken(rest, "abort_counts", _FLAGS.__getitem__, False),
        home_s=_taken(rest, "home_s", float, 10.0),
    )
    left_bytes = _taken(rest, "left_bytes", int, 4)
    standing: list[int] = _taken(rest, "alarms", _codes, [])
    pen = _taken(rest, "pen_z", _pen, pen)
    origin_mm = _taken(rest, "origin", _pair, SHEET_ORIGIN_MM)
    asked = [_fault(key, value) for key, value in rest.items()]
    return DobotSimulator(
        build=build,
        left_bytes=left_bytes,
        alarms=standing,
        faults=(*faults, *asked),
        pen=pen,
        sheet_origin_mm=origin_mm,
    )


def _taken(rest: dict[str, str], key: str, read: Callable[[str], _T], otherwise: _T) -> _T:
    if key not in rest:
        return otherwise
    try:
        return read(rest.pop(key))
    except (KeyError, ValueError) as error:
        raise ValueError(f"{key} cannot be {error}") from error


def _codes(text: str) -> list[int]:
    return [int(code, 16) for code in text.split(":")]


def _pen(text: str) -> PenRule | None:
    return PenRule(down_at_mm=float(text))


def _pair(text: str) -> Flat:
    x_mm, y_mm = map(float, text.split(":"))
    return x_mm, y_mm


def _fault(key: str, value: str) -> Fault:
    first, _, second = value.partition(":")
    try:
        if key in _REPLIES:
            return _REPLIES[key](int(value.lstrip("a")), answers=value.startswith("a"))
        if key == "delay":
            return DelayReply(int(first.lstrip("a")), answers=first.startswith("a"), by_s=float(second))
        if key == "lose":
            return CorruptRequest(int(value))
        if key == "alarm":
            return RaiseAlarm(code=int(first, 16), **_moment(second))
        if key in _MOMENTS:
            return _MOMENTS[key](**_moment(value))
    except ValueError as error:
        raise ValueError(f"{key}={value} is no fault of an arm ({error})") from error
    raise ValueError(f"there is no option {key}")


def _moment(text: str) -> dict[str, Any]:
    return {"after_acks": int(text[1:])} if text.startswith("@") else {"at_s": float(text)}
