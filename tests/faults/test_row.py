"""What counts as a good row of the fault table."""

from __future__ import annotations

import pytest

from tests.faults.row import Outcome, outcome_of


@pytest.mark.parametrize(
    ("sign", "seconds", "true", "outcome"),
    [
        ("alarm", 0.1, 3, "ok"),
        ("alarm", 5.1, 3, "wrong"),
        ("alarm", None, 3, "wrong"),
        ("alarm", 0.1, 2, "ok"),
        ("alarm", 0.1, 1, "wrong"),
        ("alarm", 0.1, 5, "wrong"),
        ("", None, 9, "undetectable"),
    ],
)
def test_the_verdict_comes_in_time_and_the_truth_lies_within(
    sign: str, seconds: float | None, true: int, outcome: Outcome
) -> None:
    assert outcome_of(sign=sign, seconds=seconds, certainly=2, possibly=4, true=true) == outcome
