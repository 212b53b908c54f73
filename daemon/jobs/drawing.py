"""Drawing: the next planned job goes to the machine, and what became of it is recorded."""

from __future__ import annotations

import json
import time
from bisect import bisect_right
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Protocol, TypeAlias

from daemon.errors import LinedrawError, MachineFault, NoMachine
from daemon.jobs.desk import Desk
from daemon.jobs.folder import write_durably
from daemon.jobs.journal import Job
from daemon.jobs.states import State
from daemon.shapes import Program
from firmware_protocol.session import Accepted, Ended, Event, Ready, Verdict

IDLE_S = 1.0
NO_MACHINE_RETRY_S = 3.0
FAULT_RETRY_S = 30.0
"""Opening a port resets many controllers: one that answers, but is not ready, is left alone longer."""

_ENDED = "linedrawd ended in the middle of a drawing: set the pen to its origin and put in a new sheet"
"""The next one opens the port anew, which makes an origin of wherever the pen stands."""

_STATES = {Verdict.FINISHED: State.DONE, Verdict.REJECTED: State.FAILED}
"""Every other verdict leaves the job interrupted."""
_PORT_STAYS_OPEN = {Verdict.FINISHED, Verdict.STOPPED, Verdict.REJECTED}

InkMm: TypeAlias = Sequence[Sequence[tuple[float, float]]]


class OpenMachine(Protocol):
    """A machine whose port is open. Only `stop` may be called from another thread than the drawing one."""

    @property
    def name(self) -> str:
        """For people: the device path or URL."""

    def now(self) -> float:
        """Seconds on the machine's clock: real for a port, simulated for a simulator."""

    def connect(self) -> Ready:
        """Wait until it has introduced itself. Raises NoMachine or MachineFault."""

    def draw(self, program: Program) -> Ended:
        """Stream the program; returns when the job is over, however it ended."""

    def listen(self) -> None:
        """Hear what came meanwhile. Raises MachineFault when the machine is no longer there or not ready."""

    def line_times_s(self, program: Program) -> Sequence[float]:
        """When each line of the program will have been drawn, in seconds from its start."""

    def take_ink(self) -> InkMm | None:
        """What the last job has drawn, where the machine is simulated."""

    def stop(self) -> None:
        """Hold at once, lift the pen, end the job."""

    def close(self) -> None: ...


class Drawing:
    """One turn connects, draws one job, or listens to an idle machine.

    opened: opens the way to the machine and is given whom to tell what is heard. load: reads a program file.
    measure: compares the ink of a simulated machine with the picture of a job's folder.
    """

    def __init__(
        self,
        desk: Desk,
        *,
        opened: Callable[[Callable[[Event], None]], OpenMachine],
        load: Callable[[Path], Program],
        measure: Callable[[Path], None],
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self._desk, self._opened, self._load, self._measure, self._now = desk, opened, load, measure, now
        self._machine: OpenMachine | None = None
        self._progress: Progress | None = None
        self.missing: NoMachine | MachineFault | None = None
        """Why there is no machine to draw with; None when there is one, and before the first look."""
        self._told, self._retry_at_s = "", float("-inf")

    def turn(self) -> float:
        """Returns the seconds to wait for a change before the next turn."""
        if self._machine is None and not self._desk.held and self._now() >= self._retry_at_s:
            self._connect()
        if self._machine is None:
            return self._without_a_machine()
        job = self._desk.begin_drawing()
        if job is None:
            self._listen()
            return IDLE_S
        self._draw(job)
        return 0.0

    def stop(self) -> None:
        """Break off what is being drawn, pen up. May be called from any thread."""
        machine = self._machine
        if machine:
            machine.stop()

    def close(self) -> None:
        machine, self._machine = self._machine, None
        if machine:
            machine.close()

    def _connect(self) -> None:
        try:
            self._machine = self._opened(self._hear)
            ready = self._machine.connect()
        except (NoMachine, MachineFault) as error:
            self._lost(error)
            return
        self.missing, self._told = None, ""
        self._desk.say("the machine is ready", port=self._machine.name, firmware=ready.firmware)
        self._desk.show(state="idle", words="", port=self._machine.name, firmware=ready.firmware)

    def _lost(self, error: NoMachine | MachineFault) -> None:
        self._give_back()
        self.missing = error
        self._retry_at_s = self._now() + (NO_MACHINE_RETRY_S if isinstance(error, NoMachine) else FAULT_RETRY_S)
        if str(error) != self._told:
            self._told = str(error)
            self._desk.trouble(self._told)

    def _without_a_machine(self) -> float:
        if self._desk.held:
            return IDLE_S
        self._desk.let_wait(self._told)
        return max(0.0, self._retry_at_s - self._now())

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
            program = self._load(folder / "program.gcode")
        except LinedrawError as error:
            self._desk.step_at_last(job.id, State.FAILED, str(error))
            return
        self._progress = Progress(self._desk.show, program, self._machine.line_times_s(program))
        self._desk.show(state="drawing", words="", job=job.id, picture=job.name, strokes_total=program.strokes)
        begun_s = self._machine.now()
        ended = self._ended(job, program)
        self._record(job, program, ended, real_s=round(self._machine.now() - begun_s, 1))
        self._desk.show(job="", picture="", strokes_done=0, strokes_total=0, percent=0.0, seconds_left=None)

    def _ended(self, job: Job, program: Program) -> Ended:
        assert self._machine is not None
        if self._desk.held or self._desk.ending or self._desk.is_cancelled(job.id):
            return Ended(Verdict.STOPPED, 0, 0, True, True, "a person stopped it before it began")
        try:
            return self._machine.draw(program)
        except MachineFault as error:
            return Ended(Verdict.UNPLUGGED, 0, program.strokes, False, False, str(error))

    def _record(self, job: Job, program: Program, ended: Ended, *, real_s: float) -> None:
        assert self._machine is not None
        port, ink = self._machine.name, self._machine.take_ink()
        if not (ended.verdict in _PORT_STAYS_OPEN and ended.position_known):
            self._give_back()
        self._report(job, ink, real_s)
        cancelled = self._desk.is_cancelled(job.id) and ended.verdict is Verdict.STOPPED
        state = State.CANCELLED if cancelled else _STATES.get(ended.verdict, State.INTERRUPTED)
        if not self._desk.held:
            self._go_on_or_hold(_ENDED if self._desk.ending else ended.why, on=cancelled or state is State.DONE)
        self._desk.step_at_last(job.id, state, _words(ended, program.strokes), real_s=real_s, port=port)

    def _go_on_or_hold(self, why: str, *, on: bool) -> None:
        if on:
            self._desk.show(state="idle", words="")
        else:
            self._desk.hold(why)

    def _give_back(self) -> None:
        self.close()
        self._desk.show(port="", firmware="")

    def _report(self, job: Job, ink: InkMm | None, real_s: float) -> None:
        """The seconds into report.json, the ink beside it, and have it measured. A job does not fail for its report."""
        folder = self._desk.folders.path(job.id)
        try:
            _add_to_report(folder / "report.json", real_s)
            if ink is not None:
                write_durably(folder / "ink.json", json.dumps({"strokes": ink}).encode())
            if ink is not None and not self._desk.ending:
                self._measure(folder)
        except (LinedrawError, ValueError) as error:
            self._desk.trouble(f"the report is not complete: {error}", job=job.id)

    def _hear(self, event: Event) -> None:
        if isinstance(event, Accepted) and self._progress:
            self._progress.accepted(event.line)


class Progress:
    """How far a program has come, by the lines that the machine has acknowledged."""

    def __init__(self, show: Callable[..., None], program: Program, line_times_s: Sequence[float]) -> None:
        self._show, self._times_s = show, line_times_s
        last_line = {line.stroke: number for number, line in enumerate(program.lines) if line.stroke is not None}
        self._last_lines = [last_line[stroke] for stroke in sorted(last_line)]
        self._lines = len(program.lines)

    def accepted(self, line: int) -> None:
        all_s = self._times_s[-1] if self._times_s else 0.0
        done_s = self._times_s[line] if line < len(self._times_s) else all_s
        self._show(
            strokes_done=bisect_right(self._last_lines, line),
            percent=round(100 * (done_s / all_s if all_s else (line + 1) / self._lines), 1),
            seconds_left=round(all_s - done_s, 1),
        )


def _add_to_report(path: Path, real_s: float) -> None:
    if path.exists():
        report = json.loads(path.read_text(encoding="utf-8")) | {"real_s": real_s}
        write_durably(path, (json.dumps(report, indent=2) + "\n").encode())


def _words(ended: Ended, strokes: int) -> str:
    if ended.verdict is Verdict.FINISHED:
        return f"all {strokes} strokes are drawn"
    pen = "the pen is up" if ended.pen_lifted else "the pen may be down"
    return (
        f"{ended.why} (of {strokes} strokes {ended.strokes_certain} are certainly drawn, none after the first "
        f"{ended.strokes_possible} is touched; {pen})"
    )
