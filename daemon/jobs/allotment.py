"""The allotment: which picture is planned next, and for which machine: the first free one that reaches so far."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

from daemon.jobs.desk import DROPPED, Desk
from daemon.jobs.folder import number_of
from daemon.jobs.journal import Job
from daemon.jobs.states import Reason, State
from daemon.jobs.station import Station

_ANOTHER_IS_FREE = "it was planned for {machine}, {free} is free for it: it is planned again"
_TO_APPROVE = "look at {page}, then `linedrawd approve {number}` has it drawn, `linedrawd cancel {number}` not"
_TOO_FAR = "{machine} does not reach so far: it is planned for another machine"


class Allotment:
    """Chooses for whoever plans. With one machine it is that one, and the order of the queue.

    ahead: so many jobs are planned for each machine before it is free for them. suits: of a job and a machine, whether
    its reach holds the whole box. shared: the machines that draw what comes in by the shared inbox. asks: of a job,
    whether a person has to approve it.
    """

    def __init__(
        self,
        desk: Desk,
        *,
        ahead: int = 2,
        suits: Callable[[str, str], bool] = lambda job, machine: True,
        shared: frozenset[str] = frozenset(),
        asks: Callable[[str], bool] = lambda job: False,
    ) -> None:
        self._desk, self._ahead, self._suits, self._shared, self._asks = desk, ahead, suits, shared, asks
        self._too_far: set[tuple[str, str]] = set()

    def begin(self) -> Job | None:
        """The next job for the worker, now in planning for its `machine`; None while enough is planned."""
        with self._desk.changed:
            if self._desk.ending:
                return None
            if self._desk.several:
                self._hand_over()
            loads = self._loads()
            if all(loads[name] >= self._ahead for name in self._desk.stations):
                return None
            for job in self._desk.worked_on(State.QUEUED):
                station = self._station_for(job, loads)
                if station:
                    self._desk.step(job.id, State.PLANNING, machine=station.name)
                    return self._desk.find(job.id)
            return None

    def end(self, job_id: str, *, failed: str = "") -> None:
        """The worker is through with it; `failed` says why it could not be planned."""
        with self._desk.changed:
            if self._desk.is_cancelled(job_id):
                self._desk.step_at_last(job_id, State.CANCELLED, DROPPED)
            elif failed:
                self._desk.step_at_last(job_id, State.FAILED, failed)
            elif self._asks(job_id) and job_id != self._desk.only:
                page, number = self._desk.folders.path(job_id) / "preview.html", number_of(job_id)
                words = _TO_APPROVE.format(page=page, number=number)
                self._desk.step_at_last(job_id, State.WAITING, words, reason=Reason.APPROVAL)
            else:
                machine = self._desk.find(job_id).machine
                self._desk.step_at_last(job_id, State.PLANNED, f"planned for {machine}" if self._desk.several else "")

    def too_far(self, job: Job) -> bool:
        """Its machine does not reach so far. True where it is queued for another one; False where none is left."""
        with self._desk.changed:
            self._too_far.add((job.id, job.machine))
            if self._desk.is_cancelled(job.id) or not self._candidates(job):
                return False
            self._desk.step(job.id, State.QUEUED, _TOO_FAR.format(machine=job.machine))
            return True

    def _candidates(self, job: Job) -> list[Station]:
        names = [job.bound_to] if job.bound_to else [name for name in self._desk.stations if self._may_share(name)]
        return [self._desk.stations[name] for name in names if (job.id, name) not in self._too_far]

    def _may_share(self, name: str) -> bool:
        return not self._shared or name in self._shared

    def _loads(self) -> Counter[str]:
        """How many jobs are planned for each machine."""
        owners = (self._desk.station(job.machine) for job in self._desk.ready())
        return Counter(owner.name for owner in owners if owner)

    def _station_for(self, job: Job, loads: Counter[str]) -> Station | None:
        """The one that will be free first; one that is away only where every other one is, too."""
        candidates = self._candidates(job)
        here = [station for station in candidates if not station.away] or candidates
        fitting = [station for station in here if len(here) == 1 or self._suits(job.id, station.name)] or here
        room = [station for station in fitting if loads[station.name] < self._ahead]
        return min(room, key=lambda station: loads[station.name] + station.draws, default=None)

    def _hand_over(self) -> None:
        """What is planned for a machine that cannot begin it now is queued again for one that is free."""
        for station in self._desk.stations.values():
            if station.free and not self._has_work(station):
                job = next((job for job in self._desk.ready() if self._may_have(station, job)), None)
                if job:
                    words = _ANOTHER_IS_FREE.format(machine=job.machine, free=station.name)
                    self._desk.step(job.id, State.QUEUED, words)

    def _has_work(self, station: Station) -> bool:
        if station.next_to_draw():
            return True
        return any(station in self._candidates(job) for job in self._desk.worked_on(State.QUEUED))

    def _may_have(self, station: Station, job: Job) -> bool:
        """And will get it: its own machine is away, or it would be planned for this one, which does nothing."""
        owner = self._desk.station(job.machine)
        if job.possible or owner is None or station not in self._candidates(job):
            return False
        return owner.away or (owner.draws and self._suits(job.id, station.name))
