"""The states of a job and their reasons, the table of the steps between them, and what becomes of a job by how its
drawing ended.
"""

from __future__ import annotations

import re
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
    PAUSED = "paused"
    DONE = "done"
    FAILED = "failed"
    CANCELLED = "cancelled"
    INTERRUPTED = "interrupted"


class Reason(Enum):
    """Why a job is in its state, where that decides what a person does about it."""

    NONE = ""
    APPROVAL = "approval"
    PERSON = "person"
    DOOR = "door"
    AT_THE_MACHINE = "at the machine"
    POWER = "power"
    PEN_CHANGE = "pen change"
    CONTROLLER = "controller error"
    POSITION_KNOWN = "position known"
    POSITION_UNKNOWN = "position unknown"


STEPS: dict[tuple[State, State], str] = {
    (State.QUEUED, State.PLANNING): "the worker is free",
    (State.PLANNING, State.PLANNED): "planned",
    (State.PLANNING, State.QUEUED): "the worker died for the first time, the daemon ended, or another machine reaches",
    (State.PLANNING, State.WAITING): "planned, and a person has to approve it",
    (State.WAITING, State.PLANNED): "approve JOB",
    (State.PLANNED, State.WAITING): "no machine, or no sheet",
    (State.PLANNED, State.QUEUED): "another machine is free",
    (State.WAITING, State.QUEUED): "another machine is free",
    (State.PLANNED, State.DRAWING): "its turn",
    (State.WAITING, State.DRAWING): "its turn",
    (State.DRAWING, State.PAUSED): "pause, pen change, door, feed hold",
    (State.PAUSED, State.PAUSED): "for another reason",
    (State.PAUSED, State.DRAWING): "resume, cycle start",
    (State.INTERRUPTED, State.WAITING): "resume JOB --from-stroke K",
    (State.INTERRUPTED, State.INTERRUPTED): "the place of its pen is forgotten",
    (State.FAILED, State.QUEUED): "retry JOB, where no ink is",
    (State.INTERRUPTED, State.CANCELLED): "cancel JOB",
    (State.QUEUED, State.FAILED): "its folder is gone",
    (State.PLANNING, State.FAILED): "it cannot be planned",
    (State.PLANNED, State.FAILED): "its folder is gone",
    (State.WAITING, State.FAILED): "its folder is gone",
    **{
        (state, after): why
        for state in (State.DRAWING, State.PAUSED)
        for after, why in (
            (State.DONE, "all strokes drawn"),
            (State.PLANNED, "ended before the first stroke"),
            (State.INTERRUPTED, "ended after it"),
            (State.FAILED, "a line is refused"),
        )
    },
    **{
        (state, State.CANCELLED): "cancel JOB"
        for state in (State.QUEUED, State.PLANNING, State.PLANNED, State.WAITING, State.DRAWING, State.PAUSED)
    },
}
"""The steps there are, and why each is made; one that is not here is a mistake in the code."""

ALLOWED: dict[State, frozenset[State]] = {
    state: frozenset(after for before, after in STEPS if before is state) for state in State
}
"""From each state to the ones that may follow."""

UNDER_THE_PEN = frozenset({State.DRAWING, State.PAUSED})
"""The machine has begun it and not ended it; the journal's promises say what may be on the sheet."""

OVER = frozenset({State.DONE, State.FAILED, State.CANCELLED, State.INTERRUPTED})
"""Here a job stays until a person says otherwise."""


@dataclass(frozen=True, slots=True)
class Meaning:
    """means: what is so in this state. remedy: what a person does about it."""

    means: str
    remedy: str

    def remedy_at(self, machine: str) -> str:
        """The remedy where there are several machines: its commands name this one."""
        return _OF_A_MACHINE.sub(rf"`\1 --machine {machine}`", self.remedy)


_OF_A_MACHINE = re.compile(r"`(linedrawd (?:next|go|pause|resume|stop|drain|machine \w+))`")

MEANINGS: dict[tuple[State, Reason], Meaning] = {
    (State.QUEUED, Reason.NONE): Meaning("The picture lies in its job's folder. No ink.", "Nothing."),
    (State.PLANNING, Reason.NONE): Meaning("The worker reads it. No ink.", "Nothing."),
    (State.PLANNED, Reason.NONE): Meaning(
        "Its program is ready. No ink.", "Nothing; `linedrawd go` where jobs are held."
    ),
    (State.WAITING, Reason.NONE): Meaning(
        "Ready, but there is no machine or no new sheet; its words say which.",
        "Plug the machine in, or put a sheet in and say `linedrawd next`.",
    ),
    (State.WAITING, Reason.APPROVAL): Meaning(
        "Planned, and not drawn before a person has approved it; others are. No ink.",
        "Look at preview.html in its folder, then `linedrawd approve JOB` or `linedrawd cancel JOB`.",
    ),
    (State.DRAWING, Reason.NONE): Meaning("The machine draws it.", "`linedrawd pause`, `stop`, `drain`."),
    (State.PAUSED, Reason.PERSON): Meaning(
        "A person said `pause`: the pen is up, the machine stands.", "`linedrawd resume` goes on, `stop` ends it."
    ),
    (State.PAUSED, Reason.PEN_CHANGE): Meaning(
        "One pen has drawn all its lines; the machine is parked, its pen up, and waits for the next one.",
        "Put in the pen that its words name, then `linedrawd resume`, or press the button; `linedrawd stop` ends it.",
    ),
    (State.PAUSED, Reason.DOOR): Meaning(
        "The machine's safety door is open; the pen stands where it was, maybe on the sheet.",
        "Close the door, then press cycle start at the machine or say `linedrawd resume`; `stop` ends it.",
    ),
    (State.PAUSED, Reason.AT_THE_MACHINE): Meaning(
        "Somebody pressed feed hold at the machine; the pen stands where it was, maybe on the sheet.",
        "Press cycle start at the machine or say `linedrawd resume`; `stop` ends it.",
    ),
    (State.PAUSED, Reason.POWER): Meaning(
        "The controller sleeps: its motors have no power, so the place of the pen may be lost.",
        "`linedrawd stop`, then as for interrupted, position unknown.",
    ),
    (State.DONE, Reason.NONE): Meaning("The last ink is on the sheet.", "`linedrawd again JOB` draws it once more."),
    (State.FAILED, Reason.NONE): Meaning(
        "It cannot be planned, or its folder is gone; its words say why.",
        "Mend that, then `linedrawd retry JOB`, or drop the picture again.",
    ),
    (State.FAILED, Reason.CONTROLLER): Meaning(
        "The controller refused a line of it; its words say which, why, and what is on the sheet. All jobs are held.",
        "Mend that; `linedrawd retry JOB` where no ink is on the sheet, else a new sheet and `linedrawd again JOB`. "
        "`linedrawd go` for the other jobs.",
    ),
    (State.CANCELLED, Reason.NONE): Meaning(
        "A person dropped it; its words say what is on the sheet.", "`linedrawd again JOB`."
    ),
    (State.INTERRUPTED, Reason.POSITION_KNOWN): Meaning(
        "Its drawing was ended in order and the machine still knows where its pen is; ink is on the sheet, its words "
        "say which strokes. All jobs are held.",
        "Look at the sheet, then `linedrawd resume JOB --from-stroke K`, which neither homes nor asks for the origin; "
        "or a new sheet and `linedrawd again JOB`. `linedrawd go` for the other jobs.",
    ),
    (State.INTERRUPTED, Reason.POSITION_UNKNOWN): Meaning(
        "Its drawing ended early and nobody knows where the pen is; ink is, or may be, on the sheet, its words say "
        "which strokes. All jobs are held.",
        "Look at the sheet. A new sheet and `linedrawd again JOB`; or, on the same sheet, the pen to its origin, "
        "`linedrawd machine origin` (a machine that homes finds it by itself), and `linedrawd resume JOB "
        "--from-stroke K`. `linedrawd go` for the other jobs.",
    ),
    (State.INTERRUPTED, Reason.POWER): Meaning(
        "The controller lost its power, or was reset, and has forgotten where its pen is. Ink as above.",
        "See to its supply, then as for position unknown.",
    ),
}
"""What each state with each reason means; there are no others."""


HOW_ON = "`linedrawd again {job}` on a new sheet, or `linedrawd resume {job} --from-stroke K` on this one"
"""What may become of a job that was interrupted."""


def meaning_of(state: State, reason: Reason) -> Meaning:
    """Raises ValueError when the table lacks it."""
    if (state, reason) not in MEANINGS:
        raise ValueError(f"a job is not {state.value} for the reason {reason.value!r}")
    return MEANINGS[state, reason]


def ink_in_words(strokes: int, certain: int, possible: int) -> str:
    """Which strokes are certainly, possibly and not drawn; they are counted from 0."""
    return f"of {strokes} strokes {certain} are certainly drawn, none from {possible} on is touched"


@dataclass(frozen=True, slots=True)
class Outcome:
    """What becomes of a job whose drawing ended so. cause: in words. remedy: before the job is taken up again."""

    state: State
    cause: str
    remedy: str
    reason: Reason = Reason.NONE


OUTCOMES: dict[Verdict, Outcome] = {
    Verdict.FINISHED: Outcome(State.DONE, "everything is drawn", ""),
    Verdict.STOPPED: Outcome(
        State.INTERRUPTED, "a person, a full disk or the daemon's end stopped it", "clear what stopped it"
    ),
    Verdict.REJECTED: Outcome(
        State.FAILED, "the controller refused a line", "mend what its words name", Reason.CONTROLLER
    ),
    Verdict.ALARM: Outcome(
        State.INTERRUPTED, "limit switch, door or the like: the controller locked itself", "free the machine, unlock it"
    ),
    Verdict.RESTARTED: Outcome(
        State.INTERRUPTED,
        "power: the controller started anew and has forgotten its place",
        "see to its supply",
        Reason.POWER,
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


def outcome_of(
    verdict: Verdict, *, touched: bool, cancelled: bool, position_known: bool = False
) -> tuple[State, Reason]:
    """The state of a job whose drawing ended so, and its reason.

    touched: a stroke may be on the sheet. cancelled: by a person. position_known: the machine will go on knowing it.
    """
    if cancelled and verdict is Verdict.STOPPED:
        return State.CANCELLED, Reason.NONE
    outcome = OUTCOMES[verdict]
    if outcome.state is not State.INTERRUPTED:
        return outcome.state, outcome.reason
    if not touched:
        return State.PLANNED, Reason.NONE
    if outcome.reason is not Reason.NONE:
        return outcome.state, outcome.reason
    return outcome.state, Reason.POSITION_KNOWN if position_known else Reason.POSITION_UNKNOWN
