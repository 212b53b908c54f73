"""What a person is told about a job on an EMCO control: what, where, and what to do."""

from __future__ import annotations

PRESS_START = (
    "the control has not asked for the program yet: choose reading by the serial line at the control and press START"
)
THEN_START = "press START at the control, which waits at M0"
FINISHED = "every line was handed over and, by the time model, drawn: look at the sheet, the control does not say so"
NOT_BEGUN = "stopped on request before anything was sent"
STOPPED = "stopped on request: the control was told to lift the pen and end; by the time model it has done so"
ABORTED = (
    "stopped on request: nothing more is sent, but what the control already holds is still drawn: press feed hold "
    "and RESET at the control, lift the pen there and put in a new sheet"
)
NOT_LIFTED = (
    "stopped on request, but the control still draws what it holds or did not take the end: press feed hold and "
    "RESET at the control, lift the pen there and put in a new sheet"
)
UNPLUGGED = (
    "the port is gone; what the control already holds is still drawn: press RESET at the control, plug the cable in "
    "again and put in a new sheet"
)
_LOOK = "look at the control's screen, press RESET there, lift the pen and put in a new sheet"


def held(limit_s: float) -> str:
    return (
        f"the control has held the transfer by XOFF for {limit_s:g} s: {_LOOK}; if it was drawing, raise xoff_limit_s"
    )


def deaf(held_bytes: int, holds_bytes: int) -> str:
    return (
        f"the control has taken {held_bytes} bytes more than it can have drawn and holds {holds_bytes} at most, "
        f"so it no longer reads: {_LOOK}"
    )


def unanswered(seconds: float, number: int, text: str, heard: str) -> str:
    """number: from 1. heard: what came instead of an answer, or ""."""
    said = f" (it said {heard[:60]!r})" if heard else ""
    return f"the control has not acknowledged block {number} ({text!r}) within {seconds:g} s{said}: {_LOOK}"


def refused(times: int, number: int, text: str) -> str:
    """number: from 1."""
    return f"the control has refused block {number} ({text!r}) {times} times: check the line's format, {_LOOK}"
