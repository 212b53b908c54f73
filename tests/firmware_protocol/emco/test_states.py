"""The table of states."""

from __future__ import annotations

from firmware_protocol.emco.states import TRANSITIONS, Signal, State


def test_every_state_can_be_reached_and_only_the_last_one_is_final() -> None:
    assert {State.READY, *TRANSITIONS.values()} == set(State)
    assert {state for state, _ in TRANSITIONS} == set(State) - {State.LOST}


def test_every_signal_means_something() -> None:
    assert {signal for _, signal in TRANSITIONS} == set(Signal)


def test_unplugging_ends_every_conversation() -> None:
    assert all(TRANSITIONS[state, Signal.UNPLUG] is State.LOST for state in State if state is not State.LOST)
