"""A job on a sound link: streamed by counting, finished only when the last ink is on the paper."""

from __future__ import annotations

import pytest

from firmware_protocol.errors import LocalProtocolError
from firmware_protocol.session import Accepted, Status, Verdict
from tests.firmware_protocol.grbl.driver import BARRIER, DONE, IDLE, RUN, Line, drawing, ready


def test_the_job_is_followed_by_the_lift_and_a_barrier() -> None:
    play = ready(lift=("G90 G21", "G0 Z5"))
    assert play.start(Line("G1X1F500", 0)) == b"?G1X1F500\nG90 G21\nG0 Z5\n" + BARRIER


def test_every_answer_accepts_one_line_of_the_job_in_order() -> None:
    play = drawing()
    play.say(*["ok"] * 6)
    assert play.told == [Accepted(0), Accepted(1), Accepted(2), Accepted(3)]


def test_finished_needs_all_answers_the_barrier_and_idle() -> None:
    play = drawing()
    play.say(*["ok"] * 6, DONE)
    assert len(play.told) == 4
    assert play.say("ok") == b"?"
    play.say(DONE.replace("Idle", "Run"))
    assert len(play.told) == 4
    play.say(DONE)
    end = play.ended
    assert (end.verdict, end.strokes_certain, end.strokes_possible) == (Verdict.FINISHED, 2, 2)
    assert (end.position_known, end.pen_lifted) == (True, True)


def test_idle_during_a_dwell_is_not_the_end() -> None:
    play = drawing(Line("G4 P60"))
    for _ in range(62):
        play.say(IDLE)
        play.wait(1.0)
    assert play.told == []


def test_without_lift_lines_nothing_is_said_about_the_pen() -> None:
    play = drawing(Line("X1", 0), lift=())
    play.say("ok", "ok")
    play.say("<Idle|MPos:1.000,0.000,0.000|FS:0,0>")
    assert play.ended.pen_lifted is False


def test_the_next_job_starts_on_the_same_session() -> None:
    play = drawing()
    play.say(*["ok"] * 7)
    play.say(DONE)
    assert play.start(Line("X9", 0)).startswith(b"?X9\n")


def test_two_jobs_at_once_are_refused() -> None:
    play = drawing()
    with pytest.raises(LocalProtocolError, match="streaming"):
        play.start(Line("X9"))


def test_a_line_that_no_controller_takes_keeps_the_session_ready() -> None:
    play = ready()
    with pytest.raises(LocalProtocolError, match="line 2"):
        play.start(Line("X1"), Line("X2 (two)"))
    assert play.start(Line("X1")).startswith(b"?X1\n")


def test_no_byte_more_than_the_buffer_holds_is_on_its_way() -> None:
    play = drawing(*[Line(f"G1X{number:02}Y{number:02}", 0) for number in range(40)])
    assert play.sent.count(b"G1") == 128 // len("G1X00Y00\n")
    assert play.say("ok", "ok") == b"G1X14Y14\nG1X15Y15\n"


def test_line_by_line_keeps_one_line_on_its_way() -> None:
    play = drawing(flow="line")
    assert play.sent.endswith(b"?G1X1F500\n")
    assert play.say("ok") == b"X2\n"


def test_the_state_is_asked_five_times_a_second() -> None:
    play = drawing()
    asked = 0
    for _ in range(11):
        play.say(RUN)
        asked += play.wait(0.1).count(b"?")
    assert asked == 5


def test_each_report_tells_where_the_pen_is_in_the_coordinates_of_the_job() -> None:
    play = drawing()
    play.say("<Run|MPos:5.000,6.000,7.000|FS:500,0|WCO:1.000,1.000,1.000>")
    assert play.events == [Status("Run", (4.0, 5.0, 6.0))]


def test_homing_inside_a_job_is_not_silence() -> None:
    play = drawing(Line("$H"), Line("G1X1F500", 0))
    assert play.sent.endswith(b"?$H\n")
    assert play.wait(60.0) == b""
    assert play.say("<Home|MPos:-1.000,-1.000,-1.000>", "ok").startswith(b"?G1X1F500\n")
    assert play.told == [Accepted(0)]


def test_a_question_that_homing_swallowed_is_not_silence_afterwards() -> None:
    play = drawing(Line("$H"), Line("G1X1F500", 0))
    play.wait(60.0)
    play.say("ok")
    play.wait(4.9)
    assert play.told == [Accepted(0)]


def test_unasked_messages_and_strange_lines_change_nothing() -> None:
    play = drawing()
    play.say("[MSG:Pgm End]", ">G20:ok", "$1=25", "o", "[GC:G0]")
    assert play.told == []
    assert play.say("ok") == b""
    assert play.told == [Accepted(0)]
