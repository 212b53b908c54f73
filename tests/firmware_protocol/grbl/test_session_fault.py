"""A job that a fault ends: alarm, restart, silence, unplugging."""

from __future__ import annotations

import pytest

from firmware_protocol.session import Accepted, Verdict
from tests.firmware_protocol.grbl.driver import ALARM, BANNER, BARRIER, HELD, IDLE, RUN, UNLOCK, Line, Play, drawing


def after(play: Play, seconds: float = 60.0) -> bytes:
    """What is still sent once the job is over."""
    play.say("ok", IDLE, BANNER)
    return play.wait(seconds)


def restarted(play: Play) -> None:
    """A restart, and the hold and the reset that follow it."""
    for line in (BANNER, HELD, BANNER):
        play.say(line)


@pytest.mark.parametrize(("code", "known"), [(1, False), (2, True), (3, False)])
def test_an_alarm_ends_the_job_and_nothing_more_is_sent(code: int, known: bool) -> None:
    play = drawing()
    assert play.say(f"ALARM:{code}") == b""
    assert (play.ended.verdict, play.ended.position_known, play.ended.pen_lifted) == (Verdict.ALARM, known, False)
    assert f"ALARM:{code}, " in play.ended.why
    assert after(play) == b""


def test_an_alarm_whose_line_was_lost_is_seen_in_the_report() -> None:
    play = drawing()
    play.say(ALARM)
    assert play.ended.verdict is Verdict.ALARM


def test_a_restart_empties_the_controller_and_then_only_lifts_the_pen() -> None:
    play = drawing()
    play.say("ok")
    assert play.say("", BANNER) == b"!?"
    assert play.say("ok", "error:22", HELD) == b"\x18"
    assert play.say("ok", "", BANNER) == b"?"
    assert [play.say(line) for line in (IDLE, "ok", "ok", "ok")] == [b"?G90 G21\n", b"G0 Z5\n", BARRIER, b""]
    end = play.ended
    assert (end.verdict, end.position_known, end.pen_lifted) == (Verdict.RESTARTED, False, True)
    assert (end.strokes_certain, end.strokes_possible) == (0, 2)
    assert "restarted by itself" in end.why
    assert play.told == [Accepted(0), end]
    assert after(play) == b""


def test_nothing_moves_after_a_restart_where_the_lift_is_switched_off() -> None:
    play = drawing(lift_after_restart=False)
    restarted(play)
    assert (play.ended.verdict, play.ended.pen_lifted) == (Verdict.RESTARTED, False)
    assert after(play) == b""


def test_nothing_moves_after_a_restart_into_an_alarm() -> None:
    play = drawing()
    assert play.say(BANNER, UNLOCK) + play.say(ALARM) == b"!?"
    assert (play.ended.verdict, play.ended.pen_lifted) == (Verdict.RESTARTED, False)


@pytest.mark.parametrize("spoken", [(), (HELD,), (HELD, BANNER), (HELD, BANNER, IDLE)])
def test_a_restarted_controller_that_says_no_more_is_given_up(spoken: tuple[str, ...]) -> None:
    play = drawing()
    play.say(BANNER)
    for line in spoken:
        play.say(line)
    play.wait(5.0)
    assert (play.ended.verdict, play.ended.position_known, play.ended.pen_lifted) == (Verdict.RESTARTED, False, False)


@pytest.mark.parametrize("again", [(BANNER,), (HELD, BANNER, BANNER), (HELD, BANNER, IDLE, BANNER)])
def test_one_more_restart_ends_the_attempts_to_lift(again: tuple[str, ...]) -> None:
    play = drawing()
    for line in (BANNER, *again):
        play.say(line)
    assert (play.ended.verdict, play.ended.pen_lifted) == (Verdict.RESTARTED, False)


@pytest.mark.parametrize("lines", [("ok",) * 7, ("error:20",), ("error:20", HELD)])
def test_a_restart_at_any_later_moment_is_no_planned_one(lines: tuple[str, ...]) -> None:
    play = drawing()
    for line in lines:
        play.say(line)
    if HELD in lines:
        play.say(BANNER)
    assert play.say(BANNER) == b"!?"


def test_a_refused_line_is_still_told_after_a_restart() -> None:
    play = drawing(lift=())
    play.say("error:20")
    restarted(play)
    assert play.ended.verdict is Verdict.RESTARTED
    assert "error:20" in play.ended.why


def test_silence_is_a_verdict_after_five_seconds_and_asks_the_machine_to_hold() -> None:
    play = drawing()
    play.say(RUN)
    play.wait(5.199)
    assert play.told == []
    assert play.wait(0.002) == b"!"
    assert (play.ended.verdict, play.ended.position_known) == (Verdict.SILENT, False)
    assert after(play) == b""


def test_a_line_without_an_end_is_silence_too() -> None:
    play = drawing()
    assert play.hear(b"x" * 2000) == b"!"
    assert play.ended.verdict is Verdict.SILENT
    assert "noise" in play.ended.why


def test_unplugging_ends_the_job() -> None:
    play = drawing()
    play.events += play.session.unplugged(play.now)
    assert (play.ended.verdict, play.ended.position_known, play.ended.pen_lifted) == (Verdict.UNPLUGGED, False, False)
    assert play.session.unplugged(play.now) == []


def test_what_was_sent_may_be_drawn_and_what_left_the_planner_is_drawn() -> None:
    play = drawing(*[Line(f"X{stroke:02}", stroke) for stroke in range(100)])
    play.say(*["ok"] * 30)
    play.say("ALARM:1")
    assert (play.ended.strokes_certain, play.ended.strokes_possible) == (30 - 21, 30 + 128 // 4)


def test_lines_that_take_no_room_in_the_planner_push_nothing_out_of_it() -> None:
    play = drawing(*[Line("X1", stroke) for stroke in range(100)])
    play.say(*["ok"] * 30)
    play.say("ALARM:1")
    assert play.ended.strokes_certain == 0
