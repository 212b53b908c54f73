"""The desk: the one queue, which job is next for the worker and for each machine, and who is told."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from daemon.errors import DiskTrouble, LinedrawError
from daemon.jobs.folder import JobFolders, is_called
from daemon.jobs.journal import Job, Journal
from daemon.jobs.record import read_record, write_record
from daemon.jobs.standing import forget_place
from daemon.jobs.states import HOW_ON, OVER, UNDER_THE_PEN, Reason, State

if TYPE_CHECKING:
    from daemon.jobs.station import Station

DISK_RETRY_S = 10.0
GONE = "the folder of job {job} has gone, deleted by hand: drop the picture into the inbox again"
_INTERRUPTED = (
    "the daemon ended while it was drawing, where the pen stands is unknown ({paper}): look at the sheet, then {how}"
)
_BEFORE_INK_ENDED = "the daemon ended before the first stroke: it is drawn when its turn comes"
_LOST = "the journal was lost and made again from the job folders: look at the sheet and at `linedrawd jobs`"
_NO_MACHINE = "it is for the machine {machine}, which is not set any more: set it, then `linedrawd retry {job}`"
_OTHER_MACHINE = "it was planned for {machine}, which is not set any more: it is planned again"
DROPPED = "a person dropped the job"
_LOUD = dict.fromkeys((State.FAILED, State.INTERRUPTED), logging.ERROR)
_LOUD |= dict.fromkeys((State.PAUSED, State.CANCELLED), logging.WARNING)
READY = (State.PLANNED, State.WAITING)
_BEFORE_INK = (State.QUEUED, State.PLANNED, State.WAITING, State.INTERRUPTED)


class Desk:
    """Every step of a job goes through here: into the journal first, then to people. Calls come from any thread.

    say: an event in words, with `job`, `level` and figures by keyword. show: changed fields of the status.
    stations: the machines, by name; each puts itself there.
    """

    def __init__(
        self,
        journal: Journal,
        folders: JobFolders,
        *,
        say: Callable[..., None],
        show: Callable[..., None],
        rank: Callable[[str], Any] = lambda name: 0,
    ) -> None:
        """rank: of a picture's name; the job of the lowest goes first, of equals the one that came first."""
        self.journal, self.folders, self.say, self.show = journal, folders, say, show
        self.stations: dict[str, Station] = {}
        self.ending = False
        self.only = ""
        """The one job that is worked on, where a person has asked for just that."""
        self.changes = 0
        """Counts what has changed, so that a change between a look and a `wait` is not slept over."""
        self.changed = threading.Condition(threading.RLock())
        """Whoever chooses a job holds it, so that no two machines choose the same."""
        self._rank = rank
        self._cancelled: set[str] = set()
        self._troubled = ("", "")

    @property
    def several(self) -> bool:
        """There is more than one machine, so that people have to be told which."""
        return len(self.stations) > 1

    def station(self, machine: str) -> Station | None:
        """That of this machine. A job of a time with one machine belongs to the one there is, whatever it is called."""
        if machine in self.stations or self.several:
            return self.stations.get(machine)
        return next(iter(self.stations.values()))

    def recover(self) -> None:
        """After a start: finish what the last daemon left half done. Nothing moves because of it."""
        self._adopt_strays()
        for job in self.journal.jobs(State.PLANNING):
            self.step(job.id, State.QUEUED, "the daemon ended while it was planning: it plans again")
        forget_place(self, "linedrawd was started anew")
        for job in self.journal.jobs(*UNDER_THE_PEN):
            self._recover_drawn(job)
        for job in self.journal.jobs(State.QUEUED, *READY):
            self._recover_ready(job)
        for station in self.stations.values():
            station.recover()

    def _recover_drawn(self, job: Job) -> None:
        if not job.possible:
            return self.step(job.id, State.PLANNED, _BEFORE_INK_ENDED)
        station = self.station(job.machine)
        # First: after a cut between the two nothing may start either.
        for held in [station] if station else self.stations.values():
            held.hold(f"job {job.id} was interrupted: look at the sheet, and set the pen to its origin again")
        if station:
            station.cut_off = True
        words = _INTERRUPTED.format(paper=job.on_paper, how=HOW_ON.format(job=job.id))
        return self.step(job.id, State.INTERRUPTED, words, reason=Reason.POSITION_UNKNOWN)

    def _recover_ready(self, job: Job) -> None:
        if not self.folders.path(job.id).is_dir():
            self.step(job.id, State.FAILED, GONE.format(job=job.id))
        elif job.bound_to not in ("", *self.stations):
            self.step(job.id, State.FAILED, _NO_MACHINE.format(machine=job.bound_to, job=job.id))
        elif job.state in READY and not job.possible and self.station(job.machine) is None:
            self.step(job.id, State.QUEUED, _OTHER_MACHINE.format(machine=job.machine or "another machine"))

    def _adopt_strays(self) -> None:
        """Folders that the journal does not know: claimed just before a cut, or all of them where it was lost."""
        lost = not self.journal.jobs()
        for job_id in self.folders.strays({job.id for job in self.journal.jobs()}):
            told = read_record(self.folders.path(job_id))
            if told is None:
                self.add(job_id, job_id)
                continue
            if lost:
                for station in self.stations.values():
                    if not station.held:
                        station.hold(_LOST)
            self.journal.adopt(told)
            figures = {"state": told.state.value, "reason": told.reason.value}
            self.say("taken over from its folder", job=job_id, level=logging.WARNING, **figures)

    def add(self, job_id: str, name: str, *, bound_to: str = "") -> str:
        """Make a job of a folder that holds its picture. Returns its id. Raises DiskTrouble.

        bound_to: the machine that shall draw it; "" for any.
        """
        self._record(self.journal.add(job_id, name, bound_to=bound_to))
        self.say("the picture is queued", job=job_id, state=State.QUEUED.value, name=name)
        self._show_queue()
        return job_id

    def add_dropped(self, job_id: str, name: str, words: str) -> None:
        """A job that is recorded and dropped in one, so that nothing can begin it in between. Raises DiskTrouble."""
        job = Job(job_id, name, State.CANCELLED, words, time.time())
        self.journal.adopt(job)
        self._record(job)
        self._tell_step(job, {"name": name})

    def step(
        self,
        job_id: str,
        state: State,
        words: str = "",
        *,
        reason: Reason = Reason.NONE,
        machine: str = "",
        **figures: Any,
    ) -> None:
        """Record the step and tell it. Raises DiskTrouble; the step has then not happened.

        machine: the one that it is planned for, or begun on.
        """
        before = self.journal.job(job_id)
        job = self.journal.step(job_id, state, words, reason=reason, machine=machine)
        if machine and self.several:
            figures["machine"] = machine
        if state in OVER or (before and before.state in UNDER_THE_PEN):
            self._record(job)
        self._tell_step(job, figures)

    def _tell_step(self, job: Job, figures: dict[str, Any]) -> None:
        self._troubled = ("", "")
        state, words, level = job.state.value, job.words, _LOUD.get(job.state, logging.INFO)
        because = {"reason": job.reason.value} if job.reason.value else {}
        self.say(words or f"the job is {state}", job=job.id, level=level, state=state, **because, **figures)
        if job.state in (State.FAILED, State.INTERRUPTED):
            self.show(last_error=words)
        self._show_queue()

    def _record(self, job: Job) -> None:
        try:
            write_record(self.folders.path(job.id), job)
        except (DiskTrouble, FileNotFoundError) as error:
            self.trouble(f"the job's record is not up to date: {error}", job=job.id)

    def step_at_last(self, job_id: str, state: State, words: str, **figures: Any) -> None:
        """As `step`, but a full disk is waited for: what happened on paper must not be forgotten."""
        self._at_last(job_id, lambda: self.step(job_id, state, words, **figures))

    def end_drawing(
        self, job_id: str, state: State, words: str, *, extent: tuple[int, int], reason: Reason, **figures: Any
    ) -> None:
        """A drawing is over. extent: strokes certainly drawn, and from which number on none is touched."""
        certain, possible = extent

        def step() -> None:
            job = self.journal.end_drawing(job_id, state, words, certain=certain, possible=possible, reason=reason)
            self._record(job)
            self._tell_step(job, figures)

        self._at_last(job_id, step)

    def _at_last(self, job_id: str, step: Callable[[], None]) -> None:
        while True:
            try:
                return step()
            except DiskTrouble as error:
                self.trouble(str(error), job=job_id)
                self.wait(DISK_RETRY_S)
                if self.ending:
                    return None

    def trouble(self, words: str, *, job: str = "") -> None:
        """Say an error, once until something has gone well again."""
        if (words, job) != self._troubled:
            self._troubled = (words, job)
            self.say(words, job=job, level=logging.ERROR)
            self.show(last_error=words)

    def cancel(self, job_id: str) -> State:
        """Drop a job; one that is being planned or drawn is marked and must be broken off. Returns its state before.

        Raises LinedrawError when there is no such job or it is over.
        """
        with self.changed:
            job = self.find(job_id)
            if job.state in _BEFORE_INK:
                self.step(job.id, State.CANCELLED, DROPPED)
            elif job.state in (State.PLANNING, *UNDER_THE_PEN):
                self._cancelled.add(job.id)
            else:
                raise LinedrawError(f"job {job.id} is {job.state.value} already: there is nothing to cancel")
            return job.state

    def worked_on(self, *states: State) -> list[Job]:
        """The jobs in these states, the one that comes next first."""
        jobs = [job for job in self.journal.jobs(*states) if self.only in ("", job.id)]
        return sorted(jobs, key=lambda job: self._rank(job.name))

    def ready(self) -> list[Job]:
        """The planned jobs that may be drawn, the one that comes next first."""
        return [job for job in self.worked_on(*READY) if job.reason is not Reason.APPROVAL]

    def is_cancelled(self, job_id: str) -> bool:
        return job_id in self._cancelled

    def find(self, job_id: str) -> Job:
        """By its id or the number at its beginning. Raises LinedrawError."""
        job = self.journal.job(job_id)
        if job is None:
            job = next((job for job in self.journal.jobs() if is_called(job.id, job_id)), None)
        if job is None:
            raise LinedrawError(f"there is no job {job_id}: `linedrawd jobs` lists them")
        return job

    def end(self) -> None:
        """The loops come to their end."""
        self.ending = True
        self.wake()

    def wake(self) -> None:
        """Whoever waits looks again."""
        with self.changed:
            self.changes += 1
            self.changed.notify_all()

    def wait(self, seconds: float, *, since: int | None = None) -> None:
        """Until `changes` is no longer `since` (None: what it is now), or this long."""
        with self.changed:
            seen = self.changes if since is None else since
            self.changed.wait_for(lambda: self.ending or self.changes != seen, seconds)

    def _show_queue(self) -> None:
        waiting = self.journal.jobs(State.WAITING) if self.journal.count(State.WAITING) else []
        to_approve = sum(job.reason is Reason.APPROVAL for job in waiting)
        self.show(
            jobs_queued=self.journal.count(State.QUEUED),
            jobs_waiting=self.journal.count(*READY) - to_approve,
            jobs_to_approve=to_approve,
        )
        self.wake()
