"""Drawing: the next planned job goes to the machine, and what became of it is recorded."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from daemon.errors import LinedrawError, MachineFault, NoMachine
from daemon.jobs.choices import not_placed, program_left
from daemon.jobs.journal import Job
from daemon.jobs.kept_ink import Reports, add_to_report, keep_ink
from daemon.jobs.moves import Moves, homing
from daemon.jobs.open_machine import InkMm, Open, OpenMachine
from daemon.jobs.orders import WITHOUT_MOTION, Asked, MachineOrder, Places, obey
from daemon.jobs.passes import Passes, with_its_pen
from daemon.jobs.progress import NOTHING_DRAWN, Progress, end_in_words, tell
from daemon.jobs.promise import Ahead
from daemon.jobs.retry import IDLE_S, retry_after_s
from daemon.jobs.standing import forget_place, stand
from daemon.jobs.states import HOW_ON, OUTCOMES, Reason, State, outcome_of
from daemon.jobs.station import Station
from daemon.shapes import Program
from firmware_protocol.session import Accepted, Ended, Event, Paused, Resumed, Verdict, Waiting

_ENDED = "linedrawd ended in the middle of a drawing: set the pen to its origin and put in a new sheet"
"""The next one opens the port anew, which makes an origin of wherever the pen stands."""

_PORT_STAYS_OPEN = {Verdict.FINISHED, Verdict.STOPPED, Verdict.REJECTED}


class Drawing:
    """One turn connects, draws one job, obeys one order for the machine, or listens to an idle one.

    load: reads a program file. reports: what the worker does for the report of a drawing.
    moves, places: what a person may have the machine do between jobs, and where that leads. `asked` takes such orders.
    """

    def __init__(
        self,
        station: Station,
        *,
        opened: Open,
        load: Callable[[Path], Program],
        reports: Reports,
        moves: Moves,
        places: Places,
        inked: Callable[[Path, int], None] = lambda folder, strokes: None,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        """inked: told the folder of a job that is over and how many of its strokes are on paper."""
        self.station, self._desk, self._opened, self._load, self._reports = station, station.desk, opened, load, reports
        self._moves, self._places, self.asked, self._inked = moves, places, Asked(self._desk.wake), inked
        self._machine: OpenMachine | None = None
        self._now, self._placed = now, False
        self._progress: Progress | None = None
        self._passes: Passes | None = None
        self._drawn = ""
        """The job that is being drawn."""
        self.missing: NoMachine | MachineFault | None = None
        """Why there is no machine to draw with; None when there is one, and before the first look."""
        self._told, self._retry_at_s = "", float("-inf")

    @property
    def placed(self) -> bool:
        """The machine knows where the sheet's origin is, or will when it has been opened."""
        return self._places.homes or (self._machine is not None and self._placed)

    def turn(self) -> float:
        """Returns the seconds to wait for a change before the next turn."""
        if self.asked.obey_next(self.obey):
            return 0.0
        if self.station.cut_off and not self._machine and self._now() >= self._retry_at_s:
            self._lift_what_was_cut_off()
        if self._machine is None and not self.station.held and self._now() >= self._retry_at_s:
            self._connect()
        if self._machine is None:
            return self._without_a_machine()
        job = None if self._rests() else self.station.begin_drawing()
        if job is None:
            self._listen()
            return IDLE_S
        self._draw(job)
        self.station.show_now()
        return 0.0

    def stop(self) -> None:
        """Break off what is being drawn, pen up. May be called from any thread."""
        machine = self._machine
        if machine:
            machine.stop()

    def look_now(self) -> None:
        """Whatever went wrong, the machine is looked for without further waiting. May be called from any thread."""
        self._retry_at_s = float("-inf")

    def drawn_on(self, instead: str = "") -> OpenMachine:
        """The machine, while it draws. May be called from any thread. Raises LinedrawError where nothing is drawn."""
        machine = self._machine
        if machine is None or self._progress is None:
            instead = instead or f"{self.station.command('stop')} keeps the next drawing from starting"
            raise LinedrawError(f"nothing is being drawn: {instead}")
        return machine

    def end(self) -> None:
        """No order is obeyed any more, and the port is given back."""
        self.asked.refuse("linedrawd is ending: start it again")
        self.close()

    def close(self) -> None:
        machine, self._machine = self._machine, None
        if machine:
            machine.close()
            forget_place(self._desk, "the machine's port was closed", self.station)

    def _connect(self) -> None:
        try:
            self._open(still=False)
        except (NoMachine, MachineFault) as error:
            self._lost(error)

    def _open(self, *, still: bool) -> None:
        self._machine, self._placed = self._opened(self._hear, still), False
        ready = self._machine.connect()
        self.missing, self._told = None, ""
        self.station.lost(missing=False)
        self.station.say("the machine is ready", port=self._machine.name, firmware=ready.firmware)
        self.station.show(port=self._machine.name, firmware=ready.firmware)
        self.station.show_now()

    def obey(self, order: MachineOrder) -> str:
        """Do it in this thread, which draws. Raises LinedrawError when it cannot be done."""
        if self.station.cut_off and not self._machine:
            self._lift_what_was_cut_off()
            if self.station.cut_off and order.name != "home":
                raise LinedrawError(f"the pen may still be down since the last drawing was cut off: {self.missing}")
        still, closed = order.name in WITHOUT_MOTION, self._machine is None
        try:
            if self._machine is not None and self._machine.rests and order.name == "origin":
                # Motors without current may have been turned by hand: a port that is opened anew begins to count here.
                self.close()
            if self._machine is None:
                self._open(still=still)
            assert self._machine is not None
            words = obey(order, self._machine, self._moves, self._places)
            placed = order.name == "origin" or (order.name == "home" and self._places.counts_from_home)
            self._placed = self._placed or placed
            self.station.cut_off = self.station.cut_off and order.name != "home"
        except (NoMachine, MachineFault) as error:
            self._lost(error)
            raise
        if closed and still:
            self._give_back()
        self.station.say(words.partition("\n")[0], order=order.name)
        return words

    def _lift_what_was_cut_off(self) -> None:
        """Whoever killed the daemon left the pen where it was: it is lifted, and nothing else moves."""
        try:
            self._open(still=True)
            assert self._machine is not None
            lifted = self._machine.lift()
        except NoMachine as error:
            # One that answers and is locked by an alarm moves only when it homes; a person has said that it may.
            self.station.cut_off = self._machine is None or bool(self.station.held)
            return self._lost(error)
        except MachineFault as error:
            self.station.trouble(f"the pen may still be down, it could not be lifted: {error}")
        else:
            words = "the pen has been lifted" if lifted else "the pen may still be down: lift it by hand"
            self.station.say(f"the last drawing was cut off: {words}, and nothing else moves", level=logging.WARNING)
        self.station.cut_off = False
        self._give_back()

    def _lost(self, error: NoMachine | MachineFault) -> None:
        self._give_back()
        self.missing = error
        self.station.lost(missing=True)
        self._retry_at_s = self._now() + retry_after_s(error)
        if str(error) != self._told:
            self._told = str(error)
            self.station.trouble(self._told)

    def _without_a_machine(self) -> float:
        if self.station.held:
            return IDLE_S
        self.station.let_wait(self._told)
        return max(0.0, self._retry_at_s - self._now())

    def _rests(self) -> bool:
        """A machine that has forgotten where its pen is while it waited takes no job before a person has told it."""
        assert self._machine is not None
        why = self._machine.rests
        if why:
            why += f" ({self.station.command('machine home')}, {self.station.command('machine origin')})"
            self.station.let_wait(why)
            forget_place(self._desk, "the motors were switched off", self.station)
        if bool(why) != self.station.missing:
            self.station.lost(missing=bool(why))
        return bool(why)

    def _listen(self) -> None:
        assert self._machine is not None
        try:
            self._machine.listen()
        except MachineFault as error:
            self._lost(error)

    def _draw(self, job: Job) -> None:
        assert self._machine is not None
        folder = self._desk.folders.path(job.id)
        try:
            # A machine that knows its place is not sent to look for it again.
            without = homing(self._moves) if self._placed else ()
            whole = self._load(folder / "program.gcode")
            left = program_left(job, folder, whole, without=without)
        except LinedrawError as error:
            self._desk.step_at_last(job.id, State.FAILED, str(error))
            return
        if job.possible and not self.placed:
            why = not_placed(self.station)
            self.station.hold(why)
            self._desk.step_at_last(job.id, State.INTERRUPTED, why, reason=Reason.POSITION_UNKNOWN)
            return
        program = with_its_pen(left, whole, pen_in=self.station.pen_in, goes_on=job.possible > 0)
        times_s = self._machine.line_times_s(program)
        self._drawn = job.id
        self._passes = Passes(self.station, job.id, program, self._machine.take_ink)
        self._progress = Progress(self.station.show, program, times_s, now=self._machine.now)
        self.station.show(state="drawing", words="", job=job.id, picture=job.name, strokes_total=program.strokes)
        begun_s = self._machine.now()
        self.asked.refuse(f"{job.name} is being drawn: wait for its end, or say {self.station.command('stop')}")
        ended = self._ended(job, program, Ahead(self._promises(job, program), program, times_s))
        self._progress, self._drawn = None, ""
        self.asked.accept()
        self._placed = ended.position_known and (self._placed or ended.strokes_possible > job.possible)
        self._record(job, program, ended, real_s=round(self._machine.now() - begun_s, 1))
        self.station.show(**NOTHING_DRAWN)

    def _promises(self, job: Job, program: Program) -> Callable[[int, int], None]:
        return lambda certain, possible: self._desk.journal.promise(
            job.id, strokes=program.strokes, certain=certain, possible=possible
        )

    def _ended(self, job: Job, program: Program, promise: Ahead) -> Ended:
        assert self._machine is not None
        if self.station.held or self._desk.ending or self._desk.is_cancelled(job.id):
            why = "a person stopped it before it began"
            return Ended(Verdict.STOPPED, job.certain, job.possible, True, True, why)
        try:
            return self._machine.draw(program, promise)
        except MachineFault as error:
            return Ended(Verdict.UNPLUGGED, job.certain, program.strokes, False, False, str(error))

    def _record(self, job: Job, program: Program, ended: Ended, *, real_s: float) -> None:
        assert self._machine is not None
        assert self._passes is not None
        port, (ink, pens), self._passes = self._machine.name, self._passes.over(ended), None
        known = ended.verdict in _PORT_STAYS_OPEN and ended.position_known
        if not known:
            self._give_back()
        self._report(job, ink, pens, real_s)
        self._inked(self._desk.folders.path(job.id), ended.strokes_certain)
        cancelled = self._desk.is_cancelled(job.id)
        goes_on_knowing, touched = known and not self._desk.ending, ended.strokes_possible > 0
        state, reason = outcome_of(ended.verdict, touched=touched, cancelled=cancelled, position_known=goes_on_knowing)
        if not self.station.held and state not in (State.CANCELLED, State.DONE):
            self.station.hold(_ENDED if self._desk.ending else ended.why)
        extent, words = (ended.strokes_certain, ended.strokes_possible), end_in_words(ended, program.strokes)
        if state is State.INTERRUPTED:
            words += f"; {OUTCOMES[ended.verdict].remedy}, then {HOW_ON.format(job=job.id)}"
        self._desk.end_drawing(job.id, state, words, extent=extent, reason=reason, real_s=real_s, port=port)

    def _give_back(self) -> None:
        self.close()
        self.station.show(port="", firmware="")

    def _report(self, job: Job, ink: InkMm | None, pens: Sequence[str], real_s: float) -> None:
        """The seconds into report.json, the ink beside it, and have it measured. A job does not fail for its report."""
        folder = self._desk.folders.path(job.id)
        try:
            self._reports.whole(folder)
            add_to_report(folder / "report.json", real_s)
            if ink is not None:
                keep_ink(folder, ink, pens, more=job.possible > 0)
            if ink is not None and not self._desk.ending:
                self._reports.measure(folder)
        except (LinedrawError, ValueError) as error:
            self._desk.trouble(f"the report is not complete: {error}", job=job.id)

    def _hear(self, event: Event) -> None:
        if self._progress:
            self._progress.hear(event)
        if self._passes:
            self._passes.hear(event)
        if isinstance(event, Paused | Resumed) or (isinstance(event, Waiting) and event.cause):
            stand(event, self._drawn, self.station, pen=self._passes.pen if self._passes else "")
        elif not isinstance(event, Accepted):
            tell(event, say=self.station.say, show=self.station.show)
