"""What follows from what a GRBL controller says, and what is to be said next: the states at work."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from firmware_protocol.errors import LocalProtocolError
from firmware_protocol.grbl import codes, sentences
from firmware_protocol.grbl.controller import Controller
from firmware_protocol.grbl.flow import BARRIER, Flow
from firmware_protocol.grbl.job import Job
from firmware_protocol.grbl.replies import Alarm, Banner, Error, Ok, Reply, StatusReport, Unknown
from firmware_protocol.grbl.states import POLLED, TRANSITIONS, Signal, State
from firmware_protocol.grbl.watch import Watch
from firmware_protocol.session import Accepted, Event, JobLine, NotReady, Ready, Status, Verdict

RESET, HOLD = b"\x18", b"!"

POLL_S = {State.READY: 1.0, State.HOLDING: 0.1, State.RESTARTED: 0.1}
"""Seconds between two `?` where it is not GRBL's own advice of 0.2: a hold is watched closer, the pen is down."""
USUAL_POLL_S = 0.2

STANDS = frozenset({"Hold:0", "Door:0", "Door:1", "Check", "Sleep"})
"""States besides Idle and Alarm in which nothing moves, so that a reset loses no step."""

HOLD_WITHIN_S = 3.0
"""A controller that still runs this long after a feed hold does not hear it and is reset in motion."""

MOVING = 8
"""The error of a `$` command that came while the machine moved."""

_VERDICTS = {
    Signal.STOP: Verdict.STOPPED,
    Signal.ABORT: Verdict.STOPPED,
    Signal.REFUSED: Verdict.REJECTED,
    Signal.STUCK: Verdict.SILENT,
    Signal.SILENCE: Verdict.SILENT,
    Signal.ALARM: Verdict.ALARM,
    Signal.BANNER: Verdict.RESTARTED,
    Signal.UNPLUG: Verdict.UNPLUGGED,
}


@dataclass(frozen=True, slots=True)
class Habits:
    """How a session treats its controller; see `GrblSession`."""

    counting: bool
    lift: tuple[str, ...]
    lift_after_restart: bool
    home: bool


@dataclass(frozen=True, slots=True)
class Cause:
    """Why a state was entered."""

    signal: Signal
    why: str
    position_known: bool


class Conversation:
    """Takes replies and signals, changes its state as `TRANSITIONS` says, and collects events and urgent bytes."""

    def __init__(self, habits: Habits, watch: Watch, *, now: float) -> None:
        self.state = State.WAITING
        self.since = self.now = now
        """When the state began, and the time of the last call."""
        self.controller = Controller()
        self.flow = Flow((), room_bytes=None)
        """The lines that are being sent or answered now: questions, a job, a lift."""
        self.events: list[Event] = []
        self.urgent = b""
        """Real-time characters to be written before anything else."""
        self.found = False
        """A report came before any banner, so opening the port did not reset this controller."""
        self._heard = ""
        self._habits = habits
        self._watch = watch
        self._job: Job | None = None

    def begin(self, lines: Sequence[JobLine]) -> None:
        """Start a job. Raises LocalProtocolError when none may start or a line cannot be taken."""
        if self.state is not State.READY:
            raise LocalProtocolError(f"the controller takes no job now ({self.state.value}): wait for Ready")
        lift, room = self._habits.lift, self.controller.buffer_bytes
        self._job = Job(lines, lift=lift, buffer_bytes=room, counting=self._habits.counting)
        self.flow = self._job.flow
        self.go(Signal.START)

    def hear(self, reply: Reply) -> None:
        """Take what the controller said."""
        if type(reply) is Ok or type(reply) is Error:
            self._answered(reply)
            return
        self.controller.learn(reply)
        if isinstance(reply, StatusReport):
            self._reported(reply)
        elif isinstance(reply, Banner):
            if self.controller.outdated:
                self.go(Signal.OUTDATED, sentences.outdated(reply.firmware))
            self.go(Signal.BANNER, sentences.RESTARTED)
        elif isinstance(reply, Alarm):
            kept = reply.code in codes.POSITION_KEPT
            self.go(Signal.ALARM, sentences.alarmed(reply.code), position_known=kept)
        elif isinstance(reply, Unknown):
            self._heard = reply.text

    def go(self, signal: Signal, why: str = "", *, position_known: bool = False) -> None:
        """Change the state as the table says and do what the new state begins with."""
        after = TRANSITIONS.get((self.state, signal))
        if after is None:
            return
        self.state, self.since = after, self.now
        if after in POLLED:
            self._watch.begin(self.now, every_s=POLL_S.get(after, USUAL_POLL_S))
        if enter := _ENTER.get(after):
            enter(self, Cause(signal, why, position_known))

    def too_late(self, limit_s: float) -> None:
        """The state has lasted longer than it may."""
        self.go(Signal.SILENCE, sentences.late(self.state, limit_s, found=self.found, heard=self._heard))

    def _answered(self, reply: Ok | Error) -> None:
        homing = self.flow.homing
        line = self.flow.answer()
        if line is None:
            return
        self._watch.answered()
        if homing:
            self._watch.begin(self.now, every_s=USUAL_POLL_S)
        if isinstance(reply, Error):
            self._refused(line, reply.code)
        elif self._job is not None and self.flow is self._job.flow and line < len(self._job):
            self.events.append(Accepted(line))
        if self.flow.done:
            self._complete()

    def _complete(self) -> None:
        """All questions or lines are answered. A work offset is refused: the reach was checked without one."""
        if self.state is not State.READING:
            return self.go(Signal.COMPLETE)
        if self.controller.displaced_mm != (0.0, 0.0):
            return self.go(Signal.DISPLACED, sentences.displaced(self.controller.displaced_mm))
        if self._habits.home:
            return self.go(Signal.HOME)
        return self.go(Signal.LOCKED if self.controller.locked else Signal.COMPLETE)

    def _refused(self, line: int, code: int) -> None:
        if self.state is State.HOMING:
            self.go(Signal.REFUSED, sentences.refused_by_homing(code))
        elif self.state is not State.READING or code == MOVING:
            # A clone that knows no `$I` is taken as it is; one that still moves is asked again later.
            self.go(Signal.REFUSED, sentences.rejected(line + 1, self.flow.text(line), code))

    def _reported(self, report: StatusReport) -> None:
        self._watch.reported(self.now, idle_but_owing=report.state == "Idle" and self.flow.owed > 0)
        position_mm = self.controller.position_mm(report)
        if position_mm is not None:
            self.events.append(Status(report.word, position_mm))
        if self.state in {State.WAITING, State.GREETED}:
            self._heard = report.word
        _ON_REPORT.get(self.state, Conversation._alarmed_or_not)(self, report)

    def _found(self, report: StatusReport) -> None:
        self.found = True
        if report.word in STANDS or report.state in {"Idle", "Alarm"}:
            self.urgent += RESET

    def _greeted(self, report: StatusReport) -> None:
        if report.state in {"Idle", "Alarm"}:
            self.go(Signal.STILL)

    def _settled(self, report: StatusReport) -> None:
        self._alarmed_or_not(report)
        if report.state == "Idle":
            self.go(Signal.STILL)

    def _held(self, report: StatusReport) -> None:
        self._alarmed_or_not(report)
        deaf = self.now >= self.since + HOLD_WITHIN_S and report.state != "Hold"
        if report.word in STANDS or deaf:
            self.go(Signal.HELD)
        elif report.state in {"Idle", "Run"}:
            # Made before the hold arrived, or the hold was lost on the way: a second one does no harm.
            self.urgent += HOLD

    def _alarmed_or_not(self, report: StatusReport) -> None:
        if report.state == "Alarm":
            self.go(Signal.ALARM, sentences.ALARMED)

    def _enter_reading(self, _: Cause) -> None:
        self.flow = Flow(("$I", "$$"), room_bytes=None)

    def _enter_homing(self, _: Cause) -> None:
        self.flow = Flow(("$H",), room_bytes=None)

    def _enter_ready(self, _: Cause) -> None:
        if self._job is None:
            self.events.append(Ready(self.controller.firmware or "", self.controller.buffer_bytes))
        else:
            self._end_job(self._job, lifted=bool(self._habits.lift))

    def _enter_holding(self, cause: Cause) -> None:
        self.urgent += HOLD
        self._doom(cause, position_known=True)

    def _enter_resetting(self, _: Cause) -> None:
        self.urgent += RESET
        if self._job is not None:
            self._job.held = True

    def _enter_emptying(self, _: Cause) -> None:
        self.urgent += RESET

    def _enter_lifting(self, _: Cause) -> None:
        self.flow = Flow((*self._habits.lift, BARRIER), room_bytes=None)

    def _enter_restarted(self, cause: Cause) -> None:
        # What was on its way when the controller restarted would still be drawn: hold it, then a reset throws it away.
        self.urgent += HOLD
        self.flow = Flow((), room_bytes=None)
        self._doom(cause, position_known=False)

    def _enter_asking(self, _: Cause) -> None:
        if not (self._habits.lift and self._habits.lift_after_restart):
            self.go(Signal.NO_LIFT)

    def _enter_lost(self, cause: Cause) -> None:
        if cause.signal is Signal.SILENCE and self._job is not None:
            self.urgent += HOLD
        if cause.signal is Signal.ABORT:
            self.urgent += RESET
        if self._job is None:
            self.events.append(NotReady(cause.why or sentences.LOCKED))
            return
        if cause.signal not in {Signal.COMPLETE, Signal.NO_LIFT}:
            self._doom(cause, position_known=cause.position_known)
        self._end_job(self._job, lifted=cause.signal is Signal.COMPLETE)

    def _doom(self, cause: Cause, *, position_known: bool) -> None:
        if self._job is not None:
            # A lift that is refused does not change for what reason the job is over.
            lifting = cause.signal is Signal.REFUSED and self.state is State.LOST
            verdict = self._job.verdict if lifting else _VERDICTS[cause.signal]
            self._job.doom(verdict, cause.why, position_known=position_known)

    def _end_job(self, job: Job, *, lifted: bool) -> None:
        self.events.append(job.ended(planner_blocks=self.controller.planner_blocks, lifted=lifted))
        self._job = None
        self.flow = Flow((), room_bytes=None)


_ON_REPORT: dict[State, Callable[[Conversation, StatusReport], None]] = {
    State.WAITING: Conversation._found,
    State.GREETED: Conversation._greeted,
    # A report that was asked for before `$H` may still say Alarm.
    State.HOMING: lambda conversation, report: None,
    State.SETTLING: Conversation._settled,
    State.HOLDING: Conversation._held,
    State.RESTARTED: Conversation._held,
    State.ASKING: Conversation._settled,
}
_ENTER: dict[State, Callable[[Conversation, Cause], None]] = {
    State.READING: Conversation._enter_reading,
    State.HOMING: Conversation._enter_homing,
    State.READY: Conversation._enter_ready,
    State.HOLDING: Conversation._enter_holding,
    State.RESETTING: Conversation._enter_resetting,
    State.LIFTING: Conversation._enter_lifting,
    State.RESTARTED: Conversation._enter_restarted,
    State.EMPTYING: Conversation._enter_emptying,
    State.ASKING: Conversation._enter_asking,
    State.RELIFTING: Conversation._enter_lifting,
    State.LOST: Conversation._enter_lost,
}
