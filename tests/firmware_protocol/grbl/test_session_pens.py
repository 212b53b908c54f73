"""A job that stands still where another pen is wanted, parked, with nothing behind it sent."""

from __future__ import annotations

from typing import Any

import pytest

from firmware_protocol.grbl.states import State
from firmware_protocol.session import Accepted, Ended, Paused, Resumed, Verdict
from tests.firmware_protocol.grbl.driver import Line
from tests.firmware_protocol.grbl.pair import TOUCHES_MM, Pair, missing_mm, plotter, stroke_lines

STROKES = [[(10.0 * x, 0.0), (10.0 * x, 10.0), (10.0 * x + 5, 10.0)] for x in range(4)]
PARK = Line("G0 X3 Y40", 1)


def in_two_pens() -> list[Line]:
    """Strokes 0 and 1, the pen change, strokes 2 and 3."""
    lines = stroke_lines(STROKES)
    first = next(number for number, line in enumerate(lines) if line.stroke == 2)
    return [*lines[:first], PARK, Line("M0", 1), *lines[first:]]


def changing(**options: Any) -> tuple[Pair, Paused]:
    """A job that waits for its second pen."""
    pair = Pair(plotter(), **options).ready()
    pair.session.start(in_two_pens(), pair.now)
    return pair, pair.until(Paused)


@pytest.mark.parametrize("options", [{}, {"flow": "line"}, {"dry_run": True}])
def test_it_waits_parked_with_the_first_pen_drawn_and_nothing_of_the_next_one_sent(options: dict[str, Any]) -> None:
    pair, paused = changing(**options)
    assert paused == Paused(2, None, change=True)
    assert pair.pen_up
    assert pair.sim.position_mm[:2] == (3.0, 40.0)
    assert missing_mm(STROKES[:2], pair.sim.ink) <= TOUCHES_MM
    assert (pair.session.strokes_certain, pair.session.strokes_touched) == (2, 2)
    sent, ink = pair.sent.count(b"\n"), len(pair.sim.ink)
    pair.wait(3600)
    assert (pair.sent.count(b"\n"), len(pair.sim.ink)) == (sent, ink)


def test_it_goes_on_with_the_next_pen_to_the_end() -> None:
    pair, _ = changing()
    pair.session.resume(pair.now)
    end = pair.until(Ended)
    assert (end.verdict, end.strokes_certain) == (Verdict.FINISHED, 4)
    assert [type(event) for event in pair.events if isinstance(event, Paused | Resumed)] == [Paused, Resumed]
    assert missing_mm(STROKES, pair.sim.ink) <= TOUCHES_MM
    lines = in_two_pens()
    accepted = [event.line for event in pair.events if isinstance(event, Accepted)]
    assert accepted == [number for number, line in enumerate(lines) if line.text != "M0"]


@pytest.mark.parametrize("at_once", [False, True])
@pytest.mark.parametrize("after_s", [0.2, 0.8, 1.4, 2.0])
def test_a_pause_before_does_not_make_it_forget_the_pen(after_s: float, at_once: bool) -> None:
    pair = Pair(plotter()).ready()
    pair.session.start(in_two_pens(), pair.now)
    pair.wait(after_s)
    pair.session.pause(pair.now, at_once=at_once)
    stands: list[Paused] = []
    while pair.session.state is not State.READY:
        pair.wait_for(lambda: pair.session.state in (State.PAUSED, State.READY))
        if pair.session.state is State.PAUSED:
            stands.append([event for event in pair.events if isinstance(event, Paused)][-1])
            pair.session.resume(pair.now)
    assert [each.stroke for each in stands if each.change] == [2]
    assert missing_mm(STROKES, pair.sim.ink) <= TOUCHES_MM


def test_a_pause_on_the_way_to_where_the_pen_is_changed_does_not_end_it() -> None:
    pair = Pair(plotter()).ready()
    pair.session.start(in_two_pens(), pair.now)
    pair.wait_for(lambda: pair.pen_up and pair.sim.position_mm[1] > 15.0)
    pair.session.pause(pair.now, at_once=True)
    assert not pair.until(Paused).change
    pair.session.resume(pair.now)
    assert pair.until(Paused).change
    assert pair.sim.position_mm[:2] == (3.0, 40.0)


@pytest.mark.parametrize("at_once", [False, True])
def test_going_on_stopped_before_its_first_stroke_the_strokes_before_stay_on_the_sheet(at_once: bool) -> None:
    pair = Pair(plotter()).ready()
    pair.session.start([line for line in in_two_pens() if line.stroke is None or line.stroke > 2], pair.now)
    pair.session.pause(pair.now, at_once=at_once)
    pair.until(Paused)
    assert (pair.session.strokes_certain, pair.session.strokes_touched) == (3, 3)
    pair.session.stop(pair.now)
    end = pair.until(Ended)
    assert (end.strokes_certain, end.strokes_possible) == (3, 3)


def test_stopped_at_the_pen_change_it_keeps_the_place_and_what_is_drawn() -> None:
    pair, _ = changing()
    pair.session.stop(pair.now)
    end = pair.until(Ended)
    assert (end.verdict, end.strokes_certain, end.strokes_possible) == (Verdict.STOPPED, 2, 2)
    assert (end.position_known, end.pen_lifted) == (True, True)


def test_unplugged_at_the_pen_change_the_first_pen_is_drawn_for_certain() -> None:
    pair, _ = changing()
    (end,) = [event for event in pair.session.unplugged(pair.now) if isinstance(event, Ended)]
    assert (end.verdict, end.strokes_certain, end.strokes_possible) == (Verdict.UNPLUGGED, 2, 2)
