"""A job that stands still and goes on: behind a stroke, or at once and from the cut on."""

from __future__ import annotations

import math

import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from firmware_protocol.errors import LocalProtocolError
from firmware_protocol.grbl.states import State
from firmware_protocol.ink import PenRule
from firmware_protocol.session import Accepted, Ended, Paused, Resumed, Verdict
from tests.firmware_protocol.grbl.driver import Line, drawing, ready
from tests.firmware_protocol.grbl.pair import FAST, TOUCHES_MM, Pair, missing_mm, plotter, stroke_lines

COMB = [[(2.0 * x, 0.0), (2.0 * x, 10.0), (2.0 * x + 1, 10.0), (2.0 * x + 1, 0.0)] for x in range(8)]


def circle(x: float, radius: float, *, clockwise: bool) -> list[tuple[float, float]]:
    turn = -math.tau if clockwise else math.tau
    return [(x + radius * math.cos(turn * n / 200), 10 + radius * math.sin(turn * n / 200)) for n in range(201)]


ARCS = [
    Line("G21 G90 G0 Z5"),
    *(Line(text, 0) for text in ("G0 X15 Y10", "G1 Z0 F600", "G2 X15 Y10 I-5 J0 F1200", "G0 Z5")),
    *(Line(text, 1) for text in ("G0 X35 Y10", "G1 Z0", "G3 X25 Y10 I-5 J0", "X35 Y10 I5 J0", "G0 Z5")),
]
RINGS = [circle(10, 5, clockwise=True), circle(30, 5, clockwise=False)]
INCHES = [
    Line("G20 G91 G0 Z0.2"),
    *(Line(text, 0) for text in ("G0 X1 Y0", "G1 Z-0.2 F30", "Y0.5 F50", "X0.5", "G0 Z0.2")),
    *(Line(text, 1) for text in ("G0 X0.5", "G1 Z-0.2 F30", "Y-0.5 F50", "G0 Z0.2")),
]
STEPS = [[(25.4, 0.0), (25.4, 12.7), (38.1, 12.7)], [(50.8, 12.7), (50.8, 0.0)]]
SERVO = [
    Line("G21 G90"),
    Line("M3 S30"),
    *(Line(text, 0) for text in ("G0 X5 Y5", "M3 S90", "G4 P0.2", "G1 X25 Y5 F1500", "Y25", "M3 S30", "G4 P0.2")),
    *(Line(text, 1) for text in ("G0 X40 Y5", "S90", "G4 P0.2", "G1 Y25", "X60", "S30", "G4 P0.2")),
]
ANGLES = [[(5.0, 5.0), (25.0, 5.0), (25.0, 25.0)], [(40.0, 5.0), (40.0, 25.0), (60.0, 25.0)]]


def servo_plotter() -> Pair:
    pen = PenRule(down_s=90, up_s=30)
    return Pair(plotter(pen=pen), lift=("G21 G90", "M3 S30", "G4 P0.2"))


def test_a_pause_comes_behind_the_stroke_with_the_pen_up_and_the_rest_follows() -> None:
    pair = Pair(plotter()).ready()
    pair.session.start(stroke_lines(COMB), pair.now)
    pair.wait(1.0)
    pair.session.pause(pair.now)
    paused = pair.until(Paused)
    assert paused.stroke is not None
    assert 0 < paused.stroke < len(COMB)
    assert paused.at_mm is None
    assert pair.pen_up
    assert (len(pair.sim.ink), pair.session.state) == (paused.stroke, State.PAUSED)
    pair.wait(60.0)
    assert len(pair.sim.ink) == paused.stroke
    pair.session.resume(pair.now)
    end = pair.until(Ended)
    assert (end.verdict, end.strokes_certain, len(pair.sim.ink)) == (Verdict.FINISHED, len(COMB), len(COMB))
    assert missing_mm(COMB, pair.sim.ink) < TOUCHES_MM
    assert [type(event) for event in pair.events if isinstance(event, Paused | Resumed)] == [Paused, Resumed]


def test_lines_are_accepted_once_whatever_is_sent_again() -> None:
    pair = Pair(plotter()).ready()
    lines = stroke_lines(COMB)
    pair.session.start(lines, pair.now)
    pair.wait(1.5)
    pair.session.pause(pair.now, at_once=True)
    pair.until(Paused)
    pair.session.resume(pair.now)
    pair.until(Ended)
    assert [event.line for event in pair.events if isinstance(event, Accepted)] == list(range(len(lines)))


PROGRAMS = {
    "comb": (stroke_lines(COMB), COMB),
    "arcs": (ARCS, RINGS),
    "inches, relative": (INCHES, STEPS),
    "servo": (SERVO, ANGLES),
}


@settings(max_examples=60, deadline=None, phases=[Phase.explicit, Phase.reuse, Phase.generate])
@given(st.sampled_from(sorted(PROGRAMS)), st.floats(0.0, 7.0), st.booleans(), st.floats(0.0, 3.0))
def test_what_is_paused_and_resumed_is_drawn_whole_and_nothing_else(
    name: str, after_s: float, at_once: bool, again_s: float
) -> None:
    lines, wanted = PROGRAMS[name]
    pair = (servo_plotter() if name == "servo" else Pair(plotter())).ready()
    pair.session.start(lines, pair.now)
    for moment_s in (after_s, again_s):
        pair.wait(moment_s)
        pair.session.pause(pair.now, at_once=at_once)
        pair.wait_for(lambda: pair.session.state in {State.PAUSED, State.READY})
        if pair.session.state is State.PAUSED:
            pair.wait(1.0)
            pair.session.resume(pair.now)
    pair.wait_for(lambda: any(isinstance(event, Ended) for event in pair.events))
    (end,) = [event for event in pair.events if isinstance(event, Ended)]
    assert (end.verdict, end.pen_lifted) == (Verdict.FINISHED, True)
    assert missing_mm(wanted, pair.sim.ink) < TOUCHES_MM
    # The pen stands on the sheet when the machine is switched on.
    assert missing_mm(pair.sim.ink, [*wanted, [(0.0, 0.0)]]) < TOUCHES_MM


def test_a_pause_at_once_lifts_the_pen_where_it_was_and_says_where() -> None:
    pair = Pair(plotter()).ready()
    pair.session.start(stroke_lines([[(0, 0), (100, 0)]], feed=600), pair.now)
    pair.wait(5.0)
    pair.session.pause(pair.now, at_once=True)
    paused = pair.until(Paused, within_s=2.0)
    assert (paused.stroke, pair.pen_up) == (0, True)
    assert paused.at_mm == pytest.approx(pair.sim.ink[0][-1], abs=0.01)
    pair.session.resume(pair.now)
    assert pair.until(Ended).verdict is Verdict.FINISHED
    first, second = pair.sim.ink
    assert second[0] == pytest.approx((first[-1][0] - 0.3, 0.0), abs=0.01)


@pytest.mark.parametrize("at_once", [False, True])
def test_a_paused_job_can_be_stopped_and_says_what_is_drawn(at_once: bool) -> None:
    pair = Pair(plotter()).ready()
    pair.session.start(stroke_lines(COMB), pair.now)
    pair.wait(2.5)
    pair.session.pause(pair.now, at_once=at_once)
    paused = pair.until(Paused)
    pair.session.stop(pair.now)
    end = pair.until(Ended)
    assert (end.verdict, end.position_known, end.pen_lifted) == (Verdict.STOPPED, True, True)
    assert end.strokes_certain == paused.stroke
    assert len(pair.sim.ink) <= end.strokes_possible <= len(pair.sim.ink) + 1


def test_a_stop_while_the_machine_is_brought_to_a_stand_ends_the_job() -> None:
    pair = Pair(plotter()).ready()
    pair.session.start(stroke_lines(COMB), pair.now)
    pair.wait(2.5)
    pair.session.pause(pair.now, at_once=True)
    pair.session.stop(pair.now)
    assert pair.until(Ended).verdict is Verdict.STOPPED
    assert not [event for event in pair.events if isinstance(event, Paused)]


def test_an_alarm_in_a_pause_ends_the_job() -> None:
    play = drawing(Line("G1X1F500", 0), *[Line(f"X{n}", n) for n in range(2, 60)])
    play.session.pause(play.now)
    assert play.session.state is State.PAUSING
    play.say("ALARM:1")
    assert play.ended.verdict is Verdict.ALARM


def test_a_pause_when_all_lines_are_sent_changes_nothing() -> None:
    play = drawing()
    play.session.pause(play.now)
    assert play.session.state is State.STREAMING


def test_a_pause_at_once_needs_lines_that_raise_the_pen() -> None:
    play = drawing(lift=())
    with pytest.raises(LocalProtocolError, match="raise the pen"):
        play.session.pause(play.now, at_once=True)


def test_nothing_that_does_not_stand_goes_on() -> None:
    play = ready()
    with pytest.raises(LocalProtocolError, match="nothing is paused"):
        play.session.resume(play.now)


def test_where_the_cut_is_not_known_the_job_ends() -> None:
    play = drawing()
    play.session.pause(play.now, at_once=True)
    play.say("<Hold:0|MPos:50.000,50.000,0.000|FS:0,0>")
    play.say("Grbl 1.1h ['$' for help]")
    for _ in range(3):
        play.say("ok")
    assert (play.ended.verdict, play.ended.pen_lifted) == (Verdict.STOPPED, True)
    assert "the place where the line was cut is not known" in play.ended.why


def test_the_settings_of_the_simulated_plotter_are_those_that_a_session_wants() -> None:
    assert (FAST[1], FAST[10]) == (255, 3)
