"""The states of a GRBL conversation, and the one table of what leads from each to the next."""

from __future__ import annotations

from enum import Enum, auto


class State(Enum):
    """Where the conversation stands."""

    WAITING = "waiting for the banner"
    GREETED = "waiting for the controller to stand still"
    READING = "reading version and settings"
    HOMING = "homing"
    PLACING = "storing where the origin lies"
    LOCATING = "asking where the pen is now"
    READY = "ready"
    SETTING = "writing settings"
    TRYING = "trying the program in check mode"
    LEAVING = "leaving check mode"
    STREAMING = "streaming"
    PAUSING = "drawing a stroke to its end before a pause"
    PAUSED = "paused"
    SETTLING = "waiting for the last motion to end"
    HOLDING = "waiting for the feed hold to stand"
    RESETTING = "waiting for the banner after a hold and a reset"
    LIFTING = "lifting the pen after a stop"
    RESTARTED = "holding a controller that restarted by itself"
    EMPTYING = "resetting it after the hold"
    ASKING = "asking a restarted controller for its state"
    RELIFTING = "lifting the pen after a restart"
    SWITCHING = "telling the motors to switch off"
    RELEASING = "resetting it, so that the motors switch off"
    RESTED = "resting with the motors off"
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
    PLACE = auto()
    REST = auto()
    SET = auto()
    TRY = auto()
    START = auto()
    QUIT = auto()
    PAUSE = auto()
    HALT = auto()
    STANDS = auto()
    RESUME = auto()
    STOP = auto()
    ABORT = auto()
    REFUSED = auto()
    ASTRAY = auto()
    TORN = auto()
    HELD = auto()
    ALARM = auto()
    STUCK = auto()
    SILENCE = auto()
    UNPLUG = auto()


WITH_A_JOB = (
    State.SETTING,
    State.TRYING,
    State.LEAVING,
    State.STREAMING,
    State.PAUSING,
    State.PAUSED,
    State.SETTLING,
    State.HOLDING,
    State.RESETTING,
    State.LIFTING,
    State.RESTARTED,
    State.EMPTYING,
    State.ASKING,
    State.RELIFTING,
)

RUNNING = frozenset({State.STREAMING, State.PAUSING, State.SETTLING})
"""Here the pen moves along the lines of a job."""

POLLED = frozenset(State) - {
    State.WAITING,
    State.HOMING,
    State.PLACING,
    State.SETTING,
    State.LEAVING,
    State.RESETTING,
    State.EMPTYING,
    State.SWITCHING,
    State.RELEASING,
    State.LOST,
}
"""Here the controller is asked `?` and must answer. While it writes to its memory nothing else is on the wire."""

SENDING = frozenset(
    {
        State.READING,
        State.HOMING,
        State.PLACING,
        State.SETTING,
        State.TRYING,
        State.LEAVING,
        State.STREAMING,
        State.PAUSING,
        State.LIFTING,
        State.RELIFTING,
        State.SWITCHING,
    }
)
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
    (State.READING, Signal.PLACE): State.PLACING,
    (State.HOMING, Signal.BANNER): State.LOST,
    (State.HOMING, Signal.ALARM): State.LOST,
    (State.HOMING, Signal.REFUSED): State.LOST,
    (State.HOMING, Signal.COMPLETE): State.LOCATING,
    (State.PLACING, Signal.BANNER): State.LOST,
    (State.PLACING, Signal.REFUSED): State.LOST,
    (State.PLACING, Signal.COMPLETE): State.LOCATING,
    (State.LOCATING, Signal.STILL): State.READY,
    (State.LOCATING, Signal.BANNER): State.LOST,
    (State.LOCATING, Signal.ALARM): State.LOST,
    # Between jobs.
    (State.READY, Signal.BANNER): State.LOST,
    (State.READY, Signal.ALARM): State.LOST,
    (State.READY, Signal.HOME): State.HOMING,
    (State.READY, Signal.PLACE): State.PLACING,
    (State.READY, Signal.SET): State.SETTING,
    (State.READY, Signal.TRY): State.TRYING,
    (State.READY, Signal.START): State.STREAMING,
    # Motors that must not stay hot: the controller takes a reset to switch them off, and then nobody knows the place.
    (State.READY, Signal.REST): State.SWITCHING,
    (State.SWITCHING, Signal.COMPLETE): State.RELEASING,
    (State.SWITCHING, Signal.REFUSED): State.READY,
    (State.SWITCHING, Signal.BANNER): State.LOST,
    (State.RELEASING, Signal.BANNER): State.RESTED,
    (State.RESTED, Signal.BANNER): State.LOST,
    (State.RESTED, Signal.ALARM): State.LOST,
    (State.RESTED, Signal.HOME): State.HOMING,
    (State.RESTED, Signal.PLACE): State.PLACING,
    # Before a job: settings are mended, the program is tried without motion.
    (State.SETTING, Signal.TRY): State.TRYING,
    (State.SETTING, Signal.START): State.STREAMING,
    (State.SETTING, Signal.REFUSED): State.READY,
    (State.SETTING, Signal.QUIT): State.READY,
    (State.SETTING, Signal.BANNER): State.LOST,
    (State.TRYING, Signal.COMPLETE): State.LEAVING,
    (State.TRYING, Signal.STOP): State.HOLDING,
    (State.TRYING, Signal.REFUSED): State.HOLDING,
    (State.TRYING, Signal.STUCK): State.HOLDING,
    (State.TRYING, Signal.BANNER): State.RESTARTED,
    (State.LEAVING, Signal.START): State.STREAMING,
    (State.LEAVING, Signal.REFUSED): State.HOLDING,
    (State.LEAVING, Signal.QUIT): State.READY,
    (State.LEAVING, Signal.BANNER): State.RESTARTED,
    # A job that runs to its end.
    (State.STREAMING, Signal.COMPLETE): State.SETTLING,
    (State.SETTLING, Signal.STILL): State.READY,
    # A job that pauses: behind a stroke, or at once with hold, reset and lift; then it goes on or ends.
    (State.STREAMING, Signal.PAUSE): State.PAUSING,
    (State.PAUSING, Signal.COMPLETE): State.SETTLING,
    (State.SETTLING, Signal.STANDS): State.PAUSED,
    **{(state, Signal.HALT): State.HOLDING for state in RUNNING},
    (State.LIFTING, Signal.STANDS): State.PAUSED,
    (State.PAUSED, Signal.RESUME): State.STREAMING,
    (State.PAUSED, Signal.STOP): State.HOLDING,
    (State.PAUSED, Signal.BANNER): State.RESTARTED,
    # A job that is stopped, by a person, by `error:N`, for a lost answer or a wrong way: hold, reset, lift.
    **{(state, Signal.STOP): State.HOLDING for state in RUNNING},
    **{(state, Signal.ASTRAY): State.HOLDING for state in RUNNING},
    **{(state, Signal.TORN): State.HOLDING for state in RUNNING},
    (State.STREAMING, Signal.REFUSED): State.HOLDING,
    (State.STREAMING, Signal.STUCK): State.HOLDING,
    (State.STREAMING, Signal.ABORT): State.LOST,
    (State.PAUSING, Signal.REFUSED): State.HOLDING,
    (State.PAUSING, Signal.STUCK): State.HOLDING,
    (State.PAUSING, Signal.ABORT): State.LOST,
    (State.HOLDING, Signal.HELD): State.RESETTING,
    (State.RESETTING, Signal.BANNER): State.LIFTING,
    (State.LIFTING, Signal.COMPLETE): State.READY,
    (State.LIFTING, Signal.REFUSED): State.LOST,
    (State.LIFTING, Signal.STUCK): State.LOST,
    # A controller that restarted by itself: what was still on its way is held and thrown away, then a lift may follow.
    **{(state, Signal.BANNER): State.RESTARTED for state in RUNNING},
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
