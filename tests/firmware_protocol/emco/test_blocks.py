"""Blocks are written as both controls read them, and read as the control that is meant reads them."""

from __future__ import annotations

import contextlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_protocol.emco.blocks import Alarm, Word, arc, number, rapid, read_block, straight
from firmware_protocol.emco.dialects import DIALECTS, FANUC, SIEMENS, Dialect

both = pytest.mark.parametrize("dialect", DIALECTS.values(), ids=list(DIALECTS))
coordinates = st.floats(-400, 400)


@pytest.mark.parametrize(
    ("value", "text"),
    [(1200, "1200.0"), (0.1234, "0.123"), (-0.0001, "0.0"), (12.5, "12.5"), (-3.25, "-3.25"), (1e-9, "0.0")],
)  # fmt: skip
def test_a_number_has_a_point_and_three_decimals_at_most(value: float, text: str) -> None:
    assert number(value) == text


@both
@given(x=coordinates, y=coordinates, feed=st.floats(0.001, 15_000))
def test_what_is_written_is_read_back(dialect: Dialect, x: float, y: float, feed: float) -> None:
    block = straight(x=x, y=y, feed_mm_min=feed)
    words = dict(read_block(block, dialect))
    assert words == pytest.approx({"G": 1, "X": x, "Y": y, "F": feed}, abs=0.00051)
    assert len(block) <= 80


@both
def test_arcs_and_rapids_are_read_back(dialect: Dialect) -> None:
    assert read_block(arc((30, 20), (0, -10), clockwise=True), dialect) == [
        Word("G", 2), Word("X", 30), Word("Y", 20), Word("I", 0), Word("J", -10),
    ]  # fmt: skip
    assert read_block(rapid(z=5), dialect) == [Word("G", 0), Word("Z", 5)]


def test_a_fanuc_control_reads_micrometres_where_the_point_is_missing() -> None:
    assert read_block("G1 X100 Y100. F100", FANUC) == [Word("G", 1), Word("X", 0.1), Word("Y", 100), Word("F", 100)]
    assert read_block("G1 X100", SIEMENS) == [Word("G", 1), Word("X", 100)]


def test_numbers_of_blocks_skip_marks_and_comments_are_passed_over() -> None:
    assert read_block("N10 G0 X1.0 ; to the left", SIEMENS) == [Word("G", 0), Word("X", 1)]
    assert read_block("/N10 G0 (to the left) X1.0", FANUC) == [Word("G", 0), Word("X", 1)]
    assert read_block(";$PATH=/_N_MPF_DIR", SIEMENS) == []


@pytest.mark.parametrize(
    ("text", "dialect"),
    [
        ("G1 X1e3", SIEMENS),
        ("g1 x1", SIEMENS),
        ("G1 X", SIEMENS),
        ("G1 (left) X1", SIEMENS),
        ("G1 X1 ; left", FANUC),
        ("G2 X1.0 CR=4.0", FANUC),
        ("G1 X1\x00", FANUC),
        ("G1 X1 Ä", FANUC),
        ("G1 X--1", FANUC),
        ("G1 " + "X1.0 " * 16, SIEMENS),
    ],
)
def test_what_is_no_block_raises_an_alarm(text: str, dialect: Dialect) -> None:
    with pytest.raises(Alarm):
        read_block(text, dialect)


@both
@given(text=st.text(max_size=90))
def test_noise_raises_nothing_but_an_alarm(dialect: Dialect, text: str) -> None:
    with contextlib.suppress(Alarm):
        read_block(text, dialect)
