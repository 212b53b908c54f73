"""What a status report means in each state."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Literal

from firmware_protocol.grbl import sentences
from firmware_protocol.grbl.habits import ASK, HOLD, HOLD_WITHIN_S, RESET, STANDS
from firmware_protocol.grbl.replies import StatusReport
from firmware_protocol.grbl.states import RUNNING, Signal, State
from firmware_protocol.session import Finding, Found, Resumed, Status, Waiting

if TYPE_CHECKING:
    from firmware_protocol.grbl.conversation import Conversation

ASTRAY_REPORTS = 2
"""The chip may read a place while it changes, and a report be changed on its way: a second one is asked for at once."""

_WAITS = {"Hold": {"Hold:0"}, "Door": {"Door:0", "Door:1"}, "Sleep": {"Sleep"}}
"""States in which the machine goes on only when a person does something."""
_CAUSES: dict[str, Literal["hold", "door", "sleep"]] = {"Hold": "hold", "Door": "door", "Sleep": "sleep"}


def heard_report(talk: Conversation, report: StatusReport) -> None:
    """Take a status report."""
    idle = report.state == "Idle" or (report.state == "Check" and talk.state is State.TRYING)
    talk.watch.reported(talk.now, idle_but_owing=idle and talk.flow.owed > 0)
    talk.feed.reported(report.feed_percent)
    place_mm = talk.controller.place_mm
    if place_mm is not None:
        talk.events.append(Status(report.word, place_mm))
    if talk.state in {State.WAITING, State.GREETED}:
        talk.heard = report.word
    if talk.state in RUNNING:
        _follow(talk, report)
    _ON_REPORT.get(talk.state, _alarmed_or_not)(talk, report)


def _follow(talk: Conversation, report: StatusReport) -> None:
    """Does the pen go where the lines lead it, or wait for somebody?"""
    waits = report.state if report.word in _WAITS.get(report.state, ()) else ""
    if waits and waits != talk.waits_for:
        talk.events.append(Waiting(sentences.WAITING[waits], _CAUSES[waits]))
    if talk.waits_for and not waits:
        talk.events.append(Resumed())
    talk.waits_for = waits
    if talk.job is None or talk.flow is not talk.job.leg.flow or talk.flow.homing:
        return
    talk.job.leg.executing(report.line_number)
    if report.free_blocks == 0 and report.free_bytes is not None:
        talk.flow.prove(talk.controller.buffer_bytes - report.free_bytes)
    place_mm = talk.controller.place_mm
    if place_mm is None or report.state not in {"Run", "Idle"} or talk.job.leg.on_path(place_mm):
        if talk.astray and talk.off_mm is not None:
            talk.events.append(Found(Finding("path", sentences.glimpsed(talk.off_mm))))
        talk.astray = 0
        return
    talk.astray, talk.off_mm = talk.astray + 1, place_mm
    if talk.astray >= ASTRAY_REPORTS:
        _go_astray(talk)
    else:
        talk.urgent += ASK


def _go_astray(talk: Conversation) -> None:
    assert talk.job is not None
    assert talk.controller.place_mm is not None
    talk.job.leg.doubt_path()
    number, text = talk.job.named(min(talk.flow.answered, talk.flow.sent - 1))
    talk.go(Signal.ASTRAY, sentences.astray(talk.controller.place_mm, number, text))


def _found(talk: Conversation, report: StatusReport) -> None:
    talk.found = True
    if report.word in STANDS or report.state in {"Idle", "Alarm"}:
        talk.urgent += RESET


def _greeted(talk: Conversation, report: StatusReport) -> None:
    if report.state in {"Idle", "Alarm"}:
        talk.go(Signal.STILL)


def _settled(talk: Conversation, report: StatusReport) -> None:
    _alarmed_or_not(talk, report)
    if report.state != "Idle" or talk.state is not State.SETTLING or talk.job is None:
        return
    place_mm = talk.controller.place_mm
    if place_mm is not None and not talk.job.leg.at_end(place_mm):
        talk.elsewhere += 1
        if talk.elsewhere >= ASTRAY_REPORTS:
            _go_astray(talk)
        else:
            talk.urgent += ASK
    elif not (talk.job.pausing or talk.job.leg.changes):
        talk.go(Signal.STILL)
    elif paused := talk.job.stands():
        talk.events.append(paused)
        talk.go(Signal.STANDS)


def _asked(talk: Conversation, report: StatusReport) -> None:
    _alarmed_or_not(talk, report)
    if report.state == "Idle":
        talk.go(Signal.STILL)


def _held(talk: Conversation, report: StatusReport) -> None:
    _alarmed_or_not(talk, report)
    deaf = talk.now >= talk.since + HOLD_WITHIN_S and report.state != "Hold"
    if report.word in STANDS or deaf:
        if talk.job is not None and talk.state is State.HOLDING:
            talk.job.leg.hold_at(talk.controller.place_mm, report.line_number)
        talk.go(Signal.HELD)
    elif report.state in {"Idle", "Run"}:
        # Made before the hold arrived, or the hold was lost on the way: a second one does no harm.
        talk.urgent += HOLD


def _alarmed_or_not(talk: Conversation, report: StatusReport) -> None:
    if report.state == "Alarm":
        talk.go(Signal.ALARM, sentences.ALARMED)


_ON_REPORT: dict[State, Callable[[Conversation, StatusReport], None]] = {
    State.WAITING: _found,
    State.GREETED: _greeted,
    # A report that was asked for before `$H` may still say Alarm.
    State.HOMING: lambda talk, report: None,
    State.SETTLING: _settled,
    State.HOLDING: _held,
    State.RESTARTED: _held,
    State.ASKING: _asked,
    State.LOCATING: _asked,
}
