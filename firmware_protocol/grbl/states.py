"""The states of a GRBL conversation, and the one table of what leads from each to the next."""

from __future__ import annotations

from enum import Enum, auto


class State(Enum):
    """Where the conversation stands."""

    WAITING = "waiting for the banner"
    GREETED = "waiting for the controller to stand still"
    READING = "reading version and settings"
    HOMING = "homing"
    READY = "ready"
    STREAMING = "streaming"
    SETTLING = "waiting for the last motion to end"
    HOLDING = "waiting for the feed hold to stand"
    RESETTING = "waiting for the banner after a hold and a reset"
    LIFTING = "lifting the pen after a stop"
    RESTARTED = "holding a controller that restarted by itself"
    EMPTYING = "resetting it after the hold"
    ASKING = "asking a restarted controller for its state"
    RELIFTING = "lifting the pen after a restart"
    LOST = "over"


class Signal(Enum):
    """What makes the conversation change its state."""

    BANNER = auto()
    STILL = auto()
    COMPLETE = auto()
    HOME = auto()
    LOCKED = auto()
    NO_LIFT = auto()
    OUTDATED = auto()
    DISPLACED = auto()
    START = auto()
    STOP = auto()
    ABORT = auto()
    REFUSED = auto()
    HELD = auto()
    ALARM = auto()
    STUCK = auto()
    SILENCE = auto()
    UNPLUG = auto()


WITH_A_JOB = (
    State.STREAMING,
    State.SETTLING,
    State.HOLDING,
    State.RESETTING,
    State.LIFTING,
    State.RESTARTED,
    State.EMPTYING,
    State.ASKING,
    State.RELIFTING,
)

POLLED = frozenset(State) - {State.WAITING, State.HOMING, State.RESETTING, State.EMPTYING, State.LOST}
"""Here the controller is asked `?` and must answer."""

SENDING = frozenset({State.READING, State.HOMING, State.STREAMING, State.LIFTING, State.RELIFTING})
"""Only here lines are sent."""

TRANSITIONS: dict[tuple[State, Signal], State] = {
    # Start-up: banner, standing still, `$I` and `$$`, homing where it is wanted.
    (State.WAITING, Signal.BANNER): State.GREETED,
    (State.WAITING, Signal.OUTDATED): State.LOST,
    (State.GREETED, Signal.BANNER): State.GREETED,
    (State.GREETED, Signal.OUTDATED): State.LOST,
    (State.GREETED, Signal.STILL): State.READING,
    (State.READING, Signal.BANNER): State.GREETED,
    (State.READING, Signal.REFUSED): State.GREETED,
    (State.READING, Signal.HOME): State.HOMING,
    (State.READING, Signal.LOCKED): State.LOST,
    (State.READING, Signal.DISPLACED): State.LOST,
    (State.READING, Signal.COMPLETE): State.READY,
    (State.READING, Signal.STUCK): State.LOST,
    (State.HOMING, Signal.BANNER): State.LOST,
    (State.HOMING, Signal.ALARM): State.LOST,
    (State.HOMING, Signal.REFUSED): State.LOST,
    (State.HOMING, Signal.COMPLETE): State.READY,
    # Between jobs.
    (State.READY, Signal.BANNER): State.LOST,
    (State.READY, Signal.ALARM): State.LOST,
    (State.READY, Signal.START): State.STREAMING,
    # A job that runs to its end.
    (State.STREAMING, Signal.COMPLETE): State.SETTLING,
    (State.SETTLING, Signal.STILL): State.READY,
    # A job that is stopped, by a person, by `error:N` or for a lost answer: hold, reset, lift.
    (State.STREAMING, Signal.STOP): State.HOLDING,
    (State.STREAMING, Signal.REFUSED): State.HOLDING,
    (State.STREAMING, Signal.STUCK): State.HOLDING,
    (State.STREAMING, Signal.ABORT): State.LOST,
    (State.SETTLING, Signal.STOP): State.HOLDING,
    (State.HOLDING, Signal.HELD): State.RESETTING,
    (State.RESETTING, Signal.BANNER): State.LIFTING,
    (State.LIFTING, Signal.COMPLETE): State.READY,
    (State.LIFTING, Signal.REFUSED): State.LOST,
    (State.LIFTING, Signal.STUCK): State.LOST,
    # A controller that restarted by itself: what was still on its way is held and thrown away, then a lift may follow.
    (State.STREAMING, Signal.BANNER): State.RESTARTED,
    (State.SETTLING, Signal.BANNER): State.RESTARTED,
    (State.HOLDING, Signal.BANNER): State.RESTARTED,
    (State.LIFTING, Signal.BANNER): State.RESTARTED,
    (State.RESTARTED, Signal.BANNER): State.LOST,
    (State.RESTARTED, Signal.HELD): State.EMPTYING,
    (State.EMPTYING, Signal.BANNER): State.ASKING,
    (State.ASKING, Signal.STILL): State.RELIFTING,
    (State.ASKING, Signal.NO_LIFT): State.LOST,
    (State.ASKING, Signal.BANNER): State.LOST,
    (State.RELIFTING, Signal.BANNER): State.LOST,
    (State.RELIFTING, Signal.REFUSED): State.LOST,
    (State.RELIFTING, Signal.STUCK): State.LOST,
    (State.RELIFTING, Signal.COMPLETE): State.LOST,
    # From everywhere.
    **{(state, Signal.SILENCE): State.LOST for state in State if state is not State.LOST},
    **{(state, Signal.UNPLUG): State.LOST for state in State if state is not State.LOST},
    **{(state, Signal.ALARM): State.LOST for state in WITH_A_JOB},
}
"""What the table lacks has no meaning in that state: a stray answer of the device changes nothing."""
