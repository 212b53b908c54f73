"""What only a person may choose of a job: to try it again, to draw it once more, to go on with it from a stroke."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from daemon.errors import LinedrawError
from daemon.jobs.arrival import ARRIVAL_NAME, arrival_in
from daemon.jobs.desk import Desk
from daemon.jobs.folder import source_of, write_durably
from daemon.jobs.journal import UNTOLD, Job
from daemon.jobs.states import Reason, State
from daemon.jobs.station import Station
from daemon.jobs.wishes import SIDE_NAME
from daemon.program.file import load_program
from daemon.shapes import Program, ProgramLine

_FROM_NAME = "from_stroke"


class Choices:
    """The orders return a sentence for the person who gave them. Calls come from any thread.

    placed: whether this machine knows where the sheet's origin is. Each raises LinedrawError when it is refused, and
    DiskTrouble, with nothing changed.
    """

    def __init__(self, desk: Desk, *, placed: Callable[[str], bool]) -> None:
        self._desk, self._placed = desk, placed

    def approve(self, job_id: str) -> str:
        """Draw, when its turn comes, a job that waits for just this word."""
        with self._desk.changed:
            job = self._desk.find(job_id)
            if (job.state, job.reason) != (State.WAITING, Reason.APPROVAL):
                raise LinedrawError(f"job {job.id} is {job.state.value}: it does not wait for anybody's approval")
            self._desk.step(job.id, State.PLANNED, "a person has approved it")
        return f"job {job.id} is drawn when its turn comes"

    def retry(self, job_id: str) -> str:
        """Plan and draw a failed job again, where no ink of it can be on a sheet."""
        job = self._desk.find(job_id)
        if job.state is not State.FAILED:
            raise LinedrawError(f"job {job.id} is {job.state.value}, only a failed one is tried again: say `again`")
        if job.possible:
            raise LinedrawError(f"ink of job {job.id} may be on the sheet ({job.on_paper}): say `linedrawd again`")
        self._check_machine(job)
        self._desk.step(job.id, State.QUEUED, "a person has it tried again")
        return f"job {job.id} is queued again"

    def again(self, job_id: str) -> str:
        """A new job of the same picture, with the same wishes, whatever became of the old one."""
        job = self._desk.find(job_id)
        self._check_machine(job)
        folder = self._desk.folders.path(job.id)
        source = source_of(folder)
        if source is None:
            raise LinedrawError(f"the picture of job {job.id} is no longer kept: drop it into the inbox again")
        arrival, side = arrival_in(folder), folder / SIDE_NAME
        files = {ARRIVAL_NAME: arrival.copy(job.id).encoded()} if arrival else {}
        if side.exists():
            files[SIDE_NAME] = side.read_bytes()
        new = self._desk.folders.copy(source, files, name=arrival.name if arrival else job.name)
        return f"job {self._desk.add(new, job.name, bound_to=job.bound_to)} draws {job.name} once more"

    def _check_machine(self, job: Job) -> None:
        if job.bound_to not in ("", *self._desk.stations):
            raise LinedrawError(
                f"job {job.id} is for the machine {job.bound_to}, which is not set: set it, or drop it anew"
            )

    def resume_from(self, job_id: str, stroke: int) -> str:
        """Go on with an interrupted job from this stroke (from 0) on; the person answers for those before it."""
        job = self._desk.find(job_id)
        if job.state is not State.INTERRUPTED:
            raise LinedrawError(f"job {job.id} is {job.state.value}: only an interrupted one is resumed from a stroke")
        if job.possible != UNTOLD and stroke >= job.strokes:
            raise LinedrawError(
                f"job {job.id} has {job.strokes} strokes, from 0 to {job.strokes - 1}: give one of them"
            )
        station = self._desk.station(job.machine)
        if station is None:
            raise LinedrawError(
                f"job {job.id} was drawn by {job.machine or '?'}, which is not set any more: say `again`"
            )
        if not self._placed(station.name):
            raise LinedrawError(not_placed(station))
        write_durably(self._desk.folders.path(job.id) / _FROM_NAME, str(stroke).encode())
        self._desk.step(job.id, State.WAITING, f"a person has it go on from stroke {stroke}")
        station.go()
        return f"job {job.id} goes on from stroke {stroke}{_pen_at(self._desk.folders.path(job.id), stroke)}"


def _pen_at(folder: Path, stroke: int) -> str:
    """In words, which pen must be in; "" where pens have no names, or nobody knows."""
    try:
        pen = load_program(folder / "program.gcode").pen_of(stroke)
    except LinedrawError:
        return ""
    return f", with the {pen} pen" if pen else ""


def not_placed(station: Station) -> str:
    """Why it goes on with no drawing, and what a person does about it."""
    return (
        f"the machine does not know where the sheet's origin is: put the pen there and say "
        f"{station.command('machine origin')}, or {station.command('machine home')}, then "
        f"`linedrawd resume JOB --from-stroke K` again"
    )


def program_left(job: Job, folder: Path, program: Program, *, without: Sequence[ProgramLine]) -> Program:
    """What of the program is to be drawn: all, or from the stroke on that a person has named.

    The lines before the first stroke, which lift the pen, stay; each stroke begins with the travel to its start.
    without: lines that a job leaves out which goes on.

    Raises LinedrawError where ink may be on the sheet and no stroke has been named.
    """
    if not job.possible:
        return program
    try:
        first = int((folder / _FROM_NAME).read_text(encoding="ascii"))
    except (OSError, ValueError):
        raise LinedrawError(f"nobody has said from which stroke job {job.id} goes on: say it again") from None
    lines = tuple(
        line for line in program.lines if line not in without and (line.stroke is None or line.stroke >= first)
    )
    return replace(program, lines=lines)
