"""What the host knows of the arm's queue."""

from __future__ import annotations

import pytest

from firmware_protocol.dobot.commands import NONE_YET
from firmware_protocol.dobot.queue import USUAL_DEPTH, Queue


def queue(*indices: int, depth: int = 32, before: int = 0, stale: bool = False) -> Queue:
    filled = Queue(depth, before=before, stale=stale)
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
    filled = queue(1, 2, before=57, stale=True)
    assert filled.begins_anew(1)
    assert filled.read(57)
    assert filled.executed == 0
    assert filled.read(1)
    assert filled.executed == 1


def test_indices_that_go_on_are_believed_from_the_first_on() -> None:
    filled = queue(58, before=57, stale=True)
    assert not filled.begins_anew(58)
    assert filled.read(57)
    assert (filled.stale, filled.executed) == (False, 0)


def test_the_index_of_before_tells_nothing_of_a_new_command_with_the_same() -> None:
    filled = queue(before=1, stale=True)
    assert not filled.is_told_apart(1)
    assert filled.is_told_apart(2)


@pytest.mark.parametrize("said", [3, 0, NONE_YET])
def test_an_index_that_falls_is_told_and_not_believed(said: int) -> None:
    filled = queue(4, 5)
    assert filled.read(4)
    assert not filled.read(said)
    assert filled.executed == 1


def test_two_places_stay_free() -> None:
    filled = queue(*range(1, 30))
    assert filled.room(0)
    assert not filled.room(1)
    filled.accept(30)
    assert not filled.room(0)
    filled.read(1)
    assert filled.room(0)


def test_a_wait_takes_a_place_and_is_nothing_that_anyone_waits_for() -> None:
    filled = queue(1, 3)
    filled.accept_wait(2)
    assert (filled.accepted, filled.ahead) == (2, 3)
    filled.read(2)
    assert (filled.executed, filled.ahead) == (1, 1)


def test_a_depth_of_nothing_is_the_usual_one() -> None:
    assert queue(depth=0).depth == USUAL_DEPTH
