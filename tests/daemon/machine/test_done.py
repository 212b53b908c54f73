"""Finished is said when all ink is on the sheet: fifty random jobs here, a thousand in `tests.benchmarks done`."""

from __future__ import annotations

from random import Random

import pytest

from tests.benchmarks.done import fault_of, random_job, same


@pytest.mark.parametrize("first", range(0, 50, 10))
def test_no_job_is_called_finished_before_its_last_ink(first: int) -> None:
    assert {seed: why for seed in range(first, first + 10) if (why := fault_of(seed))} == {}


def test_ink_that_ends_a_tenth_of_a_millimetre_early_is_noticed() -> None:
    strokes = random_job(Random(1)).strokes
    (x, y), last = strokes[-1][-1], len(strokes) - 1
    assert same(strokes, strokes)
    assert not same([*strokes[:last], [*strokes[-1][:-1], (x - 0.1, y)]], strokes)
    assert not same([*strokes[:last], strokes[-1][:-1]], strokes)
