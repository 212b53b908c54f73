"""The rows of the EMCO control: no verdict is late, and no stated prefix is wrong."""

from __future__ import annotations

import pytest

from tests.faults.emco import FAULTS, LINKS, rows
from tests.faults.row import Row


@pytest.fixture(scope="module")
def table() -> list[Row]:
    return rows()


def test_every_fault_has_a_row_for_each_moment_on_each_link(table: list[Row]) -> None:
    assert len(table) == len(LINKS) * (len(FAULTS) + 1) * 3
    assert {row.moment for row in table} == {"travel", "mid stroke", "last line"}


def test_every_row_with_a_sign_is_in_time_and_true(table: list[Row]) -> None:
    assert [row for row in table if row.outcome == "wrong"] == []


def test_even_without_a_sign_nothing_is_stated_that_is_not_so(table: list[Row]) -> None:
    assert [row for row in table if not row.certainly <= row.true <= row.possibly] == []


def test_every_row_without_one_says_what_limits_the_harm(table: list[Row]) -> None:
    unseen = [row for row in table if row.outcome == "undetectable"]
    assert all(row.limits and "estimated" in row.verdict for row in unseen)


def test_acknowledged_blocks_show_every_fault_before_the_last_answer(table: list[Row]) -> None:
    early = [row for row in table if row.fault.startswith("blocks") and row.moment != "last line"]
    assert {row.outcome for row in early} == {"ok"}
