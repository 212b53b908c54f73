"""What each state begins with."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from firmware_protocol.grbl import sentences
from firmware_protocol.grbl.flow import BARRIER, Flow
from firmware_protocol.grbl.habits import ASK, HOLD, RESET
from firmware_protocol.grbl.preparation import CHECK_MODE
from firmware_protocol.grbl.states import Signal, State
from firmware_protocol.session import NotReady, Ready, Resumed, Verdict, Waiting

if TYPE_CHECKING:
    from firmware_protocol.grbl.conversation import Conversation
    from firmware_protocol.grbl.job import Job

MOTORS_OFF, MOTORS_ON = "$1=25", "$1=255"
"""Off 25 ms after a stop, or never. $SLP would end in an alarm lock that only `$X` or homing opens."""

_VERDICTS = {
    Signal.STOP: Verdict.STOPPED,
    Signal.ABORT: Verdict.STOPPED,
    Signal.REFUSED: Verdict.REJECTED,
    Signal.ASTRAY: Verdict.ASTRAY,
    Signal.TORN: Verdict.ASTRAY,
    Signal.STUCK: Verdict.SILENT,
    Signal.SILENCE: Verdict.SILENT,
    Signal.ALARM: Verdict.ALARM,
    Signal.BANNER: Verdict.RESTARTED,
    Signal.UNPLUG: Verdict.UNPLUGGED,
}


@dataclass(frozen=True, slots=True)
class Cause:
    """Why a state was entered, and from which."""

    signal: Signal
    why: str
    position_known: bool
    before: State


def end_job(talk: Conversation, job: Job, *, lifted: bool) -> None:
    """The last word about the job."""
    talk.events.append(job.ended(lifted=lifted))
    talk.job = talk.preparation = None
    talk.flow = Flow((), room_bytes=None)


def _reading(talk: Conversation, _: Cause) -> None:
    talk.flow = Flow(("$I", "$$"), room_bytes=None)


def _homing(talk: Conversation, cause: Cause) -> None:
    talk.flow = Flow((*[MOTORS_ON] * (cause.before is State.RESTED), "$H"), room_bytes=None)


def _placing(talk: Conversation, cause: Cause) -> None:
    talk.flow = Flow((*[MOTORS_ON] * (cause.before is State.RESTED), talk.places), room_bytes=None)


def _locating(talk: Conversation, _: Cause) -> None:
    talk.controller.place_mm = None  # what was reported before was counted from elsewhere
    talk.urgent += ASK


def _setting(talk: Conversation, _: Cause) -> None:
    assert talk.preparation is not None
    talk.flow = Flow((*talk.preparation.commands, "$$"), room_bytes=None)


def _trying(talk: Conversation, _: Cause) -> None:
    assert talk.preparation is not None
    room = talk.controller.buffer_bytes if talk.habits.counting else None
    talk.flow = Flow(talk.preparation.trial, room_bytes=room)


def _leaving(talk: Conversation, _: Cause) -> None:
    talk.flow = Flow((CHECK_MODE,), room_bytes=None)


def _streaming(talk: Conversation, cause: Cause) -> None:
    assert talk.job is not None
    talk.events += [Resumed()] * (cause.signal is Signal.RESUME)
    talk.job.leg.end_before_change()
    talk.flow, talk.astray, talk.elsewhere, talk.waits_for = talk.job.leg.flow, 0, 0, ""


def _ready(talk: Conversation, cause: Cause) -> None:
    if talk.job is None:
        talk.events.append(Ready(talk.controller.firmware or "", talk.controller.buffer_bytes))
        return
    if cause.signal is Signal.REFUSED:
        talk.job.doom(Verdict.REJECTED, cause.why, position_known=True)
    lifted = bool(talk.habits.lift) and cause.before is not State.SETTING and cause.before is not State.LEAVING
    end_job(talk, talk.job, lifted=lifted)


def _switching(talk: Conversation, _: Cause) -> None:
    talk.flow = Flow((MOTORS_OFF,), room_bytes=None)


def _resetting(talk: Conversation, _: Cause) -> None:
    talk.urgent += RESET


def _rested(talk: Conversation, _: Cause) -> None:
    talk.events.append(Waiting(sentences.MOTORS_OFF))


def _holding(talk: Conversation, cause: Cause) -> None:
    talk.urgent += HOLD
    if talk.job is not None and cause.signal is Signal.STUCK and talk.flow is talk.job.leg.flow:
        talk.job.leg.doubt_from(talk.flow.synced)
    if cause.signal is not Signal.HALT:
        _doom(talk, cause, position_known=True)


def _lifting(talk: Conversation, _: Cause) -> None:
    talk.flow = Flow((*talk.habits.lift, BARRIER), room_bytes=None)


def _restarted(talk: Conversation, cause: Cause) -> None:
    # What was on its way when the controller restarted would still be drawn: hold it, then a reset throws it away.
    talk.urgent += HOLD
    talk.flow = Flow((), room_bytes=None)
    _doom(talk, cause, position_known=False)


def _asking(talk: Conversation, _: Cause) -> None:
    if not (talk.habits.lift and talk.habits.lift_after_restart):
        talk.go(Signal.NO_LIFT)


def _lost(talk: Conversation, cause: Cause) -> None:
    if cause.signal is Signal.SILENCE and talk.job is not None:
        talk.urgent += HOLD
    if cause.signal is Signal.ABORT:
        talk.urgent += RESET
    if talk.job is None:
        talk.events.append(NotReady(cause.why or sentences.LOCKED))
        return
    if cause.signal not in {Signal.COMPLETE, Signal.NO_LIFT}:
        _doom(talk, cause, position_known=cause.position_known)
    end_job(talk, talk.job, lifted=cause.signal is Signal.COMPLETE)


def _doom(talk: Conversation, cause: Cause, *, position_known: bool) -> None:
    if talk.job is not None:
        # A lift that is refused does not change for what reason the job is over.
        lifting = cause.signal is Signal.REFUSED and talk.state is State.LOST
        verdict = talk.job.verdict if lifting else _VERDICTS[cause.signal]
        talk.job.doom(verdict, cause.why, position_known=position_known)


ENTER: dict[State, Callable[[Conversation, Cause], None]] = {
    State.READING: _reading,
    State.HOMING: _homing,
    State.PLACING: _placing,
    State.LOCATING: _locating,
    State.READY: _ready,
    State.SETTING: _setting,
    State.TRYING: _trying,
    State.LEAVING: _leaving,
    State.STREAMING: _streaming,
    State.HOLDING: _holding,
    State.RESETTING: _resetting,
    State.LIFTING: _lifting,
    State.RESTARTED: _restarted,
    State.EMPTYING: _resetting,
    State.ASKING: _asking,
    State.RELIFTING: _lifting,
    State.SWITCHING: _switching,
    State.RELEASING: _resetting,
    State.RESTED: _rested,
    State.LOST: _lost,
}
