"""Retention: the folders of jobs that are over are removed, the oldest first, when they are too old or too many.

Clocks jump: that of a small computer is wrong until the network has set it. So the oldest are those with the lowest
number, and an age is only counted from a time that can be true: where the clock has jumped ahead since the job ended,
or had never been set then, from the moment at which that was seen.
"""

from __future__ import annotations

import shutil
import time
from collections.abc import Callable
from pathlib import Path

from daemon.config import Keep
from daemon.jobs.desk import Desk
from daemon.jobs.journal import Job
from daemon.jobs.states import State

OVER = (State.DONE, State.FAILED, State.CANCELLED)
"""An interrupted job is not over: a person may still go on with it."""
EVERY_S = 600.0
DAY_S = 86400.0
JUMP_S = 60.0
"""A clock that is set by more than this has jumped; less is corrected every day and changes no age."""
NEVER_SET_S = 1767225600.0
"""2026: no job is older than this program, so an earlier time is that of a clock which nobody had set."""
COUNTED_NAME = "counted_from"
"""In the folder of a job whose own time is not true: the time from which its age is counted, in s since 1970."""
_GOING = ".going-"


class Retention:
    """`turn` looks at most every EVERY_S. Work that is not done is never touched, whatever the bounds say."""

    def __init__(
        self,
        desk: Desk,
        keep: Keep,
        *,
        wall: Callable[[], float] = time.time,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self._desk, self.keep, self._wall, self._now = desk, keep, wall, now
        self._sizes: dict[str, int] = {}
        self._counted_s: dict[str, float] = {}
        self._booted_s = wall() - now()
        """When the monotonic clock began, by the other one: it stays where it is unless that one jumps."""
        self._due_s = float("-inf")

    def turn(self) -> None:
        """Remove what is over its time or its size, if it is time to look."""
        try:
            self._look_at_the_clock()
        except OSError as error:
            return self._desk.trouble(f"the age of jobs cannot be noted ({error}): correct the rights of that folder")
        if self._now() < self._due_s:
            return
        self._due_s = self._now() + EVERY_S
        try:
            for rest in self._desk.folders.root.parent.glob(f"{_GOING}*"):
                shutil.rmtree(rest, ignore_errors=True)
            for job in self._to_go(self._over()):
                self._remove(job.id)
        except OSError as error:
            self._desk.trouble(f"old jobs cannot be removed ({error}): correct the rights of that folder")

    def _look_at_the_clock(self) -> None:
        """Jobs that ended since the computer was switched on did so by the clock that has just been found wrong."""
        booted_s = self._wall() - self._now()
        jumped_s, before_s = booted_s - self._booted_s, self._booted_s
        if abs(jumped_s) <= JUMP_S:
            return
        if jumped_s > 0:
            for job in self._over():
                if before_s - JUMP_S <= job.changed_s <= self._wall() - jumped_s + JUMP_S:
                    self._count_from_now(job)
        self._booted_s = booted_s

    def _count_from_now(self, job: Job) -> None:
        path = self._desk.folders.path(job.id) / COUNTED_NAME
        path.write_text(f"{self._wall():.0f}", encoding="ascii")
        self._counted_s.pop(job.id, None)

    def _age_s(self, job: Job) -> float:
        """At least so old; below 0 where the clock has jumped back since it ended."""
        if job.id not in self._counted_s:
            self._counted_s[job.id] = _counted_s(self._desk.folders.path(job.id), job.changed_s)
        counted_s = self._counted_s[job.id]
        if counted_s < NEVER_SET_S <= self._wall():
            self._count_from_now(job)
        return self._wall() - counted_s if counted_s >= NEVER_SET_S else 0.0

    def _over(self) -> list[Job]:
        """Those whose folder is still there, the oldest first; the last folder stays, for numbers go on behind it."""
        there = {path.name for path in self._desk.folders.root.iterdir()}
        there -= {max(there, default="")}
        return sorted((job for job in self._desk.journal.jobs(*OVER) if job.id in there), key=lambda job: job.id)

    def _to_go(self, over: list[Job]) -> list[Job]:
        """Those that are too old, and of the others the first ones, until the rest keeps within its size."""
        going = [job for job in over if self._age_s(job) > self.keep.jobs_days * DAY_S]
        left = sum(self._size(job.id) for job in self._desk.journal.jobs()) - sum(self._size(job.id) for job in going)
        for job in over:
            if left <= self.keep.jobs_mb * 1e6:
                break
            if job not in going:
                left -= self._size(job.id)
                going.append(job)
        return going

    def _size(self, job_id: str) -> int:
        """Bytes of a job's folder; a job that is over does not grow, so its folder is looked at once."""
        if job_id in self._sizes:
            return self._sizes[job_id]
        size = _bytes_in(self._desk.folders.path(job_id))
        job = self._desk.journal.job(job_id)
        if job is not None and job.state in OVER:
            self._sizes[job_id] = size
        return size

    def _remove(self, job_id: str) -> None:
        """By a rename first: a folder is among the jobs as a whole or not at all, also after a power cut."""
        folder = self._desk.folders.path(job_id)
        going = self._desk.folders.root.parent / (_GOING + folder.name)
        folder.rename(going)
        shutil.rmtree(going)
        # The share of the others in a file that they had in common has grown.
        self._sizes.clear()
        self._desk.say("the folder of a job that is over was removed to keep within [keep]", removed=job_id)


def _counted_s(folder: Path, changed_s: float) -> float:
    """From when the age of the job is counted: its own time, where nothing else has been noted."""
    try:
        return float((folder / COUNTED_NAME).read_text(encoding="ascii"))
    except (OSError, ValueError):
        return changed_s


def _bytes_in(folder: Path) -> int:
    """Of a file that several jobs share, as pages of one document do, each has its part."""
    try:
        found = [path.lstat() for path in folder.iterdir()]
    except OSError:
        return 0
    return sum(file.st_size // file.st_nlink for file in found)
