"""The states of a job and the table of the steps between them."""

from __future__ import annotations

from enum import Enum


class State(Enum):
    """Where a job stands. What a person can do about each stands in the words of its last event."""

    QUEUED = "queued"
    PLANNING = "planning"
    PLANNED = "planned"
    WAITING = "waiting"
    DRAWING = "drawing"
    DONE = "done"
    FAILED = "failed"
    CANCELLED = "cancelled"
    INTERRUPTED = "interrupted"


_ENDS = frozenset({State.FAILED, State.CANCELLED})
ALLOWED: dict[State, frozenset[State]] = {
    State.QUEUED: _ENDS | {State.PLANNING},
    # Back to the queue: the daemon ended before the plan did, and nothing has touched paper yet.
    State.PLANNING: _ENDS | {State.PLANNED, State.QUEUED},
    State.PLANNED: _ENDS | {State.WAITING, State.DRAWING},
    State.WAITING: _ENDS | {State.DRAWING},
    # Back to the planned ones: not one stroke of it has been touched.
    State.DRAWING: _ENDS | {State.DONE, State.INTERRUPTED, State.PLANNED},
    State.DONE: frozenset(),
    # Only where no ink is on the sheet, and a person says so: `retry`. A worker that crashed is tried once more.
    State.FAILED: frozenset({State.QUEUED}),
    State.CANCELLED: frozenset(),
    # Only where a person says from which stroke on: `resume JOB --from-stroke K`.
    State.INTERRUPTED: frozenset({State.CANCELLED, State.WAITING}),
}
"""From each state to the ones that may follow; a step that is not here is a mistake in the code."""


def check_step(before: State, after: State) -> None:
    """Raises ValueError when the table lacks the step."""
    if after not in ALLOWED[before]:
        raise ValueError(f"a job does not go from {before.value} to {after.value}")
