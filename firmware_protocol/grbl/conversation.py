"""The states at work: what a reply or a wish leads to, as the table says."""

from __future__ import annotations

from collections.abc import Sequence

from firmware_protocol.errors import LocalProtocolError
from firmware_protocol.grbl import codes, sentences
from firmware_protocol.grbl.controller import Controller
from firmware_protocol.grbl.entries import ENTER, Cause, end_job
from firmware_protocol.grbl.feed import USUAL_PERCENT, FeedOverride
from firmware_protocol.grbl.flow import Flow
from firmware_protocol.grbl.habits import GO_ON, POLL_S, USUAL_POLL_S, Habits
from firmware_protocol.grbl.job import Job
from firmware_protocol.grbl.preparation import Preparation
from firmware_protocol.grbl.replies import Alarm, Banner, Error, Ok, Reply, StatusReport, Triple, Unknown
from firmware_protocol.grbl.reports import heard_report
from firmware_protocol.grbl.states import POLLED, RUNNING, TRANSITIONS, Signal, State
from firmware_protocol.grbl.watch import Watch
from firmware_protocol.session import Accepted, Event, Finding, Found, JobLine, Verdict

MOVING = 8
"""The error of a `$` command that came while the machine moved."""


class Conversation:
    """Takes replies and wishes, changes its state as `TRANSITIONS` says, and collects events and urgent bytes."""

    def __init__(self, habits: Habits, watch: Watch, *, now: float) -> None:
        self.state = State.WAITING
        self.since = self.now = now
        """When the state began, and the time of the last call."""
        self.controller = Controller()
        self.feed = FeedOverride()
        self._found: Sequence[Finding] = ()
        """What was found about the job before."""
        self.flow = Flow((), room_bytes=None)
        """The lines that are being sent or answered now: questions, a job, a lift."""
        self.events: list[Event] = []
        self.urgent = b""
        """Real-time characters to be written before anything else."""
        self.found = False
        """A report came before any banner, so opening the port did not reset this controller."""
        self.heard = ""
        self.habits = habits
        self.watch = watch
        self.job: Job | None = None
        self.preparation: Preparation | None = None
        self.waits_for = ""
        """The state in which the machine waits for a person in the middle of a job."""
        self.astray = self.elsewhere = 0
        """Reports in a row that saw the pen off the path; reports that saw it rest elsewhere than at the end."""
        self.off_mm: Triple | None = None
        """Where the pen was seen off the path."""
        self.places = ""
        """The line that stores where the origin lies."""

    # -- wishes --

    def begin(self, lines: Sequence[JobLine]) -> None:
        """Start a job. Raises LocalProtocolError when none may start or a line cannot be taken."""
        if self.state is State.RESTED:
            raise LocalProtocolError(sentences.MOTORS_OFF)
        if self.state is not State.READY:
            raise LocalProtocolError(f"the controller takes no job now ({self.state.value}): wait for Ready")
        job = Job(lines, lift=self.habits.lift, controller=self.controller, counting=self.habits.counting)
        self.preparation = Preparation(self.controller, job, may_set=self.habits.may_set)
        self.job = job
        self.feed.want(USUAL_PERCENT)
        self._tell(self.preparation.left)
        if self.preparation.obstacles:
            job.doom(Verdict.REJECTED, sentences.obstacles(self.preparation.obstacles), position_known=True)
            end_job(self, job, lifted=False)
        elif self.preparation.commands:
            self.go(Signal.SET)
        else:
            self.prepared()

    def _tell(self, findings: Sequence[Finding]) -> None:
        """What the job before had already is told again only where it keeps this one from being drawn."""
        self.events += [Found(each) for each in findings if each.blocks or each not in self._found]
        self._found = tuple(findings)

    def prepared(self) -> None:
        """The settings are as they should be: try the program, or draw it."""
        self.go(Signal.TRY if self.habits.dry_run else Signal.START)

    def stop(self) -> None:
        """A person ends the job; while it is ending already this changes nothing."""
        if self.flow.homing:
            self.go(Signal.ABORT, sentences.STOPPED_HOMING)
        elif TRANSITIONS.get((self.state, Signal.STOP)):
            self.go(Signal.STOP, sentences.STOPPED)
        elif self.job and (self.job.pausing or self.state in {State.SETTING, State.LEAVING}):
            self.job.doom(Verdict.STOPPED, sentences.STOPPED, position_known=True)

    def pause(self, *, at_once: bool) -> None:
        """Raises LocalProtocolError when a pause at once is wanted and no line is known that lifts the pen."""
        if at_once and not self.habits.lift:
            raise LocalProtocolError("a pause at once needs lines that raise the pen: pause behind the stroke")
        if self.job is None or self.state not in RUNNING or self.flow.homing:
            return
        if at_once:
            self.job.pausing = True
            self.go(Signal.HALT)
        elif self.state is State.STREAMING and self.job.pause_after_stroke():
            self.go(Signal.PAUSE)

    def resume(self) -> None:
        """Raises LocalProtocolError when nothing stands still that could go on."""
        if self.state is State.PAUSED and self.job is not None:
            self.job.go_on()
            self.go(Signal.RESUME)
        elif self.state in RUNNING and self.waits_for:
            self.urgent += GO_ON
        else:
            raise LocalProtocolError(f"nothing is paused ({self.state.value}): resume after Paused or Waiting")

    def rest(self) -> None:
        """Switch the motors off; see `GrblSession`."""
        self.go(Signal.REST)

    def home(self) -> None:
        """Raises LocalProtocolError when the machine is not at rest between two jobs."""
        self._only_between_jobs("home")
        self.go(Signal.HOME)

    def place(self) -> None:
        """Raises LocalProtocolError when the machine is not at rest between two jobs."""
        self._only_between_jobs("set the origin")
        self.places = "G10 L20 P1 X0 Y0"
        self.go(Signal.PLACE)

    def _only_between_jobs(self, what: str) -> None:
        if self.state not in {State.READY, State.RESTED}:
            raise LocalProtocolError(f"the machine cannot {what} now ({self.state.value}): wait until it is idle")

    # -- replies --

    def hear(self, reply: Reply) -> None:
        """Take what the controller said."""
        if type(reply) is Ok or type(reply) is Error:
            self._answered(reply)
            return
        self.controller.learn(reply)
        if isinstance(reply, StatusReport):
            heard_report(self, reply)
        elif isinstance(reply, Banner):
            self._started(reply)
        elif isinstance(reply, Alarm):
            kept = reply.code in codes.POSITION_KEPT
            self.go(Signal.ALARM, sentences.alarmed(reply.code), position_known=kept)
        elif isinstance(reply, Unknown):
            self.heard = reply.text

    def go(self, signal: Signal, why: str = "", *, position_known: bool = False) -> None:
        """Change the state as the table says and do what the new state begins with."""
        after = TRANSITIONS.get((self.state, signal))
        if after is None:
            return
        before, self.state, self.since = self.state, after, self.now
        if after in POLLED:
            self.watch.begin(self.now, every_s=POLL_S.get(after, USUAL_POLL_S))
        if enter := ENTER.get(after):
            enter(self, Cause(signal, why, position_known, before))

    def too_late(self, limit_s: float) -> None:
        """The state, or homing in the middle of a job, has lasted longer than it may."""
        state = State.HOMING if self.flow.homing else self.state
        self.go(Signal.SILENCE, sentences.late(state, limit_s, found=self.found, heard=self.heard))

    def named(self, line: int) -> tuple[int, str]:
        """The number (from 1) and the text of a line of the present flow, as whoever gave the job knows it."""
        if self.job is not None and self.flow is self.job.leg.flow:
            return self.job.named(line)
        if self.state is State.TRYING and self.preparation is not None:
            return self.preparation.tried(line)
        return line + 1, self.flow.text(line)

    def _started(self, banner: Banner) -> None:
        self.feed.restarted()
        if self.controller.outdated:
            self.go(Signal.OUTDATED, sentences.outdated(banner.firmware))
        if self.state is State.LEAVING and self.flow.done and self.job is not None:
            self.go(Signal.START if self.job.verdict is Verdict.FINISHED else Signal.QUIT)
        else:
            self.go(Signal.BANNER, sentences.RESTARTED)

    def _answered(self, reply: Ok | Error) -> None:
        homing = self.flow.homing
        line = self.flow.answer()
        if line is None:
            return self._torn()
        self.watch.answered()
        if homing:
            self.watch.begin(self.now, every_s=USUAL_POLL_S)
        if isinstance(reply, Error):
            self._refused(line, reply.code)
        elif self.job is not None and self.flow is self.job.leg.flow:
            number = self.job.accepted(line)
            self.events += [] if number is None else [Accepted(number)]
        if self.flow.done:
            self._complete()

    def _torn(self) -> None:
        """An answer that nobody owes. The line that was torn may have been any, as one answer has been ahead since."""
        if self.job is not None and self.flow is self.job.leg.flow and self.state in RUNNING:
            self.job.leg.doubt_from(0)
            self.go(Signal.TORN, sentences.TORN)

    def _refused(self, line: int, code: int) -> None:
        why = sentences.rejected(*self.named(line), code)
        if self.job is not None and self.flow is self.job.leg.flow:
            self.job.leg.doubt_from(line)
            if self.job.pausing:
                self.job.doom(Verdict.REJECTED, why, position_known=True)
        if self.state is State.HOMING:
            self.go(Signal.REFUSED, sentences.refused_by_homing(code))
        elif self.state is not State.READING or code == MOVING:
            # A clone that knows no `$I` is taken as it is; one that still moves is asked again later.
            self.go(Signal.REFUSED, why)

    def _complete(self) -> None:
        """All lines of the flow are answered."""
        if self.state is State.READING:
            self._read()
        elif self.state is State.SETTING and self.preparation is not None:
            self._set(self.preparation)
        elif self.state is State.LIFTING and self.job is not None and self.job.pausing:
            self._stands(self.job)
        else:
            self.go(Signal.COMPLETE)

    def _read(self) -> None:
        """A work offset on a machine without a home is from another day, when zero lay elsewhere."""
        offset_mm = self.controller.offset_mm[:2]
        stale = not self.controller.homes and offset_mm != (0.0, 0.0)
        if stale and self.habits.may_set and not self.controller.locked:
            self.places = "G10 L2 P1 X0 Y0"
            return self.go(Signal.PLACE)
        if stale:
            return self.go(Signal.DISPLACED, sentences.displaced(offset_mm))
        if self.habits.home:
            return self.go(Signal.HOME)
        return self.go(Signal.LOCKED if self.controller.locked else Signal.COMPLETE)

    def _set(self, preparation: Preparation) -> None:
        """The settings are written and read back."""
        job = self.job
        assert job is not None
        self.events += preparation.mended()
        if preparation.obstacles:
            why = sentences.obstacles(preparation.obstacles)
            return self.go(Signal.REFUSED, f"the controller did not keep what it was told: {why}")
        if job.verdict is not Verdict.FINISHED:
            return self.go(Signal.QUIT)
        return self.prepared()

    def _stands(self, job: Job) -> None:
        paused = job.stands()
        if paused is not None:
            self.events.append(paused)
            return self.go(Signal.STANDS)
        job.doom(Verdict.STOPPED, sentences.CUT_UNKNOWN, position_known=True)
        return self.go(Signal.COMPLETE)
