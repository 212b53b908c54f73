"""How a session treats its controller: what it may do, and how long it waits."""

from __future__ import annotations

from dataclasses import dataclass

from firmware_protocol.grbl.states import State

ASK, RESET, HOLD, GO_ON = b"?", b"\x18", b"!", b"~"

POLL_S = {State.READY: 1.0, State.PAUSED: 1.0, State.RESTED: 1.0, State.HOLDING: 0.1, State.RESTARTED: 0.1}
"""Seconds between two `?` where it is not GRBL's own advice of 0.2: a hold is watched closer, the pen is down."""
USUAL_POLL_S = 0.2

STANDS = frozenset({"Hold:0", "Door:0", "Door:1", "Check", "Sleep"})
"""States besides Idle and Alarm in which nothing moves, so that a reset loses no step."""

HOLD_WITHIN_S = 3.0
"""A controller that still runs this long after a feed hold does not hear it and is reset in motion."""


@dataclass(frozen=True, slots=True)
class Habits:
    """See `GrblSession`."""

    counting: bool
    lift: tuple[str, ...]
    lift_after_restart: bool
    home: bool
    may_set: bool
    dry_run: bool


@dataclass(frozen=True, slots=True)
class Patience:
    """How long a session waits.

    silent_after_s: for an answer, before the controller counts as silent. banner_within_s: for a controller behind a
    port that was opened. home_within_s: for the end of `$H`. motors_off_after_min: for the next job before the motors
    are switched off; None: they stay on.
    """

    silent_after_s: float = 3.0
    banner_within_s: float = 6.0
    home_within_s: float = 300.0
    motors_off_after_min: float | None = None
