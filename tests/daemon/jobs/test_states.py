"""The table of states is whole, and what it lacks is a mistake."""

from __future__ import annotations

from itertools import pairwise

import pytest

from daemon.jobs.states import ALLOWED, MEANINGS, OUTCOMES, OVER, Reason, State, check_step, outcome_of
from firmware_protocol.session import Verdict


def test_every_state_stands_in_the_table() -> None:
    assert set(ALLOWED) == set(State)


def test_every_state_can_be_reached_from_the_queue() -> None:
    reached = {State.QUEUED}
    while new := {after for before in reached for after in ALLOWED[before]} - reached:
        reached |= new
    assert reached == set(State)


def test_a_job_goes_through_its_states_in_order() -> None:
    way = [State.QUEUED, State.PLANNING, State.PLANNED, State.WAITING, State.DRAWING, State.DONE]
    for before, after in pairwise(way):
        check_step(before, after)


@pytest.mark.parametrize("end", sorted(OVER, key=lambda state: state.value))
def test_a_job_that_has_ended_is_never_drawn_again(end: State) -> None:
    assert State.DRAWING not in ALLOWED[end]
    with pytest.raises(ValueError, match=f"from {end.value} to drawing"):
        check_step(end, State.DRAWING)


@pytest.mark.parametrize("verdict", Verdict)
@pytest.mark.parametrize("known", [True, False])
@pytest.mark.parametrize("cancelled", [True, False])
def test_what_may_have_touched_the_sheet_is_never_begun_again_by_itself(
    verdict: Verdict, known: bool, cancelled: bool
) -> None:
    after = outcome_of(verdict, touched=True, cancelled=cancelled, position_known=known)
    assert after[0] in OVER
    assert after in MEANINGS


@pytest.mark.parametrize("verdict", [verdict for verdict in Verdict if OUTCOMES[verdict].state is State.INTERRUPTED])
def test_what_has_touched_nothing_waits_for_its_turn(verdict: Verdict) -> None:
    assert outcome_of(verdict, touched=False, cancelled=False) == (State.PLANNED, Reason.NONE)
