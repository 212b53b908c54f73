"""The states of a conversation with an EMCO control, and the one table of what leads from each to the next."""

from __future__ import annotations

from enum import Enum, auto


class State(Enum):
    """Where the conversation stands."""

    READY = "ready"
    WAITING = "waiting for the control's first XON"
    SENDING = "sending"
    HELD = "held by XOFF"
    DRAWING = "everything is sent, the control draws"
    CHANGING = "everything before a pen change is sent, the control draws"
    PAUSED = "the pen is being changed"
    CLOSING = "sending the end after a stop"
    CLOSING_HELD = "held by XOFF after a stop"
    SETTLING = "the end is sent after a stop, the control draws what it has"
    LOST = "over"


class Signal(Enum):
    """What makes the conversation change its state."""

    START = auto()
    GO = auto()
    HOLD = auto()
    EMPTY = auto()
    CHANGE = auto()
    RESUME = auto()
    TIME = auto()
    STOP = auto()
    ABORT = auto()
    LATE = auto()
    REFUSED = auto()
    UNPLUG = auto()


SENDING = frozenset({State.SENDING, State.CLOSING})
"""Only here something is sent."""
STOPPING = frozenset({State.CLOSING, State.CLOSING_HELD, State.SETTLING})

TRANSITIONS: dict[tuple[State, Signal], State] = {
    # A job that runs to its end.
    (State.READY, Signal.START): State.WAITING,
    (State.WAITING, Signal.GO): State.SENDING,
    (State.SENDING, Signal.HOLD): State.HELD,
    (State.HELD, Signal.GO): State.SENDING,
    (State.SENDING, Signal.EMPTY): State.DRAWING,
    (State.DRAWING, Signal.TIME): State.READY,
    # The control stops by itself where the pen is changed; what follows is sent when a person says so.
    (State.SENDING, Signal.CHANGE): State.CHANGING,
    (State.CHANGING, Signal.TIME): State.PAUSED,
    (State.PAUSED, Signal.RESUME): State.SENDING,
    # A stop with lines that end the program for the control.
    (State.SENDING, Signal.STOP): State.CLOSING,
    (State.HELD, Signal.STOP): State.CLOSING_HELD,
    (State.CLOSING, Signal.HOLD): State.CLOSING_HELD,
    (State.CLOSING_HELD, Signal.GO): State.CLOSING,
    (State.CLOSING, Signal.EMPTY): State.SETTLING,
    (State.SETTLING, Signal.TIME): State.READY,
    # A stop without them, or after the last byte: nothing more can be said.
    (State.WAITING, Signal.ABORT): State.READY,
    (State.SENDING, Signal.ABORT): State.LOST,
    (State.HELD, Signal.ABORT): State.LOST,
    (State.DRAWING, Signal.ABORT): State.LOST,
    (State.CHANGING, Signal.ABORT): State.LOST,
    (State.PAUSED, Signal.ABORT): State.LOST,
    # A control that does not take what it should, or not in time.
    (State.SENDING, Signal.LATE): State.LOST,
    (State.HELD, Signal.LATE): State.LOST,
    (State.SENDING, Signal.REFUSED): State.LOST,
    (State.CLOSING, Signal.REFUSED): State.LOST,
    **{(state, Signal.LATE): State.LOST for state in STOPPING},
    **{(state, Signal.UNPLUG): State.LOST for state in State if state is not State.LOST},
}
"""What the table lacks has no meaning in that state: an XOFF behind the last byte is how some controls say thanks."""
