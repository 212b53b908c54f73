"""The states at work: what each begins with, and how a job ends."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from firmware_protocol.emco import sentences
from firmware_protocol.emco.job import Job, Times, check_plain
from firmware_protocol.emco.states import STOPPING, TRANSITIONS, Signal, State
from firmware_protocol.errors import LocalProtocolError
from firmware_protocol.session import Ended, Event, JobLine, NotReady, Paused, Ready, Resumed, Sent, Verdict, Waiting

SETTLE_S = 5.0
"""Beside the time model: for the way to the first place, which begins nobody knows where, and for lifting the pen."""
STOP_WITHIN_S = 25.0
"""A stop that has not come to its end after this long is reported as it is; the link waits 30 s."""

_DRAWS = {State.DRAWING, State.CHANGING, State.SETTLING}
"""Here the control draws what it has."""
_STANDS = {State.DRAWING, State.CHANGING, State.PAUSED}
"""Here it reads nothing that could end its program."""

_VERDICTS = {
    Signal.TIME: Verdict.FINISHED,
    Signal.STOP: Verdict.STOPPED,
    Signal.ABORT: Verdict.STOPPED,
    Signal.LATE: Verdict.SILENT,
    Signal.REFUSED: Verdict.REJECTED,
    Signal.UNPLUG: Verdict.UNPLUGGED,
}


@dataclass(frozen=True, slots=True)
class Control:
    """What the owner of a control knows of it, beside the link that it is set up for.

    on_stop: lines that raise the pen and end the program; without them a stop only ends the sending. line_end: end of
    block. holds_bytes, holds_blocks: what it can hold at most without having drawn it (its buffer, and the blocks that
    it reads ahead), on a plain line and of acknowledged blocks. Where they are known, and the control draws while it
    reads, strokes before that are certainly drawn, and a control that takes more on a plain line is known to be deaf.
    """

    on_stop: tuple[str, ...] = ()
    line_end: bytes = b"\n"
    holds_bytes: int | None = None
    holds_blocks: int | None = None


UNKNOWN = Control()


class Conversation:
    """Takes signals, changes its state as `TRANSITIONS` says, and collects events."""

    def __init__(self, control: Control, *, now: float, times: Times, name: str) -> None:
        check_plain(control.on_stop)
        self.state = State.READY
        self.since = self.now = now
        """When the state began, and the time of the last call."""
        self.events: list[Event] = [Ready(name, 0)]
        self.job: Job | None = None
        self.stop_until = float("inf")
        self.drawn_at = float("inf")
        """When the last ink will be on the sheet, by the time model and `SETTLE_S`."""
        self._times, self.control = times, control

    def begin(self, lines: Sequence[JobLine]) -> None:
        """Start a job. Raises LocalProtocolError when none may start or a line cannot be sent."""
        if self.state is not State.READY:
            raise LocalProtocolError(f"the control takes no job now ({self.state.value}): wait, or open the port again")
        self.job = Job(lines, times=self._times, line_end=self.control.line_end)
        self.go(Signal.START)

    def stop(self) -> None:
        """End the program for the control where that is possible, else only the sending."""
        # A control that has read nothing yet would take the lines of the end for another program.
        closes = bool(self.control.on_stop) and self.job is not None and self.job.begun > 0
        self.go(Signal.STOP if closes and self.state not in _STANDS else Signal.ABORT)

    def resume(self) -> None:
        """Raises LocalProtocolError where no pen is being changed."""
        if self.state is not State.PAUSED or self.job is None:
            raise LocalProtocolError(f"nothing is paused ({self.state.value}): resume after a pen change")
        self.job.go_on()
        self.events.append(Resumed())
        self.go(Signal.RESUME)

    def go(self, signal: Signal, why: str = "") -> None:
        """Change the state as the table says and do what the new state begins with."""
        after = TRANSITIONS.get((self.state, signal))
        if after is None:
            return
        before, self.state, self.since = self.state, after, self.now
        if signal is Signal.STOP and after in STOPPING and self.job is not None:
            self.job.close(self.control.on_stop)
            self.stop_until = self.now + STOP_WITHIN_S
        elif signal in {Signal.EMPTY, Signal.CHANGE} and self.job is not None:
            self.drawn_at = max(self.job.drawn_at, self.now) + SETTLE_S
            if after is State.DRAWING:
                self.events.append(Sent(self.drawn_at - self.now))
        elif after is State.PAUSED and self.job is not None:
            self.events.append(Paused(self.job.next_stroke, change=True, also=sentences.THEN_START))
        elif after in {State.READY, State.LOST}:
            self._end(before, signal, why)

    def wait_for_a_person(self) -> None:
        self.events.append(Waiting(sentences.PRESS_START))

    def expire(self, now: float) -> None:
        """What follows from the time model, and from a stop that takes too long."""
        self.now = now
        if self.state in _DRAWS and now >= self.drawn_at:
            self.go(Signal.TIME)
        elif self.state in STOPPING and now >= self.stop_until:
            self.go(Signal.LATE)

    def deadline(self) -> list[float]:
        """When `expire` wants to be called again."""
        if self.events:
            return [self.now]
        times = [self.drawn_at] if self.state in _DRAWS else []
        return [*times, self.stop_until] if self.state in STOPPING else times

    def told(self) -> list[Event]:
        """Everything that has happened since the last call."""
        events, self.events = self.events, []
        return events

    def _end(self, before: State, signal: Signal, why: str) -> None:
        job, self.job = self.job, None
        if job is None:
            self.events.append(NotReady(why))
            return
        self.events.append(_ended(job, before, signal, why))


def _ended(job: Job, before: State, signal: Signal, why: str) -> Ended:
    if before is State.WAITING and signal is not Signal.UNPLUG:
        return job.untouched(sentences.NOT_BEGUN)
    if signal is Signal.TIME and before is State.DRAWING:
        return job.ended(Verdict.FINISHED, sentences.FINISHED, estimated=True)
    if signal is Signal.TIME:
        return job.ended(Verdict.STOPPED, sentences.STOPPED, estimated=True)
    if before in STOPPING and signal is not Signal.UNPLUG:
        return job.ended(Verdict.STOPPED, sentences.NOT_LIFTED)
    return job.ended(_VERDICTS[signal], why or sentences.ABORTED)
