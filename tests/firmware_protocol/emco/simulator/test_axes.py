"""Moves executed in time."""

from __future__ import annotations

import pytest

from firmware_protocol.emco.simulator.axes import Axes
from firmware_protocol.emco.simulator.interpreter import Move
from firmware_protocol.ink import PenRule

FIRST, SECOND = Move((0, 0, 0), (10, 0, 0), 10.0), Move((10, 0, 0), (20, 0, 0), 10.0)
RAMP_S = 10.0 / 100.0


def axes(*, ahead: int = 5) -> Axes:
    return Axes(ahead=ahead, acceleration_mm_s2=100.0, pen=PenRule())


def test_moves_that_follow_each_other_are_one_run() -> None:
    run = axes()
    run.add([FIRST], 0.0)
    run.add([SECOND], 0.5)
    run.advance(10.0)
    assert [at_s for at_s, _ in run.path] == pytest.approx([1 + RAMP_S, 2 + RAMP_S])


def test_axes_that_stand_begin_from_rest() -> None:
    run = axes()
    run.add([FIRST], 0.0)
    run.advance(5.0)
    run.add([SECOND], 5.0)
    assert run.next_s() == pytest.approx(6 + RAMP_S)


def test_room_is_counted_in_blocks_and_made_by_the_end_of_one() -> None:
    run = axes(ahead=1)
    run.add([FIRST, SECOND], 0.0)
    run.advance(1.5)
    assert not run.has_room
    run.advance(2.2)
    assert run.has_room


def test_a_stop_cuts_the_line_where_it_is() -> None:
    run = axes()
    run.add([FIRST], 0.0)
    run.stop(0.55)
    assert run.position_mm(1.0) == pytest.approx((5, 0, 0))
    run.add([Move((5, 0, 0), (5, 5, 0), 10.0)], 1.0)
    run.advance(5.0)
    assert run.ink(5.0).polylines == [[(0, 0), pytest.approx((5, 0))], [pytest.approx((5, 0)), (5, 5)]]
