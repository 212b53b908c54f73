"""What a person is told when a GRBL controller takes no job or a job ends: what, where, and what to do."""

from __future__ import annotations

from collections.abc import Sequence

from firmware_protocol.grbl import codes
from firmware_protocol.grbl.replies import Triple
from firmware_protocol.grbl.states import State
from firmware_protocol.session import Finding

LOCKED = (
    "the controller is locked by an alarm: look what blocks the machine, then home it, "
    "or switch the controller off and on"
)
RESTARTED = (
    "the controller restarted by itself, so its position is lost: check its power supply and the cable, "
    "set the pen to its origin and put in a new sheet"
)
ALARMED = f"the controller reports an alarm and locked itself: {codes.ALARMS[1].remedy}"
STOPPED = "stopped on request, the position is kept: put in a new sheet before the next drawing"
STOPPED_HOMING = "stopped on request while homing, so the position is unknown: home the machine before the next drawing"
CUT_UNKNOWN = (
    "stopped, as the place where the line was cut is not known and it cannot go on: put in a new sheet before the next "
    "drawing"
)
MOTORS_OFF = (
    "the motors have been switched off, so the position is unknown: home the machine, "
    "or set the pen to its origin and say so"
)
WAITING = {
    "Hold": (
        "somebody pressed feed hold, or the program says M0: press cycle start at the controller or let the drawing go "
        "on, or stop it"
    ),
    "Door": "the safety door is open: close it, then press cycle start or let the drawing go on, or stop it",
    "Sleep": "the controller sleeps and has switched its motors off: stop the drawing and home the machine",
}
FINISHED = "every line was drawn"
UNPLUGGED = "the port is gone: plug the machine in again, set the pen to its origin and put in a new sheet"


def outdated(firmware: str) -> str:
    return f"the controller runs {firmware}, which does not report its state: flash GRBL 1.1"


def displaced(offset_mm: tuple[float, float]) -> str:
    """offset_mm: of X0 Y0, in machine coordinates."""
    return (
        f"a work offset is stored that moves X0 Y0 to ({offset_mm[0]:g}, {offset_mm[1]:g}) mm, so a drawing comes "
        "out there: clear it with `G10 L2 P1 X0 Y0` and `G92.1` from any sender"
    )


def rejected(number: int, text: str, code: int) -> str:
    """number: from 1."""
    return f"line {number} ({text!r}) was refused with error:{code}, {codes.error(code)}"


def refused_by_homing(code: int) -> str:
    return f"homing was refused with error:{code}, {codes.error(code)}"


def alarmed(code: int) -> str:
    return f"ALARM:{code}, {codes.alarm(code)}"


def obstacles(findings: Sequence[Finding]) -> str:
    """What keeps a job from being begun."""
    return "; ".join(finding.why for finding in findings)


def astray(place_mm: Triple, number: int, text: str) -> str:
    """number: from 1, of the next line to be answered."""
    x, y, z = place_mm
    return (
        f"the pen was seen at ({x:g}, {y:g}, {z:g}) mm, which is not on its path near line {number} ({text!r}), so a "
        "byte was changed on the way: check the cable, then draw on a new sheet"
    )


def glimpsed(place_mm: Triple) -> str:
    """For a single report that no second one confirmed."""
    x, y, z = place_mm
    return (
        f"one report put the pen at ({x:g}, {y:g}, {z:g}) mm, off its path, the next one did not: look at the drawing"
    )


TORN = (
    "the controller has answered more lines than were sent, so a line was torn on the way: "
    "check the cable, then draw on a new sheet"
)


def silent(seconds: float) -> str:
    return f"the controller has not answered for {seconds:g} s: check the cable and its power supply"


def stuck(seconds: float, number: int, text: str) -> str:
    """number: from 1, of the line whose answer is missing."""
    return (
        f"the controller has stood idle for {seconds:g} s without answering line {number} ({text!r}), "
        f"so a byte was lost on the way: check the cable, then draw on a new sheet"
    )


def noise(fault: str) -> str:
    return f"the controller sends noise: {fault}"


def late(state: State, seconds: float, *, found: bool, heard: str) -> str:
    """For a state that has lasted too long.

    found: a status report came before any banner. heard: the last state or other word of the device, or "".
    """
    match state:
        case State.WAITING if found:
            return f"the controller is in state {heard} and cannot be reset now: wait until the machine stands still"
        case State.WAITING:
            return _no_grbl(seconds, heard)
        case State.GREETED:
            return f"the controller is in state {heard or 'unknown'} instead of Idle: end what it does, close its door"
        case State.HOMING:
            return f"homing has not ended after {seconds:g} s: check the limit switches and $23 to $27"
        case _:
            return silent(seconds)


def _no_grbl(seconds: float, heard: str) -> str:
    said = f"what answers is not GRBL (it said {heard[:60]!r})" if heard else f"nothing answered within {seconds:g} s"
    return f"{said}: check the port, the baud rate and that the controller has power"
