"""The states of a job, the table of the steps between them, and what becomes of a job by how its drawing ended."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from firmware_protocol.session import Verdict


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


STEPS: dict[tuple[State, State], str] = {
    (State.QUEUED, State.PLANNING): "the worker is free",
    (State.PLANNING, State.PLANNED): "planned",
    (State.PLANNING, State.QUEUED): "the worker died for the first time, or the daemon ended",
    (State.PLANNED, State.WAITING): "no machine, or no sheet",
    (State.PLANNED, State.DRAWING): "its turn",
    (State.WAITING, State.DRAWING): "its turn",
    (State.DRAWING, State.DONE): "all strokes drawn",
    (State.DRAWING, State.PLANNED): "ended before the first stroke",
    (State.DRAWING, State.INTERRUPTED): "ended after it",
    (State.INTERRUPTED, State.WAITING): "resume JOB --from-stroke K",
    (State.FAILED, State.QUEUED): "retry JOB, where no ink is",
    (State.INTERRUPTED, State.CANCELLED): "cancel JOB",
    (State.QUEUED, State.FAILED): "its folder is gone",
    (State.PLANNING, State.FAILED): "it cannot be planned",
    (State.PLANNED, State.FAILED): "its folder is gone",
    (State.WAITING, State.FAILED): "its folder is gone",
    (State.DRAWING, State.FAILED): "a line is refused",
    **{
        (state, State.CANCELLED): "cancel JOB"
        for state in (State.QUEUED, State.PLANNING, State.PLANNED, State.WAITING, State.DRAWING)
    },
}
"""The steps there are, and why each is made; one that is not here is a mistake in the code."""

ALLOWED: dict[State, frozenset[State]] = {
    state: frozenset(after for before, after in STEPS if before is state) for state in State
}
"""From each state to the ones that may follow."""

OVER = frozenset({State.DONE, State.FAILED, State.CANCELLED, State.INTERRUPTED})
"""Here a job stays until a person says otherwise."""


@dataclass(frozen=True, slots=True)
class Meaning:
    """means: what is so in this state. remedy: what a person does about it."""

    means: str
    remedy: str


MEANINGS: dict[State, Meaning] = {
    State.QUEUED: Meaning("The picture lies in its job's folder. No ink.", "Nothing."),
    State.PLANNING: Meaning("The worker reads it. No ink.", "Nothing."),
    State.PLANNED: Meaning("Its program is ready. No ink.", "Nothing; `linedrawd go` where jobs are held."),
    State.WAITING: Meaning(
        "Ready, but there is no machine or no new sheet; its words say which.",
        "Plug the machine in, or put a sheet in and say `linedrawd next`.",
    ),
    State.DRAWING: Meaning("The machine draws it, or stands paused.", "`linedrawd pause`, `resume`, `stop`, `drain`."),
    State.DONE: Meaning("The last ink is on the sheet.", "`linedrawd again JOB` draws it once more."),
    State.FAILED: Meaning(
        "It cannot be planned, or the controller refused a line of it; its words say why.",
        "Mend that, then `linedrawd retry JOB`; where ink is on the sheet, a new sheet and `linedrawd again JOB`.",
    ),
    State.CANCELLED: Meaning("A person dropped it; its words say what is on the sheet.", "`linedrawd again JOB`."),
    State.INTERRUPTED: Meaning(
        "Its drawing ended early and ink is, or may be, on the sheet; its words say which strokes. All jobs are held.",
        "Look at the sheet. A new sheet and `linedrawd again JOB`; or, on the same sheet, the pen to its origin, "
        "`linedrawd machine origin` (or `home`), and `linedrawd resume JOB --from-stroke K`. `linedrawd go` for "
        "the other jobs.",
    ),
}


HOW_ON = "`linedrawd again {job}` on a new sheet, or `linedrawd resume {job} --from-stroke K` on this one"
"""What may become of a job that was interrupted."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """What becomes of a job whose drawing ended so. cause: in words. remedy: before the job is taken up again."""

    state: State
    cause: str
    remedy: str


OUTCOMES: dict[Verdict, Outcome] = {
    Verdict.FINISHED: Outcome(State.DONE, "everything is drawn", ""),
    Verdict.STOPPED: Outcome(
        State.INTERRUPTED, "a person, a full disk or the daemon's end stopped it", "clear what stopped it"
    ),
    Verdict.REJECTED: Outcome(State.FAILED, "the controller refused a line", "mend what its words name"),
    Verdict.ALARM: Outcome(
        State.INTERRUPTED, "limit switch, door or the like: the controller locked itself", "free the machine, unlock it"
    ),
    Verdict.RESTARTED: Outcome(
        State.INTERRUPTED, "power: the controller started anew and has forgotten its place", "see to its supply"
    ),
    Verdict.SILENT: Outcome(
        State.INTERRUPTED, "the controller answers no more", "switch it off and on, look at its cable"
    ),
    Verdict.ASTRAY: Outcome(State.INTERRUPTED, "the pen was not where it should be", "look what moved it"),
    Verdict.UNPLUGGED: Outcome(State.INTERRUPTED, "the cable came out", "plug it in"),
}
"""Where not one stroke is touched, a job that is INTERRUPTED here is PLANNED again instead; the others are held."""


def check_step(before: State, after: State) -> None:
    """Raises ValueError when the table lacks the step."""
    if after not in ALLOWED[before]:
        raise ValueError(f"a job does not go from {before.value} to {after.value}")


def outcome_of(verdict: Verdict, *, touched: bool, cancelled: bool) -> State:
    """The state of a job whose drawing ended so. touched: a stroke may be on the sheet. cancelled: by a person."""
    if cancelled and verdict is Verdict.STOPPED:
        return State.CANCELLED
    state = OUTCOMES[verdict].state
    return State.PLANNED if state is State.INTERRUPTED and not touched else state
