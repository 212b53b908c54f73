"""A pen that stands: the job is paused until it goes on; and one of which the place is forgotten."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Literal, TypeAlias

from daemon.errors import DiskTrouble
from daemon.jobs.states import Reason, State
from firmware_protocol.session import Paused, Resumed, Waiting

if TYPE_CHECKING:
    from daemon.jobs.desk import Desk
    from daemon.jobs.station import Station

Stand: TypeAlias = Paused | Waiting | Resumed
_PAUSED = "paused{where}, the pen is up: {resume} goes on, {stop} ends it"
_GOES_ON = "the machine goes on"
_CAUSES: dict[Literal["hold", "door", "sleep", ""], Reason] = {
    "hold": Reason.AT_THE_MACHINE,
    "door": Reason.DOOR,
    "sleep": Reason.POWER,
}


def stand(event: Stand, job_id: str, station: Station, *, pen: str = "") -> None:
    """Record and tell it. job_id: of the job that is drawn; "" where the machine moves without one.

    pen: that a change puts in; "" where it has no name.
    """
    state, reason, words = _what(event, station, pen)
    # Whoever shows what the job says meanwhile waits for its step.
    with station.desk.changed:
        station.show(state=state.value, reason=reason.value, words="" if state is State.DRAWING else words)
        job = station.desk.journal.job(job_id)
        if job is None:
            station.say(words, level=logging.WARNING)
        elif (job.state, job.reason) != (state, reason):
            _step(station.desk, job_id, state, reason, words)


def forget_place(desk: Desk, why: str, station: Station | None = None) -> None:
    """The machine no longer knows where its pen is, so that what it had left in order cannot simply go on.

    station: that of the machine; None: all of them.
    """
    for job in desk.journal.jobs(State.INTERRUPTED):
        if job.reason is Reason.POSITION_KNOWN and station in (None, desk.station(job.machine)):
            words = f"{why}, so the place of the pen is no longer known ({job.on_paper})"
            _step(desk, job.id, State.INTERRUPTED, Reason.POSITION_UNKNOWN, words)


def _step(desk: Desk, job_id: str, state: State, reason: Reason, words: str) -> None:
    """A full disk keeps nobody from going on: a start takes every place for forgotten, and the promises for true."""
    try:
        desk.step(job_id, state, words, reason=reason)
    except DiskTrouble as error:
        desk.trouble(str(error), job=job_id)


def _what(event: Stand, station: Station, pen: str) -> tuple[State, Reason, str]:
    match event:
        case Paused(change=True, also=also):
            words = f"put the {pen or 'next'} pen in, {f'{also}, ' if also else ''}then {station.command('resume')}"
            return State.PAUSED, Reason.PEN_CHANGE, words
        case Paused(stroke=stroke):
            where = "" if stroke is None else f" before stroke {stroke}"
            words = _PAUSED.format(where=where, resume=station.command("resume"), stop=station.command("stop"))
            return State.PAUSED, Reason.PERSON, words
        case Waiting(why=why, cause=cause):
            return State.PAUSED, _CAUSES[cause], why
        case Resumed():
            return State.DRAWING, Reason.NONE, _GOES_ON
