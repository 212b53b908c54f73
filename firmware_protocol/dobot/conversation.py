"""What follows from what an arm replies and from time: the states at work."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from firmware_protocol.dobot import scripts, sentences
from firmware_protocol.dobot.commands import command
from firmware_protocol.dobot.count import Count
from firmware_protocol.dobot.exchange import Ask, Exchange, acknowledged
from firmware_protocol.dobot.job import Job
from firmware_protocol.dobot.kinematics import Flat
from firmware_protocol.dobot.packet import Packet
from firmware_protocol.dobot.queue import Queue
from firmware_protocol.dobot.states import TRANSITIONS, Signal, State
from firmware_protocol.dobot.steps import Script, Turn, Wait
from firmware_protocol.errors import LocalProtocolError
from firmware_protocol.ink import Vector
from firmware_protocol.session import Event, JobLine, NotReady, Paused, Ready, Resumed, Verdict

STOP_NOW = b"".join(command(name).packet(queued=False).encode() for name in ("ForceStopExec", "Clear"))
"""Said to an arm that no longer answers, in case it still hears."""
CP_BYTES = 23
_STILL_MM = 1e-3

_VERDICTS = {
    Signal.STOP: Verdict.STOPPED,
    Signal.REFUSED: Verdict.REJECTED,
    Signal.DOUBT: Verdict.SILENT,
    Signal.STUCK: Verdict.SILENT,
    Signal.SILENCE: Verdict.SILENT,
    Signal.ALARM: Verdict.ALARM,
    Signal.RESTARTED: Verdict.RESTARTED,
    Signal.UNPLUG: Verdict.UNPLUGGED,
}


@dataclass(frozen=True, slots=True)
class Habits:
    """How a session treats its arm; see `DobotSession`."""

    home: bool
    up_mm: float
    silent_after_s: float
    answer_within_s: float
    home_within_s: float
    stands_s: float
    sheet_origin_mm: Flat


class Conversation:
    """Takes packets, signals and time; collects events; `exchange` holds what is to be said."""

    def __init__(self, habits: Habits, *, now: float) -> None:
        self.habits = habits
        self.state = State.INTRODUCING
        self.now = now
        self.events: list[Event] = []
        self.parting = b""
        """The last words, to be sent without waiting for a reply."""
        self.exchange = Exchange(answer_within_s=habits.answer_within_s, silent_after_s=habits.silent_after_s)
        self.firmware = ""
        self.noise = False
        """Bytes came, whatever they are."""
        self.queue = Queue(0, before=0, stale=True)
        self.count = Count()
        self.cut: Vector | None = None
        """Where a stroke was cut by a pause, until it is taken up again."""
        self.lifted = self.position_known = False
        self.first_line: int | None = None
        """Line of the job minus its number in the queue; None while the queue holds no lines."""
        self.next_poll = self.next_look = now
        self._moved_at, self._place, self._executed = now, (0.0, 0.0, 0.0), 0
        self._job: Job | None = None
        self._wait_until: float | None = None
        self._script: Script | None = None
        self._enter(Turn(Signal.COMPLETE))

    @property
    def job(self) -> Job:
        """The job that runs."""
        if self._job is None:
            raise LocalProtocolError("there is no job: start one")
        return self._job

    @property
    def on_paper(self) -> tuple[int, int]:
        """Strokes of the running job that are certainly drawn, and the number from which on none was begun."""
        return (0, 0) if self._job is None else (self._job.certain, self._job.touched)

    # -- what the world does --

    def begin(self, lines: Sequence[JobLine]) -> None:
        """Start a job. Raises LocalProtocolError when none may start or a line cannot be taken."""
        if self.state is not State.READY:
            raise LocalProtocolError(f"the arm takes no job now ({self.state.value}): wait for Ready")
        self._job = Job(lines)
        self.go(Turn(Signal.START))

    def hear(self, packet: Packet) -> None:
        """Take a packet from the arm."""
        exchange = self.exchange
        values = exchange.hear(packet, self.now)
        if values is not None:
            self._resume(values)
        elif (index := acknowledged(packet)) is not None:
            is_new = self.count.hears(packet.id, index)
            if is_new and exchange.awaits_put:
                exchange.begin(None, self.now)
                self._resume(None)

    def pass_time(self) -> None:
        """The time `now` has come."""
        exchange = self.exchange
        if exchange.silent(self.now):
            self.go(Turn(Signal.SILENCE, self._silence(), position_known=False))
        elif exchange.overdue(self.now):
            if isinstance(exchange.pending, Ask):
                exchange.again()
            else:
                exchange.begin(None, self.now)
                self._resume(None)
        elif self._wait_until is not None and self.now >= self._wait_until:
            self._resume(None)

    def deadline(self) -> float | None:
        """When `pass_time` wants to be called again."""
        if self.events or self.parting:
            return self.now
        times = [at for at in (self.exchange.deadline(self.now), self._wait_until) if at is not None]
        return min(times, default=None)

    def go(self, turn: Turn) -> None:
        """Change the state as the table says and begin what is said in the new one."""
        after = TRANSITIONS.get((self.state, turn.signal))
        if after is not None:
            self.state = after
            self._enter(turn)

    # -- what scripts tell --

    def renew_queue(self, *, before: int, depth: int | None = None, cleared: bool = False) -> None:
        """The queue is empty. before: what 246 says; depth: None when it is known. cleared: it was emptied just now."""
        if cleared:
            self.count = Count()
        depth = self.queue.depth if depth is None else depth
        self.queue = Queue(depth, before=before, stale=self.count.last is None)
        self.first_line = None

    def read_index(self, said: int) -> None:
        """Take what 246 says. Raises Turn when it has gone back."""
        if not self.queue.read(said) and self.exchange.sure:
            raise Turn(Signal.RESTARTED, sentences.RESTARTED, position_known=False)
        if self.queue.executed != self._executed:
            self._executed, self._moved_at = self.queue.executed, self.now
        if self._job is not None and self.first_line is not None:
            self._job.executes(self.queue.executed + self.first_line)

    def lines_executed(self, said: int) -> int | None:
        """How many lines are executed when 246 says that; None while the queue holds no lines."""
        first = self.first_line
        self.queue.read(said)
        return None if first is None else max(0, self.queue.executed + first)

    def seen_at(self, place: Vector) -> None:
        """Where the tool is."""
        if any(abs(a - b) > _STILL_MM for a, b in zip(place, self._place, strict=True)):
            self._place, self._moved_at = place, self.now

    def on_sheet(self, place: Vector) -> Vector:
        """In the coordinates of the sheet."""
        return place[0] - self.habits.sheet_origin_mm[0], place[1] - self.habits.sheet_origin_mm[1], place[2]

    def progressed(self) -> None:
        """Something begins that takes its time."""
        self._moved_at = self.next_poll = self.next_look = self.now

    def check_progress(self) -> None:
        """Raises Turn when the arm has stood still for too long although commands wait."""
        limit_s = self._patience_s()
        if not self.queue.ahead or self.now < self._moved_at + limit_s:
            return
        if self.state is State.HOMING:
            raise Turn(Signal.STUCK, sentences.not_home(limit_s))
        if self.state is not State.DRAWING:
            raise Turn(Signal.STUCK, sentences.not_lifted(limit_s))
        raise Turn(Signal.STUCK, sentences.stuck(limit_s, self.job.executed + 1))

    def _patience_s(self) -> float:
        """How long the arm may stand still: while it homes, and in the waits that a job asks for."""
        if self.state is State.HOMING:
            return self.habits.home_within_s
        job = self._job
        if self.state is State.DRAWING and job is not None and self.first_line is not None and job.executed < len(job):
            running = job.commands[job.executed]
            if running.kind.name == "HOME":
                return self.habits.home_within_s
            if running.kind.name == "WAIT":
                return self.habits.stands_s + float(running.values[0]) / 1000
        return self.habits.stands_s

    # -- the states --

    def _enter(self, turn: Turn) -> None:
        self.exchange.begin(None, self.now)
        self._wait_until, self._script = None, None
        if enter := _ENTER.get(self.state):
            enter(self, turn)
        if script := _SCRIPTS.get(self.state):
            self._script = script(self)
            self._resume(None)

    def _resume(self, reply: object) -> None:
        """Go on with the script of the state until it wants something of the world."""
        script = self._script
        self._wait_until = None
        if script is None:
            return
        try:
            request = script.send(reply)
        except Turn as turn:
            self.go(turn)
        else:
            if isinstance(request, Wait):
                self._wait_until = request.until
            else:
                self.exchange.begin(request, self.now)

    def _enter_ready(self, _: Turn) -> None:
        if self._job is None:
            self.events.append(Ready(self.firmware, self.queue.depth * CP_BYTES))
        else:
            self._end_job()

    def _enter_drawing(self, turn: Turn) -> None:
        self.job.stop_at_pen_change()
        self.events += [Resumed()] * (turn.signal is Signal.RESUME)

    def _enter_paused(self, _: Turn) -> None:
        cut = None if self.cut is None else self.on_sheet(self.cut)[:2]
        self.events.append(Paused(self.job.stroke(self.job.taken), cut, self.job.changes))

    def _enter_aborting(self, turn: Turn) -> None:
        self.cut = None
        self._doom(turn)

    def _enter_lost(self, turn: Turn) -> None:
        self.exchange.forget()
        if turn.signal is Signal.SILENCE:
            self.parting = STOP_NOW
        if self._job is None:
            self.events.append(NotReady(turn.why))
            return
        if turn.signal is not Signal.OVER:
            self.lifted = False
            self._doom(turn)
        self._end_job()

    def _doom(self, turn: Turn) -> None:
        self.position_known = turn.position_known
        self.job.doom(_VERDICTS[turn.signal], turn.why, position_known=turn.position_known)

    def _end_job(self) -> None:
        self.events.append(self.job.ended(lifted=self.lifted))
        self._job, self.first_line = None, None

    def _silence(self) -> str:
        seconds = self.habits.silent_after_s
        return sentences.silent(seconds) if self.firmware else sentences.nobody(seconds, noise=self.noise)


_ENTER: dict[State, Callable[[Conversation, Turn], None]] = {
    State.READY: Conversation._enter_ready,
    State.DRAWING: Conversation._enter_drawing,
    State.PAUSED: Conversation._enter_paused,
    State.ABORTING: Conversation._enter_aborting,
    State.LOST: Conversation._enter_lost,
}
_SCRIPTS: dict[State, Callable[[Conversation], Script]] = {
    State.INTRODUCING: scripts.introduce,
    State.HOMING: scripts.home,
    State.READY: scripts.rest,
    State.DRAWING: scripts.draw,
    State.HOLDING: scripts.hold,
    State.PAUSED: scripts.rest,
    State.ABORTING: scripts.abort,
}
