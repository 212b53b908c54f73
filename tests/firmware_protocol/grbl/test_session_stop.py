"""A job that is stopped, by a person, by a refused line or for a lost answer: hold, reset, lift."""

from __future__ import annotations

import pytest

from firmware_protocol.session import Accepted, Verdict
from tests.firmware_protocol.grbl.driver import (
    ALARM,
    BANNER,
    BARRIER,
    HELD,
    IDLE,
    LIFT,
    RUN,
    UNLOCK,
    Line,
    Play,
    drawing,
)

SLOWING = "<Hold:1|MPos:8.000,0.000,0.000|FS:100,0>"


def lift(play: Play) -> None:
    for _ in range(len(LIFT) + 1):
        play.say("ok")


def test_a_stop_holds_resets_and_lifts_without_losing_the_position() -> None:
    play = drawing()
    play.say("ok")
    assert play.stop() == b"!?"
    assert play.say(SLOWING) == b""
    assert play.wait(0.1) == b"?"
    assert play.say(HELD) == b"\x18"
    assert [play.say("", BANNER), play.say("ok"), play.say("ok")] == [b"?G90 G21\n", b"G0 Z5\n", BARRIER]
    assert play.told == [Accepted(0)]
    play.say("ok")
    end = play.ended
    assert (end.verdict, end.position_known, end.pen_lifted) == (Verdict.STOPPED, True, True)


def test_after_a_stop_the_session_takes_the_next_job() -> None:
    play = drawing()
    play.stop()
    play.say(HELD)
    play.say(BANNER)
    lift(play)
    assert play.start(Line("X9", 0)).startswith(b"?X9\n")


def test_no_line_of_the_job_is_sent_after_a_stop() -> None:
    play = drawing(*[Line("G1X1.000Y1.000", 0)] * 40)
    play.stop()
    already = play.sent.count(b"G1")
    for lines in (("ok",) * 3, (HELD,), ("ok", BANNER), ("ok",) * 3):
        play.say(*lines)
    assert play.sent.count(b"G1") == already


def stopped_after_30_of_50(held: str) -> Play:
    play = drawing(*[Line(f"X{stroke:02}", stroke) for stroke in range(50)])
    play.say(*["ok"] * 30)
    play.stop()
    play.say(held)
    play.say(BANNER)
    lift(play)
    return play


def test_after_a_hold_only_answered_lines_and_the_one_behind_may_be_drawn() -> None:
    play = stopped_after_30_of_50("<Hold:0|MPos:20.000,5.000,0.000|FS:0,0>")
    assert (play.ended.strokes_certain, play.ended.strokes_possible) == (9, 31)


def test_where_the_pen_was_held_tells_which_line_was_cut() -> None:
    play = stopped_after_30_of_50("<Hold:0|MPos:20.500,0.000,0.000|FS:0,0>")
    assert (play.ended.strokes_certain, play.ended.strokes_possible) == (21, 22)


@pytest.mark.parametrize("early", [RUN, IDLE])
def test_the_hold_is_repeated_while_reports_show_that_it_was_not_heard(early: str) -> None:
    play = drawing()
    play.stop()
    assert play.say(early) == b"!"


def test_a_controller_that_does_not_hear_the_hold_is_reset_in_motion() -> None:
    play = drawing()
    play.stop()
    sent = b""
    for _ in range(40):
        sent += play.say(RUN) + play.wait(0.1)
    assert sent.count(b"\x18") == 1
    play.say("ALARM:3")
    assert (play.ended.verdict, play.ended.position_known, play.ended.pen_lifted) == (Verdict.ALARM, False, False)


@pytest.mark.parametrize("stands", ["<Check>", "<Door:0>", "<Door:1>", "<Sleep>"])
def test_other_states_without_motion_are_left_by_a_reset_too(stands: str) -> None:
    play = drawing()
    play.stop()
    assert play.say(stands) == b"\x18"


def test_a_door_that_is_still_slowing_is_waited_for() -> None:
    play = drawing()
    play.stop()
    assert play.say("<Door:2>") == b""


def test_a_stop_while_homing_resets_at_once_and_says_that_the_position_is_unknown() -> None:
    play = drawing(Line("$H"), Line("X1", 0))
    assert play.stop() == b"\x18"
    assert (play.ended.verdict, play.ended.position_known, play.ended.pen_lifted) == (Verdict.STOPPED, False, False)


def test_a_stop_in_the_last_motion_stops_it() -> None:
    play = drawing()
    play.say(*["ok"] * 7)
    assert play.stop() == b"!?"


def test_a_second_stop_and_a_stop_without_a_job_change_nothing() -> None:
    play = drawing()
    play.stop()
    assert play.stop() == b""
    play.say(HELD)
    play.say(BANNER)
    lift(play)
    assert play.stop() == b""


def test_a_refused_line_ends_the_job_with_its_text_and_the_meaning() -> None:
    play = drawing()
    play.say("ok")
    assert play.say("error:20") == b"!?"
    play.say("ok", HELD)
    play.say(BANNER)
    lift(play)
    end = play.ended
    assert (end.verdict, end.position_known, end.pen_lifted) == (Verdict.REJECTED, True, True)
    assert "line 2 ('X2') was refused with error:20" in end.why
    assert "GRBL does not know this command" in end.why
    assert play.told[:2] == [Accepted(0), Accepted(2)]


def test_only_the_first_refused_line_is_the_reason() -> None:
    play = drawing()
    play.say("error:20", "error:22", HELD)
    play.say(BANNER)
    lift(play)
    assert "error:20" in play.ended.why
    assert "error:22" not in play.ended.why


def test_a_lift_that_is_refused_is_told() -> None:
    play = drawing()
    play.stop()
    play.say(HELD)
    play.say(BANNER, UNLOCK)
    play.say("error:9")
    end = play.ended
    assert (end.verdict, end.position_known, end.pen_lifted) == (Verdict.STOPPED, False, False)
    assert "error:9" in end.why
    assert "before that: stopped on request" in end.why


def test_a_stray_answer_before_the_banner_is_not_taken_for_the_lift() -> None:
    play = drawing()
    play.stop()
    play.say(HELD)
    assert play.say("ok", "", BANNER) == b"?G90 G21\n"
    assert play.say("ok") == b"G0 Z5\n"


def test_an_answer_that_never_comes_stops_the_job_though_reports_come() -> None:
    play = drawing()
    play.say("ok")
    for _ in range(26):
        play.say(IDLE)
        play.wait(0.2)
    assert play.sent.count(b"!") == 1
    play.say(HELD)
    play.say(BANNER)
    lift(play)
    end = play.ended
    assert (end.verdict, end.position_known, end.pen_lifted) == (Verdict.SILENT, True, True)
    assert "without answering line 2 ('X2')" in end.why


def test_an_alarm_while_holding_is_the_verdict() -> None:
    play = drawing()
    play.stop()
    play.say(ALARM)
    assert (play.ended.verdict, play.ended.pen_lifted) == (Verdict.ALARM, False)


def test_no_banner_after_the_reset_is_silence() -> None:
    play = drawing()
    play.stop()
    play.say(HELD)
    play.wait(5.0)
    assert (play.ended.verdict, play.ended.position_known) == (Verdict.SILENT, False)


def test_a_build_that_reports_line_numbers_gets_them_and_tells_what_is_drawn() -> None:
    play = Play(lift=LIFT)
    for lines in ((BANNER,), (IDLE,), ("[VER:1.1h:]", "[OPT:VN,14,128]", "ok"), ("$1=255", "ok")):
        play.say(*lines)
    play.events.clear()
    assert play.start(*[Line(f"X{n:02}", n) for n in range(50)]).startswith(b"?N1X00\nN2X01\n")
    play.say(*["ok"] * 15)
    play.say("<Run|MPos:11.500,0.000,0.000|FS:0,0|Ln:13>")
    play.say("ALARM:1")
    assert (play.ended.strokes_certain, play.ended.strokes_possible) == (12, play.sent.count(b"N"))


def test_the_line_number_in_the_hold_names_the_line_that_was_cut() -> None:
    play = Play(lift=LIFT)
    for lines in ((BANNER,), (IDLE,), ("[VER:1.1h:]", "[OPT:VN,14,128]", "ok"), ("$1=255", "ok")):
        play.say(*lines)
    play.events.clear()
    # There and back on one line: the place alone would leave open which of the moves was cut.
    play.start(*[Line(f"X{n % 2}9", n) for n in range(50)])
    play.say(*["ok"] * 10)
    play.stop()
    play.say("<Hold:0|MPos:15.000,0.000,0.000|FS:0,0|Ln:6>")
    play.say(BANNER)
    lift(play)
    assert (play.ended.strokes_certain, play.ended.strokes_possible) == (5, 6)
