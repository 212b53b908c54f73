"""What is on the sheets of several machines is found wrong where it is."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from tests.torture.check import Checks
from tests.torture.sheet import Inked


def inked(*strokes: int) -> list[Inked | None]:
    return [Inked("1-a", stroke, whole=True) for stroke in strokes]


@pytest.mark.parametrize(
    ("left", "right", "doubled", "wrong"),
    [
        (inked(0, 1, 2), inked(), 0, 0),
        (inked(0, 1), inked(2), 1, 0),
        (inked(0, 1, 1), inked(), 1, 0),
        (inked(0, 1), inked(1), 2, 0),
        (inked(0), [None], 0, 1),
    ],
)
def test_no_stroke_is_there_twice_and_no_job_on_two_sheets(
    left: list[Inked | None], right: list[Inked | None], doubled: int, wrong: int
) -> None:
    nothing: Any = None
    machines: Any = [SimpleNamespace(name="left"), SimpleNamespace(name="right")]
    checks = Checks(nothing, machines)
    checks.known.update(left=left, right=right)
    checks.check_times()
    assert (len(checks.found.doubled), len(checks.found.wrong_prefix)) == (doubled, wrong)
