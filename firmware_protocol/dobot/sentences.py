"""What a person is told when an arm takes no job or a job ends: what, where, and what to do."""

from __future__ import annotations

from firmware_protocol.dobot import alarms

FINISHED = "every line was drawn"
STOPPED = "stopped on request, the position is kept: put in a new sheet before the next drawing"
RESTARTED = (
    "the arm restarted by itself, so its position is lost: check its power supply, home it and put in a new sheet"
)
UNPLUGGED = (
    "the port is gone, and the arm goes on with what is in its queue: plug it in again, home it and put in a new sheet"
)


def alarmed(active: tuple[int, ...]) -> str:
    return f"the arm reports {alarms.sentence(active)}"


def still_alarmed(active: tuple[int, ...]) -> str:
    return f"the alarm comes back when it is cleared: {alarms.sentence(active)}"


def refused(number: int, text: str) -> str:
    """number: from 1."""
    return f"line {number} ({text!r}) was sent twice and taken neither time: check that the arm's firmware knows it"


def doubtful(number: int, text: str) -> str:
    """number: from 1."""
    return (
        f"the acknowledgement of line {number} ({text!r}) was lost, and the arm does not tell whether it has taken it, "
        "so it was not sent again: check the cable, then draw on a new sheet"
    )


def refused_command(text: str) -> str:
    return f"the arm does not take {text!r}: switch it off and on"


def stuck(seconds: float, number: int) -> str:
    """number: from 1, of the line that is not executed."""
    return (
        f"the arm has stood still for {seconds:g} s before line {number} without an alarm: look what holds it, "
        "switch it off and on, then draw on a new sheet"
    )


def not_home(seconds: float) -> str:
    return f"homing has not ended after {seconds:g} s: look what blocks the arm, then switch it off and on"


def not_lifted(seconds: float) -> str:
    return f"the arm has stood still for {seconds:g} s instead of lifting its pen: lift it by hand"


def silent(seconds: float) -> str:
    return f"the arm has not answered for {seconds:g} s: check the cable and its power supply"


def nobody(seconds: float, *, noise: bool) -> str:
    if noise:
        return "what answers is no Dobot Magician: check the port and that the baud rate is 115200"
    return f"nothing answered within {seconds:g} s: check the port and that the arm is switched on"
