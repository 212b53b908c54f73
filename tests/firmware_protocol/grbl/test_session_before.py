"""What happens before the first line of a job is drawn: findings, settings, the dry run; and motors that rest."""

from __future__ import annotations

import pytest

from firmware_protocol.errors import LocalProtocolError
from firmware_protocol.grbl.habits import Patience
from firmware_protocol.grbl.states import State
from firmware_protocol.ink import PenRule
from firmware_protocol.session import Ended, Found, NotReady, Ready, Verdict, Waiting
from tests.firmware_protocol.grbl.driver import BANNER, IDLE, INFO, Line, Play, ready
from tests.firmware_protocol.grbl.pair import FAST, Pair, plotter, stroke_lines

CORNERS = [[(5.0, 5.0), (25.0, 5.0)], [(5.0, 10.0), (25.0, 10.0)]]
SERVO_PEN = PenRule(down_s=90, up_s=30)
SERVO = [Line("M3 S30"), *[Line(text, 0) for text in ("G0 X5", "M3 S90", "G4 P0.2", "G1 X9 F600", "M3 S30", "G4 P0.2")]]
SERVO_LIFT = ("G21 G90", "M3 S30", "G4 P0.2")
WANTING = FAST | {1: 25, 10: 1, 30: 60, 31: 40, 32: 1}


def found(pair: Pair) -> list[tuple[str, bool]]:
    return [(event.finding.command, event.mended) for event in pair.events if isinstance(event, Found)]


def test_findings_can_be_asked_for_without_a_job() -> None:
    pair = Pair(plotter(settings=FAST | {1: 25})).ready()
    assert [finding.command for finding in pair.session.findings()] == ["$1=255"]
    assert [finding.command for finding in pair.session.findings(SERVO)] == ["$1=255"]
    assert pair.session.state is State.READY


def test_what_is_found_is_told_once_and_again_when_it_has_changed() -> None:
    pair = Pair(plotter(settings=FAST | {1: 25})).ready()
    far = [*stroke_lines(CORNERS), Line("G0 X9000")]
    for lines, told in ((stroke_lines(CORNERS), ["$1=255"]), (stroke_lines(CORNERS), []), (far, [""])):
        pair.events.clear()
        pair.draw(lines)
        assert [command for command, _ in found(pair)] == told


def test_what_would_spoil_the_drawing_keeps_it_from_being_begun() -> None:
    pair = Pair(plotter(settings=WANTING), lift=SERVO_LIFT).ready()
    sent = pair.sent
    end = pair.draw(SERVO)
    assert (end.verdict, end.strokes_certain, end.strokes_possible) == (Verdict.REJECTED, 0, 0)
    assert end.position_known
    assert "$30=60 is the most that the servo gets" in end.why
    assert found(pair) == [(c, False) for c in ("$1=255", "$10=3", "$31=0", "$30=90", "$32=0")]
    assert pair.sent.rstrip(b"?") == sent.rstrip(b"?")
    assert pair.session.state is State.READY


def test_the_session_mends_settings_where_it_may_and_only_those_that_differ() -> None:
    pair = Pair(plotter(settings=WANTING, pen=SERVO_PEN), lift=SERVO_LIFT, may_set=True).ready()
    begun = len(pair.sent)
    end = pair.draw(SERVO)
    assert end.verdict is Verdict.FINISHED
    assert found(pair) == [(c, True) for c in ("$1=255", "$10=3", "$31=0", "$30=90", "$32=0")]
    assert pair.sent[begun:].replace(b"?", b"").startswith(b"$1=255\n$10=3\n$31=0\n$30=90\n$32=0\n$$\nM3 S30\n")
    assert pair.sim.lost_bytes == 0
    again = len(pair.sent)
    pair.events.clear()
    assert pair.draw(SERVO).verdict is Verdict.FINISHED
    assert b"$" not in pair.sent[again:]


def test_each_setting_waits_for_the_answer_to_the_one_before() -> None:
    play = Play(may_set=True)
    for lines in ((BANNER,), (IDLE,), INFO, ("$1=25", "$10=1", "ok")):
        play.say(*lines)
    assert play.start(Line("X1", 0)) == b"$1=255\n"
    assert [play.say("ok"), play.say("ok")] == [b"$10=3\n", b"$$\n"]
    assert play.say("$1=255", "$10=3", "ok").startswith(b"?X1\n")


def test_a_setting_that_does_not_stay_is_told_and_a_needed_one_ends_the_job() -> None:
    play = Play(may_set=True)
    for lines in ((BANNER,), (IDLE,), INFO, ("$1=25", "$32=1", "ok")):
        play.say(*lines)
    play.start(Line("M3 S90", 0))
    play.say("ok")
    play.say("ok")
    play.say("$1=255", "$32=1", "ok")
    assert [event.mended for event in play.events if isinstance(event, Found)] == [True, False]
    assert play.ended.verdict is Verdict.REJECTED
    assert "did not keep" in play.ended.why
    assert b"M3" not in play.sent


def test_a_setting_that_is_refused_ends_the_job() -> None:
    play = Play(may_set=True)
    for lines in ((BANNER,), (IDLE,), INFO, ("$1=25", "ok")):
        play.say(*lines)
    play.start(Line("X1", 0))
    play.say("error:3")
    assert (play.ended.verdict, play.session.state) == (Verdict.REJECTED, State.READY)
    assert "'$1=255'" in play.ended.why


def test_a_dry_run_comes_first_and_draws_nothing() -> None:
    pair = Pair(plotter(), dry_run=True).ready()
    pair.session.start(stroke_lines(CORNERS), pair.now)
    pair.wait_for(lambda: pair.session.state is State.STREAMING)
    assert pair.sent.count(b"$C\n") == 2
    assert pair.sim.ink == []
    assert pair.until(Ended).verdict is Verdict.FINISHED
    assert pair.sent.count(b"G1 X25.000 Y5.000 F1500\n") == 2
    assert len(pair.sim.ink) == 2


def test_a_line_that_the_dry_run_refuses_is_told_before_anything_is_drawn() -> None:
    pair = Pair(plotter(), dry_run=True).ready()
    lines = stroke_lines(CORNERS)
    end = pair.draw([*lines[:8], Line("G64", 1), *lines[8:]])
    assert (end.verdict, end.strokes_certain, end.strokes_possible) == (Verdict.REJECTED, 0, 0)
    assert (end.position_known, end.pen_lifted, pair.sim.ink) == (True, True, [])
    assert "line 9 ('G64') was refused with error:20" in end.why
    pair.events.clear()
    assert pair.draw(lines).verdict is Verdict.FINISHED


def test_dollar_lines_of_a_program_are_not_tried() -> None:
    play = ready(dry_run=True)
    assert play.start(Line("$H"), Line("G21"), Line("X1", 0)) == b"?$C\n"
    assert play.say("[MSG:Enabled]", "ok") == b"G21\nX1\n"
    assert play.say("ok", "error:9") == b"!?"
    assert play.say("<Check|MPos:0.000,0.000,0.000>") == b"\x18"
    play.say(BANNER)
    play.say("ok")
    assert "line 3 ('X1')" in play.ended.why


@pytest.mark.parametrize("moment_s", [0.005, 0.02])
def test_a_stop_in_a_dry_run_draws_nothing(moment_s: float) -> None:
    pair = Pair(plotter(), dry_run=True).ready()
    pair.session.start(stroke_lines(CORNERS), pair.now)
    pair.wait(moment_s)
    assert pair.session.state is State.TRYING
    pair.session.stop(pair.now)
    end = pair.until(Ended)
    assert (end.verdict, end.strokes_possible, pair.sim.ink) == (Verdict.STOPPED, 0, [])


def test_a_stop_while_check_mode_is_left_is_not_lost() -> None:
    pair = Pair(plotter(), dry_run=True).ready()
    pair.session.start(stroke_lines(CORNERS), pair.now)
    while pair.session.state is not State.LEAVING:
        pair.turn(pair.now + 0.01)
    pair.session.stop(pair.now)
    end = pair.until(Ended)
    assert (end.verdict, end.position_known, pair.sim.ink) == (Verdict.STOPPED, True, [])


def test_a_work_offset_is_in_place_where_the_machine_finds_its_home() -> None:
    homed = FAST | {22: 1, 20: 1}
    pair = Pair(plotter(settings=homed, switches_mm=(3.0, 3.0, 3.0)), home=True).ready()
    end = pair.draw(stroke_lines(CORNERS))
    assert end.verdict is Verdict.REJECTED
    assert "G10 L2 P1 X-200" in end.why


def test_the_origin_can_be_stored_and_a_stale_one_is_cleared_where_settings_may_be_mended() -> None:
    sim = plotter()
    pair = Pair(sim).ready()
    pair.session.start([Line("G21 G90"), Line("G0 X10 Y20")], pair.now)
    pair.until(Ended)
    pair.session.set_origin(pair.now)
    pair.until(Ready)
    pair.wait(2.0)
    assert pair.session.state is State.READY
    refused = Pair(sim)
    refused.until(NotReady)
    mended = Pair(sim, may_set=True).ready()
    assert mended.sent.count(b"G10 L2 P1 X0 Y0\n") == 1
    assert mended.draw(stroke_lines(CORNERS)).verdict is Verdict.FINISHED


def test_motors_that_rest_take_no_job_until_the_place_is_known_again() -> None:
    pair = Pair(plotter(), patience=Patience(motors_off_after_min=2.0)).ready()
    waiting = pair.until(Waiting, within_s=121.0)
    assert "the position is unknown" in waiting.why
    assert pair.session.state is State.RESTED
    with pytest.raises(LocalProtocolError, match="motors have been switched off"):
        pair.session.start(stroke_lines(CORNERS), pair.now)
    pair.wait(300.0)
    assert pair.session.state is State.RESTED
    pair.session.set_origin(pair.now)
    pair.until(Ready)
    assert pair.sent.count(b"$1=25\n") == 1
    assert b"$1=255\nG10 L20 P1 X0 Y0\n" in pair.sent
    assert pair.draw(stroke_lines(CORNERS)).verdict is Verdict.FINISHED


def test_motors_rest_only_after_so_long_without_a_job() -> None:
    pair = Pair(plotter(), patience=Patience(motors_off_after_min=1.0)).ready()
    pair.wait(50.0)
    pair.draw(stroke_lines(CORNERS))
    pair.wait(50.0)
    assert pair.session.state is State.READY


def test_homing_makes_the_place_known_again() -> None:
    settings = FAST | {22: 1}
    sim = plotter(settings=settings, switches_mm=(3.0, 3.0, 3.0))
    pair = Pair(sim, home=True, patience=Patience(motors_off_after_min=2.0)).ready()
    pair.until(Waiting, within_s=200.0)
    pair.session.home(pair.now)
    pair.until(Ready)
    assert pair.session.state is State.READY
    pair.session.home(pair.now)
    pair.until(Ready)


def test_between_jobs_only() -> None:
    play = ready()
    play.start(Line("X1", 0))
    for wish in (play.session.home, play.session.set_origin):
        with pytest.raises(LocalProtocolError, match="wait until it is idle"):
            wish(play.now)
