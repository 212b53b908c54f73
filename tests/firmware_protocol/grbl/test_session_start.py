"""How a session gets from an open port to a controller that takes a job."""

from __future__ import annotations

import pytest

from firmware_protocol.errors import LocalProtocolError
from firmware_protocol.grbl.session import GrblSession
from firmware_protocol.session import Event, NotReady, Ready
from tests.firmware_protocol.grbl.driver import ALARM, BANNER, IDLE, INFO, RUN, SETTINGS, UNLOCK, Line, Play, ready


def why(play: Play) -> str:
    (event,) = play.told
    assert isinstance(event, NotReady)
    return event.why


def test_asks_state_version_and_settings_one_after_the_other() -> None:
    play = Play()
    assert play.wait(1.9) == b""
    assert [play.say(*lines) for lines in (("", BANNER), (IDLE,), INFO, SETTINGS)] == [b"?", b"?$I\n", b"$$\n", b"?"]
    assert play.told == [Ready("Grbl 1.1h.20190825", 128)]
    assert play.session.settings == {1: 255.0, 13: 0.0, 110: 500.0}


def test_the_buffer_is_as_large_as_the_controller_says() -> None:
    play = Play()
    for lines in ((BANNER,), (IDLE,), ("[VER:1.1f:]", "[OPT:V,35,1024]", "ok"), SETTINGS):
        play.say(*lines)
    assert play.told == [Ready("Grbl 1.1f", 1024)]


def test_a_clone_that_knows_no_build_info_is_taken_with_128_bytes() -> None:
    play = Play()
    for lines in ((BANNER,), (IDLE,), ("error:3",), SETTINGS):
        play.say(*lines)
    assert play.told == [Ready("Grbl 1.1h", 128)]


def test_a_stored_work_offset_in_the_plane_of_the_sheet_is_refused_with_the_cure() -> None:
    play = Play()
    for lines in ((BANNER,), ("<Idle|MPos:0.000,0.000,0.000|FS:0,0|WCO:-50.000,-30.000,0.000>",), INFO, SETTINGS):
        play.say(*lines)
    assert "(-50, -30) mm" in why(play)
    assert "G10 L2 P1 X0 Y0" in why(play)


def test_a_stored_height_of_the_pen_is_no_reason_to_refuse() -> None:
    play = Play()
    for lines in ((BANNER,), ("<Idle|MPos:0.000,0.000,0.000|FS:0,0|WCO:0.000,0.000,-12.500>",), INFO, SETTINGS):
        play.say(*lines)
    assert play.told == [Ready("Grbl 1.1h.20190825", 128)]


def test_a_controller_that_still_moves_is_asked_again() -> None:
    play = Play()
    play.say(BANNER)
    assert play.say(RUN) == b""
    assert play.wait(0.2) == b"?"
    assert play.say(IDLE) == b"?$I\n"
    play.say("error:8")
    assert play.say(IDLE) == b"?$I\n"


def test_a_banner_while_reading_begins_anew() -> None:
    play = Play()
    for lines in ((BANNER,), (IDLE,), INFO, (BANNER,), (IDLE,), INFO, SETTINGS):
        play.say(*lines)
    assert play.told == [Ready("Grbl 1.1h.20190825", 128)]


def test_a_board_that_was_not_reset_is_asked_and_then_reset() -> None:
    play = Play()
    assert play.wait(2.0) == b"?"
    assert play.say(IDLE) == b"\x18"
    assert play.say("", BANNER) == b"?"


def test_a_board_that_does_not_answer_is_reset_without_asking_twice() -> None:
    play = Play()
    assert play.wait(5.9) == b"?\x18"


def test_a_board_that_moves_is_not_reset() -> None:
    play = Play(banner_within_s=10.0)
    play.wait(2.0)
    play.say(RUN)
    assert b"\x18" not in play.wait(7.0)
    assert play.say(IDLE) == b"\x18"


def test_a_board_that_never_stands_still_takes_no_job() -> None:
    play = Play()
    play.wait(2.0)
    play.say(RUN)
    play.wait(4.0)
    assert "state Run" in why(play)


def test_nothing_on_the_port_is_not_ready_in_time() -> None:
    play = Play(banner_within_s=6.0)
    play.wait(5.999)
    assert play.told == []
    play.wait(0.001)
    assert "nothing answered within 6 s" in why(play)


def test_another_device_is_quoted() -> None:
    play = Play()
    play.say("M-Design plotter ready")
    play.wait(6.0)
    assert "not GRBL (it said 'M-Design plotter ready')" in why(play)


def test_an_endless_line_is_no_grbl() -> None:
    play = Play()
    play.hear(b"\xff" * 5000)
    assert "noise" in why(play)


def test_grbl_0_9_is_refused_by_name() -> None:
    play = Play()
    play.say("Grbl 0.9j ['$' for help]")
    assert "Grbl 0.9j" in why(play)


def test_an_alarm_lock_is_told_with_its_remedy_and_never_opened() -> None:
    play = Play()
    for lines in ((BANNER, UNLOCK), (ALARM,), INFO, SETTINGS):
        play.say(*lines)
    assert "locked by an alarm" in why(play)
    assert b"$X" not in play.sent


def test_a_safety_door_keeps_it_from_becoming_ready() -> None:
    play = Play()
    play.say(BANNER)
    for _ in range(30):
        play.say("<Door:1|MPos:0.000,0.000,0.000>")
        play.wait(0.2)
    assert "Door:1" in why(play)


def test_homing_opens_the_lock_where_it_is_wanted() -> None:
    play = Play(home=True)
    for lines in ((BANNER, UNLOCK), (ALARM,), INFO):
        play.say(*lines)
    assert play.say(*SETTINGS) == b"$H\n"
    play.say(ALARM)
    assert play.wait(60.0) == b""
    assert b"?" in play.say("ok")
    assert play.told == []
    play.say("<Idle|MPos:-299.000,-299.000,-1.000|FS:0,0>")
    assert Ready("Grbl 1.1h.20190825", 128) in play.told


@pytest.mark.parametrize(
    ("answer", "sentence"),
    [("error:5", "homing is switched off"), ("ALARM:9", "no limit switch"), (BANNER, "restarted")],
)
def test_homing_that_fails_says_why(answer: str, sentence: str) -> None:
    play = Play(home=True)
    for lines in ((BANNER,), (IDLE,), INFO, SETTINGS, (answer,)):
        play.say(*lines)
    assert sentence in why(play)


def test_homing_without_an_end_is_given_up() -> None:
    play = Play(home=True, home_within_s=90.0)
    for lines in ((BANNER,), (IDLE,), INFO, SETTINGS):
        play.say(*lines)
    play.wait(90.0)
    assert "homing has not ended after 90 s" in why(play)


@pytest.mark.parametrize(
    ("line", "sentence"), [(BANNER, "restarted by itself"), ("ALARM:1", "limit switch"), (ALARM, "alarm")]
)
def test_between_jobs_a_lost_position_is_told(line: str, sentence: str) -> None:
    play = ready()
    play.say(line)
    assert sentence in why(play)


def test_between_jobs_the_controller_is_asked_every_second_and_may_fall_silent() -> None:
    play = ready(silent_after_s=5.0)
    assert play.wait(4.999) == b"?" * 4
    assert play.told == []
    play.wait(0.001)
    assert "has not answered for 5 s" in why(play)


def test_between_jobs_an_unplugged_port_is_told() -> None:
    play = ready()
    told: list[Event] = play.session.unplugged(play.now)
    assert [type(event) for event in told] == [NotReady]


def test_no_job_starts_before_ready() -> None:
    with pytest.raises(LocalProtocolError, match="wait for Ready"):
        Play().start(Line("G1X1"))


def test_a_lift_that_no_controller_takes_is_refused_at_once() -> None:
    with pytest.raises(LocalProtocolError):
        GrblSession(now=0.0, lift=["G0 Z5 (up)"])
