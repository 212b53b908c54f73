"""The desk: which job is next for the worker and for the machine, what holds them up, and who is told."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from daemon.errors import DiskTrouble, LinedrawError
from daemon.jobs.folder import JobFolders
from daemon.jobs.journal import Job, Journal
from daemon.jobs.record import read_record, write_record
from daemon.jobs.standing import forget_place
from daemon.jobs.states import HOW_ON, OVER, UNDER_THE_PEN, Reason, State

DISK_RETRY_S = 10.0
_INTERRUPTED = (
    "the daemon ended while it was drawing, where the pen stands is unknown ({paper}): look at the sheet, then {how}"
)
_BEFORE_INK_ENDED = "the daemon ended before the first stroke: it is drawn when its turn comes"
_GONE = "the folder of job {job} has gone, deleted by hand: drop the picture into the inbox again"
_LOST = "the journal was lost and made again from the job folders: look at the sheet and at `linedrawd jobs`"
_DROPPED = "a person dropped the job"
_LOUD = dict.fromkeys((State.FAILED, State.INTERRUPTED), logging.ERROR)
_LOUD |= dict.fromkeys((State.PAUSED, State.CANCELLED), logging.WARNING)
_READY = (State.PLANNED, State.WAITING)
_BEFORE_INK = (State.QUEUED, State.PLANNED, State.WAITING, State.INTERRUPTED)


class Desk:
    """Every step of a job goes through here: into the journal first, then to people. Calls come from any thread.

    say: an event in words, with `job`, `level` and figures by keyword. show: changed fields of the status.
    """

    def __init__(
        self,
        journal: Journal,
        folders: JobFolders,
        *,
        say: Callable[..., None],
        show: Callable[..., None],
        asks_for_sheets: bool,
        ahead: int = 2,
        rank: Callable[[str], Any] = lambda name: 0,
    ) -> None:
        """rank: of a picture's name; the job of the lowest goes first, of equals the one that came first."""
        self.journal, self.folders, self.say, self.show = journal, folders, say, show
        self.ending = False
        self.only = ""
        """The one job that is worked on, where a person has asked for just that."""
        self.cut_off = False
        """The daemon before this one was killed while it drew, so that nobody has lifted the pen."""
        self.changes = 0
        """Counts what has changed, so that a change between a look and a `wait` is not slept over."""
        self._asks_for_sheets, self._ahead, self._rank = asks_for_sheets, ahead, rank
        self._cancelled, self._troubled = set[str](), ("", "")
        self._changed = threading.Condition(threading.RLock())

    def recover(self, inbox: Path) -> None:
        """After a start: finish what the last daemon left half done. Nothing moves because of it."""
        self.folders.finish_claims(inbox)
        self._adopt_strays()
        for job in self.journal.jobs(State.PLANNING):
            self.step(job.id, State.QUEUED, "the daemon ended while it was planning: it plans again")
        forget_place(self, "linedrawd was started anew")
        for job in self.journal.jobs(*UNDER_THE_PEN):
            if not job.possible:
                self.step(job.id, State.PLANNED, _BEFORE_INK_ENDED)
                continue
            # First: after a cut between the two nothing may start either.
            self.hold(f"job {job.id} was interrupted: look at the sheet, and set the pen to its origin again")
            self.cut_off = True
            said = _INTERRUPTED.format(paper=job.on_paper, how=HOW_ON.format(job=job.id))
            self.step(job.id, State.INTERRUPTED, said, reason=Reason.POSITION_UNKNOWN)
        for job in self.journal.jobs(State.QUEUED, *_READY):
            if not self.folders.path(job.id).is_dir():
                self.step(job.id, State.FAILED, _GONE.format(job=job.id))
        if self.held:
            self._show_held()

    def _adopt_strays(self) -> None:
        """Folders that the journal does not know: claimed just before a cut, or all of them where it was lost."""
        lost = not self.journal.jobs()
        for job_id in self.folders.strays({job.id for job in self.journal.jobs()}):
            told = read_record(self.folders.path(job_id))
            if told is None:
                self.add(job_id, job_id)
            else:
                if lost and not self.held:
                    self.hold(_LOST)
                self.journal.adopt(told)
                figures = {"state": told.state.value, "reason": told.reason.value}
                self.say("taken over from its folder", job=job_id, level=logging.WARNING, **figures)

    @property
    def held(self) -> str:
        """Why no job may start, in a sentence; empty when they may."""
        return self.journal.held

    def copy(self, picture: Path, name: str) -> str:
        """Make a job of a copy of the picture. Returns the job's id. Raises DiskTrouble and FileNotFoundError."""
        return self.add(self.folders.copy(picture), name)

    def add(self, job_id: str, name: str) -> str:
        """Make a job of a folder that holds its picture. Returns its id. Raises DiskTrouble."""
        self._record(self.journal.add(job_id, name))
        self.say("the picture is queued", job=job_id, state=State.QUEUED.value, name=name)
        self._show_queue()
        return job_id

    def step(self, job_id: str, state: State, words: str = "", *, reason: Reason = Reason.NONE, **figures: Any) -> None:
        """Record the step and tell it. Raises DiskTrouble; the step has then not happened."""
        before = self.journal.job(job_id)
        job = self.journal.step(job_id, state, words, reason=reason)
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

    def begin_planning(self) -> Job | None:
        """The next job for the worker, now in planning; None while enough is planned."""
        with self._changed:
            queued = self._worked_on(State.QUEUED)
            if self.ending or not queued or len(self._worked_on(*_READY)) >= self._ahead:
                return None
            self.step(queued[0].id, State.PLANNING)
            return queued[0]

    def end_planning(self, job_id: str, *, failed: str = "") -> None:
        """The worker is through with it; `failed` says why it could not be planned."""
        with self._changed:
            if job_id in self._cancelled:
                self.step_at_last(job_id, State.CANCELLED, _DROPPED)
            elif failed:
                self.step_at_last(job_id, State.FAILED, failed)
            else:
                self.step_at_last(job_id, State.PLANNED, "")

    def begin_drawing(self) -> Job | None:
        """The next job for the machine, now in drawing; None while there is none or something holds it up."""
        with self._changed:
            ready = self._worked_on(*_READY)
            if self.ending or self.held or not ready:
                return None
            if self._asks_for_sheets and self.journal.sheet_used:
                self.let_wait("waiting for a new sheet: put one in and say `linedrawd next`")
                return None
            return self._begin(ready[0])

    def _begin(self, job: Job) -> Job | None:
        try:
            write_record(self.folders.path(job.id), replace(job, state=State.DRAWING))
        except FileNotFoundError:
            self.step(job.id, State.FAILED, _GONE.format(job=job.id))
            return None
        self.step(job.id, State.DRAWING)
        return job

    def next_to_draw(self) -> Job | None:
        """The planned job that comes next, None where none is planned."""
        return next(iter(self._worked_on(*_READY)), None)

    def let_wait(self, words: str) -> None:
        """The planned jobs wait, and `words` say for what."""
        with self._changed:
            for job in self._worked_on(State.PLANNED):
                self.step(job.id, State.WAITING, words)
            self.show(state="waiting", words=words)

    def cancel(self, job_id: str) -> State:
        """Drop a job; one that is being planned or drawn is marked and must be broken off. Returns its state before.

        Raises LinedrawError when there is no such job or it is over.
        """
        with self._changed:
            job = self.find(job_id)
            if job.state in _BEFORE_INK:
                self.step(job.id, State.CANCELLED, _DROPPED)
            elif job.state in (State.PLANNING, *UNDER_THE_PEN):
                self._cancelled.add(job.id)
            else:
                raise LinedrawError(f"job {job.id} is {job.state.value} already: there is nothing to cancel")
            return job.state

    def is_cancelled(self, job_id: str) -> bool:
        return job_id in self._cancelled

    def find(self, job_id: str) -> Job:
        """By its id or the number at its beginning. Raises LinedrawError."""
        job = self.journal.job(job_id)
        if job is None and job_id.isdecimal():
            job = next((job for job in self.journal.jobs() if job.id.startswith(f"{int(job_id):06d}-")), None)
        if job is None:
            raise LinedrawError(f"there is no job {job_id}: `linedrawd jobs` lists them")
        return job

    def new_sheet(self) -> None:
        self.journal.new_sheet()
        self.say("a new sheet is in")
        self._notify()

    def hold(self, words: str) -> None:
        """No further job starts until a person says `go`, also after a restart."""
        try:
            self.journal.hold(words)
        except DiskTrouble as error:
            self.trouble(str(error))
        self.say(self._show_held(), level=logging.WARNING)
        self._notify()

    def _show_held(self) -> str:
        words = f"no job starts until a person says `linedrawd go`: {self.held}"
        self.show(state="held", words=words, held=self.held)
        return words

    def go(self) -> None:
        self.journal.go()
        self.cut_off = False
        self.say("jobs may start again")
        self.show(held="", state="idle", words="")
        self._notify()

    def end(self) -> None:
        """The loops come to their end."""
        self.ending = True
        self._notify()

    def wake(self) -> None:
        """Whoever waits looks again."""
        self._notify()

    def wait(self, seconds: float, *, since: int | None = None) -> None:
        """Until `changes` is no longer `since` (None: what it is now), or this long."""
        with self._changed:
            seen = self.changes if since is None else since
            self._changed.wait_for(lambda: self.ending or self.changes != seen, seconds)

    def _worked_on(self, *states: State) -> list[Job]:
        jobs = [job for job in self.journal.jobs(*states) if self.only in ("", job.id)]
        return sorted(jobs, key=lambda job: self._rank(job.name))

    def _show_queue(self) -> None:
        self.show(jobs_queued=self.journal.count(State.QUEUED), jobs_waiting=self.journal.count(*_READY))
        self._notify()

    def _notify(self) -> None:
        with self._changed:
            self.changes += 1
            self._changed.notify_all()
