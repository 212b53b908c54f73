"""The states of a conversation with an arm, and the one table of what leads from each to the next."""

from __future__ import annotations

from enum import Enum, auto


class State(Enum):
    """Where the conversation stands."""

    INTRODUCING = "asking who is there, clearing alarms and the queue"
    HOMING = "homing"
    READY = "ready"
    DRAWING = "drawing"
    HOLDING = "stopping at once and lifting the pen"
    PAUSED = "paused"
    ABORTING = "stopping the arm and lifting the pen"
    LOST = "over"


class Signal(Enum):
    """What makes the conversation change its state."""

    COMPLETE = auto()
    HOME = auto()
    START = auto()
    STOP = auto()
    HOLD = auto()
    STAND = auto()
    RESUME = auto()
    REFUSED = auto()
    DOUBT = auto()
    STUCK = auto()
    ALARM = auto()
    RESTARTED = auto()
    OVER = auto()
    SILENCE = auto()
    UNPLUG = auto()


_BEFORE = (State.INTRODUCING, State.HOMING, State.READY)
WITH_A_JOB = (State.DRAWING, State.HOLDING, State.PAUSED, State.ABORTING)
_STOPS = (Signal.STOP, Signal.REFUSED, Signal.DOUBT, Signal.STUCK, Signal.ALARM)

TRANSITIONS: dict[tuple[State, Signal], State] = {
    (State.INTRODUCING, Signal.HOME): State.HOMING,
    (State.INTRODUCING, Signal.COMPLETE): State.READY,
    (State.HOMING, Signal.COMPLETE): State.READY,
    **{(state, signal): State.LOST for state in _BEFORE for signal in (Signal.ALARM, Signal.STUCK, Signal.REFUSED)},
    (State.READY, Signal.START): State.DRAWING,
    # A job that runs to its end, with pauses.
    (State.DRAWING, Signal.COMPLETE): State.READY,
    (State.DRAWING, Signal.STAND): State.PAUSED,
    (State.DRAWING, Signal.HOLD): State.HOLDING,
    (State.HOLDING, Signal.STAND): State.PAUSED,
    (State.PAUSED, Signal.RESUME): State.DRAWING,
    # A job that ends before: abort the command, empty the queue, lift the pen where the arm knows where it is.
    **{(State.DRAWING, signal): State.ABORTING for signal in _STOPS},
    **{(State.HOLDING, signal): State.ABORTING for signal in _STOPS},
    **{(State.PAUSED, signal): State.ABORTING for signal in _STOPS},
    (State.ABORTING, Signal.COMPLETE): State.READY,
    (State.ABORTING, Signal.OVER): State.LOST,
    **{(State.ABORTING, signal): State.LOST for signal in _STOPS if signal is not Signal.STOP},
    # From everywhere.
    **{
        (state, signal): State.LOST
        for state in State
        for signal in (Signal.RESTARTED, Signal.SILENCE, Signal.UNPLUG)
        if state is not State.LOST
    },
}
"""What the table lacks has no meaning in that state and changes nothing."""
