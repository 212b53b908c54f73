"""A job's record in its own folder: what a journal that was lost is made again from."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

from daemon.jobs.folder import write_durably
from daemon.jobs.journal import UNTOLD, Job
from daemon.jobs.states import OVER, UNDER_THE_PEN, Reason, State, meaning_of

RECORD_NAME = "job.json"
_LOST = "the journal was lost and nobody has written down how far this drawing came: look at the sheet"


def write_record(folder: Path, job: Job) -> None:
    """`drawing` before the first ink may come, and what became of it after the last, each time whole and durable.

    Raises DiskTrouble, and FileNotFoundError where the folder has gone.
    """
    told = {"name": job.name, "state": job.state.value, "words": job.words, "changed_s": job.changed_s}
    told |= {"reason": job.reason.value, "remedy": meaning_of(job.state, job.reason).remedy}
    told |= {"strokes": job.strokes, "certain": job.certain, "possible": job.possible}
    told |= {"machine": job.machine, "bound_to": job.bound_to}
    write_durably(folder / RECORD_NAME, json.dumps(told).encode())


def read_record(folder: Path) -> Job | None:
    """The job as its folder tells it: where ink may have come that nobody counted it is interrupted, never queued.

    None where nothing was ever drawn and nothing recorded.
    """
    try:
        told = json.loads((folder / RECORD_NAME).read_text(encoding="utf-8"))
        extent = int(told["strokes"]), int(told["certain"]), int(told["possible"])
        reason = Reason(told.get("reason", ""))
        last = str(told["name"]), State(told["state"]), str(told["words"]), float(told["changed_s"])
        machines = str(told.get("machine", "")), str(told.get("bound_to", ""))
        job = Job(folder.name, *last, *extent, *machines, reason)
    except FileNotFoundError:
        planned = (folder / "program.gcode").exists()
        return _untold(Job(folder.name, folder.name, State.DRAWING, "", 0.0)) if planned else None
    except (OSError, ValueError, KeyError, TypeError):
        return _untold(Job(folder.name, folder.name, State.DRAWING, "", 0.0))
    if job.state in UNDER_THE_PEN:
        return _untold(job)
    if job.state is State.INTERRUPTED and job.reason is not Reason.POWER:
        # Whoever has lost its journal has been away, and the machine may have been moved meanwhile.
        return replace(job, reason=Reason.POSITION_UNKNOWN)
    return job if job.state in OVER else replace(job, state=State.QUEUED, words="", reason=Reason.NONE)


def _untold(job: Job) -> Job:
    return replace(job, state=State.INTERRUPTED, words=_LOST, possible=UNTOLD, reason=Reason.POSITION_UNKNOWN)
