"""A crooked machine draws what its axes make of what it was told."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest

from firmware_protocol.crooked import Crooked, CrookedInk
from firmware_protocol.ink import PenRule, Polyline


def drawn(crooked: Crooked, *points: tuple[float, float]) -> list[Polyline]:
    """By a pen that is down from the first point on."""
    ink = CrookedInk(PenRule(), crooked)
    for start, end in pairwise(points):
        ink.travel((*start, 0.0), (*end, 0.0))
    return ink.polylines


def test_a_true_machine_draws_what_it_was_told() -> None:
    assert drawn(Crooked(), (0, 0), (10, 0), (10, 5)) == [[(0, 0), (10, 0), (10, 5)]]


def test_scale_and_skew_move_each_point() -> None:
    (line,) = drawn(Crooked(1.01, 0.98, skew_deg=1.0), (0, 0), (100, 0), (100, 50))
    lean = math.radians(1)
    assert line[1] == pytest.approx((101, 0))
    assert line[2] == pytest.approx((101 + 49 * math.sin(lean), 49 * math.cos(lean)))


def test_an_axis_that_turns_round_stands_still_until_its_play_is_through() -> None:
    (line,) = drawn(Crooked(backlash_mm=(0.4, 0.0)), (0, 0), (10, 0), (10, 2), (5, 4))
    assert line == [pytest.approx(point) for point in [(0, 0), (9.8, 0), (9.8, 2), (9.8, 2.16), (5.2, 4)]]


def test_a_copy_draws_on_without_changing_the_first() -> None:
    ink = CrookedInk(PenRule(), Crooked(backlash_mm=(0.4, 0.0)))
    ink.travel((0, 0, 0), (10, 0, 0))
    other = ink.copy()
    other.travel((10, 0, 0), (9, 0, 0))
    assert len(ink.polylines[0]) < len(other.polylines[0])
    assert max(x for x, _ in other.polylines[0]) == pytest.approx(9.8)
    other.travel((9, 0, 0), (8, 0, 0))
    ink.travel((10, 0, 0), (11, 0, 0))
    assert ink.polylines[0][-1] == pytest.approx((10.8, 0))
