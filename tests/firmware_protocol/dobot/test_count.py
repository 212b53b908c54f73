"""What indices tell of commands whose acknowledgement is missing."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from firmware_protocol.dobot.count import Count, Sent

MOVE, WAIT = 91, 110


def counted(*, by: int = 1) -> Count:
    """The arm has taken two commands; the last has index 10."""
    count = Count()
    for index in (10 - by, 10):
        count.sends(WAIT)
        count.hears(WAIT, index)
    return count


def test_an_acknowledgement_settles_its_command() -> None:
    count = counted()
    move = count.sends(MOVE)
    assert count.hears(MOVE, 11)
    assert move == Sent(MOVE, settled=True, index=11)
    assert count.last == 11


def test_a_gap_behind_a_command_says_that_it_was_taken() -> None:
    count = counted()
    move, _ = count.sends(MOVE), count.sends(WAIT)
    count.hears(WAIT, 12)
    assert move == Sent(MOVE, settled=True, index=11)


def test_no_gap_behind_a_command_says_that_it_was_not_taken() -> None:
    count = counted()
    move, _ = count.sends(MOVE), count.sends(WAIT)
    count.hears(WAIT, 11)
    assert move == Sent(MOVE, settled=True, index=None)


def test_of_two_waits_a_middle_index_can_be_explained_twice() -> None:
    count = counted()
    move, _, _ = count.sends(MOVE), count.sends(WAIT), count.sends(WAIT)
    count.hears(WAIT, 12)
    assert not move.settled
    count.hears(WAIT, 13)
    assert move == Sent(MOVE, settled=True, index=11)


def test_a_late_acknowledgement_is_not_that_of_the_next_of_its_kind() -> None:
    count = counted()
    count.sends(MOVE), count.sends(WAIT)
    count.hears(WAIT, 12)
    later = count.sends(MOVE)
    assert not count.hears(MOVE, 11)
    assert not later.settled
    count.hears(MOVE, 13)
    assert later.index == 13


def test_a_gap_says_nothing_before_the_arm_was_seen_to_count_by_one() -> None:
    count = counted(by=2)
    move, _ = count.sends(MOVE), count.sends(WAIT)
    count.hears(WAIT, 12)
    assert not move.settled
    count.sends(WAIT)
    count.hears(WAIT, 14)
    assert not move.settled


def test_an_arm_that_counts_otherwise_is_believed_its_own_acknowledgements() -> None:
    count = counted(by=3)
    move = count.sends(MOVE)
    count.hears(MOVE, 13)
    assert move == Sent(MOVE, settled=True, index=13)


def test_of_several_waits_at_the_start_any_may_be_the_first_that_was_taken() -> None:
    count = Count()
    count.sends(WAIT), count.sends(WAIT)
    count.hears(WAIT, 5)
    move = count.sends(MOVE)
    count.hears(MOVE, 7)
    assert (move.index, count.last, count.open) == (7, 7, [])


@given(st.lists(st.tuples(st.sampled_from([MOVE, WAIT]), st.booleans(), st.booleans()), max_size=8), st.randoms())
def test_what_is_called_certain_is_true(course: list[tuple[int, bool, bool]], random: object) -> None:
    """Commands are taken or not, acknowledgements are lost, and the others come in any order."""
    count, index, acknowledgements, fates = counted(), 10, [], []
    for number, taken, heard in course:
        index += taken
        fates.append((count.sends(number), index if taken else None))
        acknowledgements += [(number, index)] if taken and heard else []
    random.shuffle(acknowledgements)  # type: ignore[attr-defined]
    for number, at in acknowledgements:
        count.hears(number, at)
    assert [(sent.index, true) for sent, true in fates if sent.settled and sent.index != true] == []
