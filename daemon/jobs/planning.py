"""Planning: the next queued picture goes through the worker."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from pathlib import Path

from daemon.errors import BadPicture, DiskFull, DiskTrouble, LinedrawError, OutOfReach, PlanningFailed
from daemon.jobs.allotment import Allotment
from daemon.jobs.desk import DISK_RETRY_S, Desk
from daemon.jobs.folder import free_bytes, source_of, warnings_of
from daemon.jobs.journal import Job
from daemon.jobs.pool import Pool
from daemon.jobs.states import State

IDLE_S = 60.0


class Planning:
    """One turn plans one picture. A picture that cannot be planned fails alone."""

    def __init__(
        self,
        desk: Desk,
        pool: Pool,
        allotment: Allotment,
        *,
        now: Callable[[], float] = time.monotonic,
        free: Callable[[Path], int] = free_bytes,
    ) -> None:
        self._desk, self._pool, self._allotment, self._now, self._free = desk, pool, allotment, now, free
        self._tried: set[str] = set()
        self._planned = False
        """The program of this turn can be drawn; only its pictures are missing."""
        self._not_before_s = float("-inf")
        """Nothing is planned until then: a disk that was full a moment ago is full."""

    def turn(self) -> float:
        """Returns the seconds to wait for a change before the next turn."""
        if self._now() < self._not_before_s:
            return self._not_before_s - self._now()
        job = self._allotment.begin()
        if job is None:
            return IDLE_S
        self._planned = False
        try:
            self._plan(job)
        except LinedrawError as error:
            # Broken off because the daemon ends: the next one plans it again.
            if not self._desk.ending:
                self._failed(job, error)
        finally:
            self._desk.show(planning="", stage="")
        return 0.0

    def _failed(self, job: Job, error: LinedrawError) -> None:
        if self._planned:
            self._desk.trouble(f"its program is whole, the pictures of its plan are not: {error}", job=job.id)
        elif not self._again(job, error):
            self._allotment.end(job.id, failed=str(error))

    def _again(self, job: Job, error: LinedrawError) -> bool:
        """Another machine may reach farther; a worker that died may have died of something else than this picture.

        A full disk is waited for, for no picture could be planned; one that takes nothing for another reason, as a
        folder of wrong rights does, is tried once more.
        """
        if isinstance(error, OutOfReach):
            return self._allotment.too_far(job)
        dropped = self._desk.is_cancelled(job.id) or bool(self._desk.only)
        if not isinstance(error, PlanningFailed | DiskTrouble) or job.id in self._tried or dropped:
            return False
        full = isinstance(error, DiskFull) or (isinstance(error, DiskTrouble) and self._full())
        if not full:
            self._tried.add(job.id)
        if isinstance(error, DiskTrouble):
            self._not_before_s = self._now() + DISK_RETRY_S
            self._desk.trouble(str(error), job=job.id)
        words = "it is planned again when there is room" if full else "it is tried once more"
        self._desk.step_at_last(job.id, State.QUEUED, f"{error}; {words}")
        return True

    def _full(self) -> bool:
        return self._free(self._desk.folders.root) < self._pool.settings.keep.free_mb * 1e6

    def _plan(self, job: Job) -> None:
        folder = self._desk.folders.path(job.id)
        source = source_of(folder)
        if source is None:
            raise BadPicture(f"the picture of job {job.id} has gone from {folder}: drop it into the inbox again")
        self._desk.show(planning=job.id)
        show = self._desk.show

        def planned() -> None:
            self._planned = True
            for words in warnings_of(folder):
                self._desk.say(words, job=job.id, level=logging.WARNING)
            self._allotment.end(job.id)

        self._pool.plan(
            source,
            folder,
            job.machine,
            name=job.name,
            progress=lambda stage: show(stage=stage),
            planned=planned,
        )
