"""A machine that waits for somebody in the middle of a job, and homing that does not end."""

from __future__ import annotations

import pytest

from firmware_protocol.session import Ended, Resumed, Verdict, Waiting
from tests.firmware_protocol.grbl.driver import RUN, Line, Play, drawing
from tests.firmware_protocol.grbl.pair import TOUCHES_MM, Pair, missing_mm, plotter, stroke_lines

CORNERS = [[(5.0, 5.0), (25.0, 5.0)], [(5.0, 10.0), (25.0, 10.0)]]


def waiting(play: Play) -> list[str]:
    return [event.why for event in play.events if isinstance(event, Waiting)]


@pytest.mark.parametrize(("byte", "sentence", "cause"), [(b"!", "feed hold", "hold"), (b"\x84", "safety door", "door")])
def test_a_hold_and_a_door_that_nobody_asked_for_are_told_and_end_well(byte: bytes, sentence: str, cause: str) -> None:
    pair = Pair(plotter()).ready()
    pair.session.start(stroke_lines(CORNERS), pair.now)
    pair.wait(1.5)
    pair.sim.receive(byte, pair.now)
    told = pair.until(Waiting, within_s=5.0)
    assert (sentence in told.why, told.cause) == (True, cause)
    pair.wait(30.0)
    assert not any(isinstance(event, Resumed) for event in pair.events)
    pair.session.resume(pair.now)
    assert pair.until(Ended).verdict is Verdict.FINISHED
    assert sum(isinstance(event, Resumed) for event in pair.events) == 1
    assert missing_mm(CORNERS, pair.sim.ink) < TOUCHES_MM


def test_each_time_it_waits_is_told_once() -> None:
    play = drawing()
    held = "<Hold:0|MPos:0.500,0.000,0.000|FS:0,0>"
    play.say("<Hold:1|MPos:0.400,0.000,0.000|FS:9,0>", held, held, RUN, held)
    assert len(waiting(play)) == 2
    play.say("<Door:0|MPos:0.500,0.000,0.000|FS:0,0>")
    assert "safety door" in waiting(play)[-1]
    play.say("<Sleep|MPos:0.500,0.000,0.000|FS:0,0>")
    assert "sleeps" in waiting(play)[-1]


def test_homing_inside_a_job_is_given_up_in_time() -> None:
    play = drawing(Line("$H"), Line("G1X1F500", 0), home_within_s=90.0)
    play.wait(89.9)
    assert play.told == []
    play.wait(0.2)
    assert (play.ended.verdict, play.ended.position_known) == (Verdict.SILENT, False)
    assert "homing has not ended after 90 s" in play.ended.why
