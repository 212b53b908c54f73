"""The transition table holds together."""

from __future__ import annotations

import pytest

from firmware_protocol.grbl.states import TRANSITIONS, WITH_A_JOB, Signal, State

ALIVE = [state for state in State if state is not State.LOST]


def test_every_state_can_be_reached_from_the_first() -> None:
    reached = {State.WAITING}
    for _ in State:
        reached |= {after for (before, _), after in TRANSITIONS.items() if before in reached}
    assert reached == set(State)


def test_every_signal_has_a_meaning_somewhere() -> None:
    assert {signal for _, signal in TRANSITIONS} == set(Signal)


def test_nothing_leads_out_of_a_lost_conversation() -> None:
    assert not [key for key in TRANSITIONS if key[0] is State.LOST]


@pytest.mark.parametrize("state", ALIVE)
def test_silence_and_unplugging_end_every_state(state: State) -> None:
    assert TRANSITIONS[state, Signal.SILENCE] is State.LOST
    assert TRANSITIONS[state, Signal.UNPLUG] is State.LOST


@pytest.mark.parametrize("state", WITH_A_JOB)
def test_no_banner_leads_back_to_streaming(state: State) -> None:
    assert TRANSITIONS[state, Signal.BANNER] not in {State.STREAMING, State.READY}
