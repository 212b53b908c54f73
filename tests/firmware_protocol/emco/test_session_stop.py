"""A plain serial transfer that is stopped: what can still be said to the control, and what is told."""

from __future__ import annotations

from firmware_protocol.emco.session import Control
from firmware_protocol.emco.states import State
from firmware_protocol.session import Verdict
from tests.firmware_protocol.emco.test_session import LIFT, XOFF, Play, running


def test_a_stop_finishes_the_line_that_has_begun_lifts_and_ends_the_program() -> None:
    play = running(control=Control(on_stop=LIFT))
    assert play.sent == b"%\nG1 X0.0\nG1 X1."
    play.session.stop(play.now)
    assert play.wait(10) == b"0\nG0 Z5.0\nM30\n"
    play.wait(30)
    end = play.ended
    assert (end.verdict, end.strokes_certain, end.strokes_possible) == (Verdict.STOPPED, 0, 1)


def test_a_stop_whose_end_is_drawn_in_time_leaves_the_pen_up() -> None:
    play = running(control=Control(on_stop=LIFT), times=lambda texts: [0.1 * n for n in range(1, len(texts) + 1)])
    play.session.stop(play.now)
    play.wait(10)
    end = play.ended
    assert (end.verdict, end.pen_lifted, end.position_known, end.estimated) == (Verdict.STOPPED, True, True, True)
    assert (end.strokes_certain, end.strokes_possible) == (0, 1)
    assert play.session.state is State.READY


def test_a_stop_that_the_control_holds_is_told_in_time() -> None:
    play = running(control=Control(on_stop=LIFT))
    play.hear(XOFF)
    play.session.stop(play.now)
    play.wait(26)
    assert (play.ended.verdict, play.ended.pen_lifted) == (Verdict.STOPPED, False)
    assert "RESET" in play.ended.why
    assert play.session.state is State.LOST


def test_a_stop_without_such_lines_ends_the_sending() -> None:
    play = running()
    play.session.stop(play.now)
    assert play.wait(10) == b""
    end = play.ended
    assert (end.verdict, end.pen_lifted, end.position_known) == (Verdict.STOPPED, False, False)
    assert "feed hold" in end.why


def test_a_stop_before_the_first_xon_touches_nothing() -> None:
    play = Play(control=Control(on_stop=LIFT))
    play.start()
    play.session.stop(play.now)
    play.wait(1)
    end = play.ended
    assert (end.verdict, end.strokes_possible, end.position_known) == (Verdict.STOPPED, 0, True)
    assert play.sent == b""


def test_what_is_sent_cannot_be_stopped() -> None:
    play = running(control=Control(on_stop=LIFT))
    play.wait(20)
    play.session.stop(play.now)
    play.wait(1)
    end = play.ended
    assert (end.verdict, end.strokes_possible, end.pen_lifted) == (Verdict.STOPPED, 4, False)
