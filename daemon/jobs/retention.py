"""Retention: the folders of jobs that are over are removed, the oldest first, when they are too old or too many."""

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
        self._due_s = float("-inf")

    def turn(self) -> None:
        """Remove what is over its time or its size, if it is time to look."""
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

    def _over(self) -> list[Job]:
        """Those whose folder is still there, the oldest first; the last folder stays, for numbers go on behind it."""
        there = {path.name for path in self._desk.folders.root.iterdir()}
        there -= {max(there, default="")}
        over = [job for job in self._desk.journal.jobs(*OVER) if job.id in there]
        return sorted(over, key=lambda job: (job.changed_s, job.id))

    def _to_go(self, over: list[Job]) -> list[Job]:
        """The first of them, up to the last one that is too old or above the size."""
        left = sum(self._size(job.id) for job in self._desk.journal.jobs())
        going: list[Job] = []
        for job in over:
            too_old = self._wall() - job.changed_s > self.keep.jobs_days * DAY_S
            if not too_old and left <= self.keep.jobs_mb * 1e6:
                break
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
        self._sizes[job_id] = 0
        self._desk.say("the folder of a job that is over was removed to keep within [keep]", removed=job_id)


def _bytes_in(folder: Path) -> int:
    try:
        return sum(path.lstat().st_size for path in folder.iterdir())
    except OSError:
        return 0
