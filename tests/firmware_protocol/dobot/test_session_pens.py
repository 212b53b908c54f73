"""An arm that stands still where another pen is wanted."""

from __future__ import annotations

import pytest

from firmware_protocol.dobot.states import State
from firmware_protocol.session import Paused, Resumed, Verdict
from tests.firmware_protocol.dobot.bench import UP_MM, Bench, Line, strokes

PARK = Line(f"PTP 2 210.000 40.000 {UP_MM:.3f} 0.000", 1)


def in_two_pens() -> list[Line]:
    """Strokes 0 and 1, the pen change, strokes 2 and 3."""
    lines = strokes(4)
    first = next(number for number, line in enumerate(lines) if line.stroke == 2)
    return [*lines[:first], PARK, Line("M0", 1), *lines[first:]]


def changing() -> Bench:
    bench = Bench().ready().start(in_two_pens())
    bench.until(lambda: bench.session.state is State.PAUSED)
    return bench


def test_it_waits_parked_with_the_first_pen_drawn_and_nothing_of_the_next_one_begun() -> None:
    bench = changing()
    assert bench.all_of(Paused) == [Paused(2, None, change=True)]
    assert [round(each, 2) for each in bench.sim.arm.place] == [210.0, 40.0, UP_MM]
    assert len(bench.sim.ink) == 2
    assert (bench.session.strokes_certain, bench.session.strokes_touched) == (2, 2)
    bench.wait(3600)
    assert len(bench.sim.ink) == 2


def test_it_goes_on_with_the_next_pen_to_the_end() -> None:
    bench = changing()
    bench.session.resume(bench.now)
    bench.until(lambda: bench.over)
    assert (bench.ended.verdict, bench.ended.strokes_certain) == (Verdict.FINISHED, 4)
    assert [type(event) for event in bench.told if isinstance(event, Paused | Resumed)] == [Paused, Resumed]
    assert len(bench.sim.ink) == 4


@pytest.mark.parametrize("at_once", [False, True])
@pytest.mark.parametrize("after_s", [0.5, 2.5, 3.5, 4.3])
def test_a_pause_before_does_not_make_it_forget_the_pen(after_s: float, at_once: bool) -> None:
    bench = Bench().ready().start(in_two_pens())
    bench.wait(after_s)
    bench.session.pause(bench.now, at_once=at_once)
    while not bench.over:
        bench.until(lambda: bench.over or bench.session.state is State.PAUSED)
        if not bench.over:
            bench.session.resume(bench.now)
    assert [each.stroke for each in bench.all_of(Paused) if each.change] == [2]
    assert bench.ended.strokes_certain == 4


def test_stopped_at_the_pen_change_it_keeps_the_place_and_what_is_drawn() -> None:
    bench = changing()
    bench.session.stop(bench.now)
    bench.until(lambda: bench.over)
    end = bench.ended
    assert (end.verdict, end.strokes_certain, end.strokes_possible) == (Verdict.STOPPED, 2, 2)
    assert (end.position_known, end.pen_lifted) == (True, True)
