"""One row of the fault table: a fault in a moment, what the session said of it, and what was on the sheet."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

Outcome: TypeAlias = Literal["ok", "wrong", "undetectable"]

VERDICT_WITHIN_S = 5.0
"""From the first sign of a fault to the verdict."""


@dataclass(frozen=True, slots=True)
class Row:
    """What one fault in one moment led to.

    machine: "grbl", "emco" or "dobot". moment: "travel", "mid stroke", "last line" or "pen change". sign: what the
    host can first see of the fault, empty when it sees nothing. verdict: the session's, as text. seconds: from the
    sign to the verdict, None where there is no sign. certainly, possibly: strokes as the session states them; true:
    strokes whose ink is whole on the simulated sheet. outcome: see `outcome_of`. limits: for an undetectable fault,
    what limits the harm; for a wrong row, what is wrong.
    """

    machine: str
    fault: str
    moment: str
    sign: str
    verdict: str
    seconds: float | None
    certainly: int
    possibly: int
    true: int
    outcome: Outcome
    limits: str = ""


def outcome_of(*, sign: str, seconds: float | None, certainly: int, possibly: int, true: int) -> Outcome:
    """ "undetectable" without a sign; "ok" when the verdict came in time and the truth lies within the statement."""
    if not sign:
        return "undetectable"
    in_time = seconds is not None and seconds <= VERDICT_WITHIN_S
    return "ok" if in_time and certainly <= true <= possibly else "wrong"
