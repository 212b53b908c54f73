"""Planning: the next queued picture goes through the worker."""

from __future__ import annotations

from daemon.errors import BadPicture, LinedrawError, OutOfReach, PlanningFailed
from daemon.jobs.allotment import Allotment
from daemon.jobs.desk import Desk
from daemon.jobs.folder import source_of
from daemon.jobs.journal import Job
from daemon.jobs.pool import Pool
from daemon.jobs.states import State

IDLE_S = 60.0


class Planning:
    """One turn plans one picture. A picture that cannot be planned fails alone."""

    def __init__(self, desk: Desk, pool: Pool, allotment: Allotment) -> None:
        self._desk, self._pool, self._allotment = desk, pool, allotment
        self._tried: set[str] = set()

    def turn(self) -> float:
        """Returns the seconds to wait for a change before the next turn."""
        job = self._allotment.begin()
        if job is None:
            return IDLE_S
        try:
            self._plan(job)
        except LinedrawError as error:
            # Broken off because the daemon ends: the next one plans it again.
            if not self._desk.ending and not self._again(job, error):
                self._allotment.end(job.id, failed=str(error))
        else:
            self._allotment.end(job.id)
        finally:
            self._desk.show(planning="", stage="")
        return 0.0

    def _again(self, job: Job, error: LinedrawError) -> bool:
        """Another machine may reach farther; a worker that died may have died of something else than this picture."""
        if isinstance(error, OutOfReach):
            return self._allotment.too_far(job)
        dropped = self._desk.is_cancelled(job.id) or bool(self._desk.only)
        if not isinstance(error, PlanningFailed) or job.id in self._tried or dropped:
            return False
        self._tried.add(job.id)
        self._desk.step(job.id, State.QUEUED, f"{error}; it is tried once more")
        return True

    def _plan(self, job: Job) -> None:
        folder = self._desk.folders.path(job.id)
        source = source_of(folder)
        if source is None:
            raise BadPicture(f"the picture of job {job.id} has gone from {folder}: drop it into the inbox again")
        self._desk.show(planning=job.id)
        show = self._desk.show
        self._pool.plan(source, folder, job.machine, name=job.name, progress=lambda stage: show(stage=stage))
