"""The fault table of GRBL holds what it says."""

from __future__ import annotations

import pytest

from firmware_protocol.grbl.simulator.faults import BrownOut, DropByte, FlipByte, Hang, HardLimit, LoseOk, Unplug
from tests.faults.grbl import AT_A_PEN_CHANGE, FAULTS, LINES, STROKES, Moment, rows
from tests.faults.row import VERDICT_WITHIN_S, Row

A_MOMENT = Moment("", 0.0, next(n for n, line in enumerate(LINES) if "X12.000" in line.text), 0, 0, 0)


@pytest.fixture(scope="module")
def table() -> list[Row]:
    return rows()


def test_every_fault_has_three_moments_and_no_row_is_wrong(table: list[Row]) -> None:
    assert len(table) == 3 * len(FAULTS) + len(AT_A_PEN_CHANGE)
    assert [row for row in table if row.outcome == "wrong"] == []
    assert all(row.seconds is not None and row.seconds <= VERDICT_WITHIN_S for row in table if row.outcome == "ok")


def test_of_a_machine_that_waits_for_a_pen_everybody_knows_what_is_drawn(table: list[Row]) -> None:
    waits = {row.fault: row for row in table if row.moment == "pen change"}
    assert {(row.certainly, row.true, row.possibly) for row in waits.values()} == {(STROKES // 2,) * 3}
    assert {name: row.verdict for name, row in waits.items()} == {
        "hang": "silent",
        "brown-out": "restarted",
        "limit switch": "alarm",
        "limit switch, alarm unsaid": "restarted",
        "unplug": "unplugged",
    }


def test_only_a_digit_that_the_controller_takes_is_undetectable_and_says_what_limits_it(table: list[Row]) -> None:
    unseen = [row for row in table if row.outcome == "undetectable"]
    assert {row.fault for row in unseen} <= {"flipped tenth of a short line"}
    assert all(row.limits for row in unseen)


@pytest.mark.parametrize("kind", [BrownOut, DropByte, FlipByte, Hang, HardLimit, LoseOk, Unplug])
def test_every_kind_of_fault_stands_in_the_table(kind: type) -> None:
    assert any(isinstance(fault, kind) for made in FAULTS.values() for fault in made(A_MOMENT))


def test_what_the_machine_says_of_itself_is_the_verdict(table: list[Row]) -> None:
    verdicts = {row.fault: row.verdict for row in table}
    assert verdicts["unplug"] == "unplugged"
    assert verdicts["limit switch"] == "alarm"
    assert (verdicts["brown-out"], verdicts["limit switch, alarm unsaid"]) == ("restarted", "restarted")
    assert (verdicts["hang"], verdicts["lost ok"]) == ("silent", "silent")
    assert verdicts["flip into a feed hold"] == "waiting, stopped"
    assert verdicts["flipped digit"] == "astray"
