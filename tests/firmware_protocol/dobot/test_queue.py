"""What the host knows of the arm's queue."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_protocol.dobot.commands import NONE_YET
from firmware_protocol.dobot.queue import USUAL_DEPTH, Queue


def queue(*indices: int | None, depth: int = 32, before: int = 0) -> Queue:
    filled = Queue(depth, before=before)
    for index in indices:
        filled.accept(index)
    return filled


@pytest.mark.parametrize("first", [1, 2, 1000])
def test_an_index_is_compared_never_computed(first: int) -> None:
    filled = queue(first, first + 1, first + 7)
    assert filled.read(first + 3)
    assert (filled.executed, filled.ahead) == (2, 1)
    assert filled.read(first + 9)
    assert (filled.executed, filled.ahead) == (3, 0)


@pytest.mark.parametrize("unused", [0, NONE_YET])
def test_nothing_is_executed_before_the_first_index(unused: int) -> None:
    filled = queue(1, 2, before=unused)
    assert filled.read(unused)
    assert filled.executed == 0


def test_indices_may_begin_anew_while_the_old_one_is_still_said() -> None:
    filled = queue(1, 2, before=57)
    assert filled.read(57)
    assert filled.executed == 0
    assert filled.read(1)
    assert filled.executed == 1


@pytest.mark.parametrize("said", [3, 0, NONE_YET])
def test_an_index_that_falls_is_a_restart(said: int) -> None:
    filled = queue(4, 5)
    assert filled.read(4)
    assert not filled.read(said)


def test_two_places_stay_free() -> None:
    filled = queue(*range(1, 30))
    assert filled.room
    filled.accept(30)
    assert not filled.room
    filled.read(1)
    assert filled.room


def test_a_depth_of_nothing_is_the_usual_one() -> None:
    assert queue(depth=0).depth == USUAL_DEPTH


def test_a_command_without_index_counts_when_a_later_one_is_executed() -> None:
    filled = queue(1, None, 3, 4)
    filled.read(3)
    assert (filled.executed, filled.ahead) == (2, 1)


def test_a_last_command_without_index_counts_by_an_index_beyond_all_known() -> None:
    filled = queue(1, None)
    filled.read(1)
    assert (filled.executed, filled.ahead) == (1, 1)
    filled.read(2)
    assert (filled.executed, filled.ahead) == (2, 0)


def test_an_acknowledgement_that_came_late_fills_the_gap() -> None:
    filled = queue(1, None, 3)
    filled.read(3)
    filled.late(2)
    assert (filled.executed, filled.unknown, filled.ahead) == (3, 0, 0)


def test_what_247_says_is_compared_with_what_is_known() -> None:
    filled = queue(1, 2, 3)
    filled.read(1)
    assert [filled.left_over(left) for left in (31, 30, 29)] == [-1, 0, 1]


@given(st.lists(st.integers(1, 5), min_size=1, max_size=40), st.data())
def test_never_more_is_called_executed_than_is(steps: list[int], data: st.DataObject) -> None:
    """Acknowledgements are lost, and those that follow are taken for the ones before."""
    indices = [sum(steps[: count + 1]) for count in range(len(steps))]
    lost = data.draw(st.sets(st.sampled_from(indices), max_size=3))
    heard = [index for index in indices if index not in lost]
    filled = queue(*heard, *[None] * len(lost))
    said = data.draw(st.sampled_from(indices))
    filled.read(said)
    assert filled.executed <= sum(index <= said for index in indices)
