"""The rows of the arm: no verdict is late, and no stated prefix is wrong."""

from __future__ import annotations

import pytest

from tests.faults.dobot import AT_A_PEN_CHANGE, FAULTS, STROKES, rows
from tests.faults.row import Row


@pytest.fixture(scope="module")
def table() -> list[Row]:
    return rows()


def test_every_fault_has_a_row_for_each_moment(table: list[Row]) -> None:
    assert len(table) == len(FAULTS) * 3 + len(AT_A_PEN_CHANGE)
    assert {row.moment for row in table} == {"travel", "mid stroke", "last line", "pen change"}


def test_every_row_is_in_time_and_true(table: list[Row]) -> None:
    assert [row for row in table if row.outcome != "ok"] == []


def test_of_an_arm_that_waits_for_a_pen_everybody_knows_what_is_drawn(table: list[Row]) -> None:
    waits = [row for row in table if row.moment == "pen change"]
    assert {(row.certainly, row.true, row.possibly) for row in waits} == {(STROKES // 2,) * 3}


def test_what_the_wire_does_to_one_packet_is_got_over(table: list[Row]) -> None:
    one = [
        row for row in table if row.fault.startswith(("reply", "replies", "stray")) or row.fault == "command corrupt"
    ]
    assert {row.verdict for row in one} == {"finished"}
    assert {row.true for row in one} == {12}
