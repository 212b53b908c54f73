"""Lines are counted into the controller's buffer, one answer a line."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_protocol.errors import LocalProtocolError
from firmware_protocol.grbl import flow
from firmware_protocol.grbl.flow import Flow


def test_lines_are_sent_until_the_buffer_is_full_to_the_last_byte() -> None:
    lines = Flow(["G1X1"] * 4, room_bytes=15)
    assert lines.take() == b"G1X1\nG1X1\nG1X1\n"
    assert lines.take() == b""


def test_each_answer_makes_room_for_its_line() -> None:
    lines = Flow(["G1X1"] * 4, room_bytes=15)
    lines.take()
    assert lines.answer() == 0
    assert lines.take() == b"G1X1\n"


def test_line_by_line_waits_for_each_answer() -> None:
    lines = Flow(["G1X1"] * 2, room_bytes=None)
    assert lines.take() == b"G1X1\n"
    assert lines.take() == b""
    lines.answer()
    assert lines.take() == b"G1X1\n"


def test_an_answer_that_nobody_asked_for_belongs_to_no_line() -> None:
    lines = Flow(["G1X1"], room_bytes=128)
    assert lines.answer() is None
    lines.take()
    assert (lines.answer(), lines.answer(), lines.done) == (0, None, True)


def test_a_full_planner_and_a_buffer_that_adds_up_prove_that_no_answer_is_missing() -> None:
    lines = Flow(["G1X1", "G1X22", "G1X333"], room_bytes=128)
    lines.take()
    lines.answer()
    lines.prove(12)
    assert lines.synced == 0
    lines.prove(7)
    assert lines.synced == 1
    lines.answer()
    lines.prove(0)
    assert lines.synced == 1
    lines.answer()
    assert lines.synced == 3


@pytest.mark.parametrize("deaf", ["$H", "G10 L2 P1 X0", "G28.1", "G30.1"])
def test_nothing_is_on_the_wire_beside_a_line_that_makes_the_controller_deaf(deaf: str) -> None:
    lines = Flow(["G4P0", deaf, "G4P0"], room_bytes=128)
    sent = [lines.take()]
    while lines.answer() is not None:
        sent.append(lines.take())
    assert sent == [b"G4P0\n", deaf.encode() + b"\n", b"G4P0\n", b""]


@given(st.lists(st.integers(1, 40), min_size=1, max_size=30), st.integers(41, 128), st.data())
def test_no_more_than_the_room_is_ever_unanswered(lengths: list[int], room_bytes: int, data: st.DataObject) -> None:
    texts = ["X" * length for length in lengths]
    lines, sent, answered = Flow(texts, room_bytes=room_bytes), b"", 0
    while not lines.done:
        sent += lines.take()
        unanswered = len(sent) - sum(len(text) + 1 for text in texts[:answered])
        assert 0 < unanswered <= room_bytes
        for _ in range(data.draw(st.integers(1, lines.owed))):
            lines.answer()
            answered += 1
    assert sent == b"".join(text.encode() + b"\n" for text in texts)


def test_a_dwell_is_proof_once_the_line_behind_it_is_answered() -> None:
    lines = Flow(["X1", "X2", "G4P0.1", "X3"], room_bytes=128)
    lines.take()
    drawn = []
    while lines.answer() is not None:
        drawn.append(lines.drawn)
    assert drawn == [0, 0, 0, 3]


@pytest.mark.parametrize("text", ["G40", "G43.1", "G4.1", "M3 S90", "G0 X4 M01"])
def test_other_words_are_no_barrier(text: str) -> None:
    lines = Flow([text, "X1"], room_bytes=128)
    lines.take()
    lines.answer()
    lines.answer()
    assert lines.drawn == 0


def test_dwells_of_unanswered_lines_add_up() -> None:
    lines = Flow(["G4 P9", "G4 P1.5", "G04P.25 ", "G4P2"], room_bytes=22)
    lines.take()
    lines.answer()
    assert lines.dwell_s == pytest.approx(1.5)


@pytest.mark.parametrize("text", ["G1 (wow!)", "G1 ; to", "G1?", "G1\n", "G1\tX1", "G1 \u00c4", "~", "G1\x18"])
def test_comments_and_realtime_characters_are_refused(text: str) -> None:
    with pytest.raises(LocalProtocolError, match=r"line 2 .*remove it"):
        flow.check(["G21", text], buffer_bytes=128)


def test_a_line_longer_than_the_controller_takes_is_refused() -> None:
    flow.check(["X" * 79], buffer_bytes=128)
    flow.check(["X" * 15], buffer_bytes=16)
    with pytest.raises(LocalProtocolError, match="79 characters"):
        flow.check(["X" * 80], buffer_bytes=128)
    with pytest.raises(LocalProtocolError, match="15 characters"):
        flow.check(["X" * 16], buffer_bytes=16)


def test_dollar_lines_stand_before_the_gcode() -> None:
    flow.check(["$H", "G21"], buffer_bytes=128)
    with pytest.raises(LocalProtocolError, match="put it before the G-code"):
        flow.check(["G21", "$H"], buffer_bytes=128)
