"""What the simulated arm says and does."""

from __future__ import annotations

import math

import pytest

from firmware_protocol.dobot.commands import NONE_YET, question
from firmware_protocol.dobot.packet import Packet
from firmware_protocol.dobot.simulator.arm import Build
from tests.firmware_protocol.dobot.simulator.bench import Talk
from tests.firmware_protocol.dobot.vectors import VECTORS

POSE = question("Pose").encode()


def test_junk_before_a_packet_is_skipped() -> None:
    assert [packet.id for packet in Talk().send(b"\nM10" * 5 + b"\n\xaa\x00" + POSE)] == [10]


def test_wrong_checksums_and_unknown_ids_get_no_reply() -> None:
    talk = Talk()
    for vector in VECTORS:
        if not vector.get("sound", True):
            assert talk.send(bytes.fromhex(vector["request"])) == []
    assert talk.send(Packet(21, 1).encode()) == []
    assert talk.send(Packet(91, 3, bytes(14)).encode()) == []
    assert len(talk.send(POSE)) == 1


@pytest.mark.parametrize("client", ["pydobot", "pydobotplus", "pydobotlab", "dobotwrapperpy"])
def test_every_sound_request_of_a_client_is_replied_in_the_same_form(client: str) -> None:
    talk = Talk(build=Build(depth=1000))
    for vector in VECTORS:
        if vector["id"].startswith(client + "-") and "reply" in vector and not vector.get("malformed"):
            (reply,) = talk.send(bytes.fromhex(vector["request"]))
            captured = bytes.fromhex(vector["reply"])
            assert (reply.id, reply.ctrl) == (captured[3], captured[4])
            if vector["says"] and not isinstance(vector["says"][0], str) and reply.id not in {247, 41}:
                assert len(reply.params) == captured[2] - 2


@pytest.mark.parametrize("width", [4, 8])
def test_the_left_space_is_as_wide_as_wanted(width: int) -> None:
    (packet,) = Talk(left_bytes=width).send(question("LeftSpace").encode())
    assert packet.params == (32).to_bytes(width, "little")


def test_nothing_runs_before_the_queue_is_started() -> None:
    talk = Talk(running=False)
    talk.do("PTP 2 220 0 50 0")
    talk.wait(5.0)
    assert talk.place == (200.0, 0.0, 50.0)
    talk.do("StartExec")
    talk.wait(5.0)
    assert talk.place == (220.0, 0.0, 50.0)


@pytest.mark.parametrize(("first", "unused"), [(1, 0), (2, NONE_YET)])
def test_the_index_begins_where_it_is_said_and_tells_what_is_executed(first: int, unused: int) -> None:
    talk = Talk(build=Build(first_index=first, unused=unused), running=False)
    assert talk.ask("CurrentIndex") == (unused,)
    assert [talk.do("WAIT 1000") for _ in range(3)] == [first, first + 1, first + 2]
    talk.do("StartExec")
    talk.wait(1.5)
    assert talk.ask("CurrentIndex") == (first,)
    talk.wait(3.0)
    assert talk.ask("CurrentIndex") == (first + 2,)


def test_a_full_queue_takes_nothing_and_says_nothing() -> None:
    talk = Talk(build=Build(depth=4), running=False)
    assert [talk.do("WAIT 1") for _ in range(5)] == [1, 2, 3, 4, None]
    assert talk.ask("LeftSpace") == (0,)


@pytest.mark.parametrize(("holds", "left"), [(True, 30), (False, 31)])
def test_the_running_command_may_count_or_not(holds: bool, left: int) -> None:
    talk = Talk(build=Build(left_holds_running=holds))
    talk.do("WAIT 5000")
    talk.do("WAIT 5000")
    assert talk.ask("LeftSpace") == (left,)


def test_stop_ends_behind_the_running_command_and_force_stop_in_it() -> None:
    talk = Talk()
    for x in (250, 200):
        talk.do(f"CP 1 {x} 0 50 20")
    talk.do("StopExec")
    talk.wait(10.0)
    assert talk.place == (250.0, 0.0, 50.0)
    talk.do("StartExec")
    talk.wait(1.0)
    talk.do("ForceStopExec")
    assert 200.0 < talk.place[0] < 250.0
    before = talk.place
    talk.do("StartExec")
    talk.wait(5.0)
    assert talk.place == before


@pytest.mark.parametrize(("resets", "index"), [(False, 2), (True, 1)])
def test_clear_forgets_what_waits(resets: bool, index: int) -> None:
    talk = Talk(build=Build(clear_resets=resets), running=False)
    talk.do("PTP 2 220 0 50 0")
    talk.do("Clear")
    talk.do("StartExec")
    talk.wait(5.0)
    assert talk.place == (200.0, 0.0, 50.0)
    assert talk.do("WAIT 1") == index


@pytest.mark.parametrize("target", ["PTP 2 20 40 50 0", "CP 1 330 0 0 50", "PTP 1 -200 0 50 0"])
def test_a_target_out_of_reach_gets_an_index_and_stops_the_queue(target: str) -> None:
    talk = Talk()
    assert talk.do(target) == 1
    assert talk.do("PTP 2 220 0 50 0") == 2
    talk.wait(5.0)
    assert talk.alarms in {(0x11,), (0x12,)}
    assert (talk.place, talk.ask("CurrentIndex")) == ((200.0, 0.0, 50.0), (0,))
    talk.do("Alarms", queued=False)
    assert talk.alarms != ()
    talk.do("Clear")
    talk.do("Alarms", queued=False)
    talk.do("PTP 2 220 0 50 0")
    talk.wait(5.0)
    assert (talk.alarms, talk.place) == ((), (220.0, 0.0, 50.0))


def test_a_way_through_the_hole_stops_there_with_an_alarm_of_moving() -> None:
    talk = Talk(place=(0.0, 200.0, 0.0))
    talk.do("PTP 2 0 -200 0 0")
    talk.wait(10.0)
    assert talk.alarms in {(0x21,), (0x22,)}
    assert 80.0 < talk.place[1] < 120.0


def test_homing_works_with_an_alarm() -> None:
    talk = Talk(alarms=[0x50], place=(250.0, 30.0, 60.0), build=Build(home_s=4.0))
    talk.do("HOMEParams 210 0 40 0", queued=False)
    talk.do("HOME 0")
    talk.wait(3.5)
    assert talk.ask("CurrentIndex") == (0,)
    talk.wait(1.0)
    assert (talk.place, talk.alarms, talk.ask("CurrentIndex")) == ((210.0, 0.0, 40.0), (0x50,), (1,))


@pytest.mark.parametrize(
    ("mode", "target", "place"),
    [
        (0, "230 10 40", (230, 10, 40)),
        (1, "230 10 40", (230, 10, 40)),
        (2, "230 10 40", (230, 10, 40)),
        (4, "0 16.298519 32.773846", (200, 0, 50)),
        (7, "10 5 -10", (210, 5, 40)),
        (8, "10 5 -10", (210, 5, 40)),
        (9, "230 10 40", (230, 10, 40)),
    ],
)
def test_each_mode_goes_where_it_says(mode: int, target: str, place: tuple[float, ...]) -> None:
    talk = Talk()
    talk.do(f"PTP {mode} {target} 0")
    talk.wait(5.0)
    assert talk.place == pytest.approx(place, abs=2e-3)


def test_a_jump_goes_over_what_lies_between() -> None:
    talk = Talk(place=(200.0, 0.0, 30.0))
    talk.do("PTPJumpParams 15 100", queued=False)
    talk.do("PTP 9 240 0 30 0")
    heights = []
    for _ in range(40):
        talk.wait(0.02)
        heights.append(talk.sim.arm.now_at()[0][2])
    assert max(heights) == pytest.approx(45.0)


def test_joints_go_another_way_than_a_line() -> None:
    """From the same places: a line stays at x = 200, turning joints swing out."""
    ink = []
    for mode in (1, 2):
        talk = Talk(place=(200.0, -80.0, 0.0))
        talk.do(f"PTP {mode} 200 80 0 0")
        talk.settle()
        ink.append(talk.sim.ink[0])
    assert max(x for x, _ in ink[0]) == pytest.approx(math.hypot(200, 80), abs=0.1)
    assert {round(x, 6) for x, _ in ink[1]} == {200.0}


def test_cp_takes_the_time_that_its_speed_says() -> None:
    talk = Talk()
    talk.do("CP 1 250 0 50 25")
    talk.wait(1.9)
    assert talk.ask("CurrentIndex") == (0,)
    talk.wait(0.2)
    assert talk.ask("CurrentIndex") == (1,)


def test_ptp_takes_longer_with_a_smaller_ratio() -> None:
    def seconds(percent: int) -> float:
        talk = Talk()
        talk.do(f"PTPCommonParams {percent} {percent}", queued=False)
        talk.do("PTP 2 280 0 50 0")
        talk.settle()
        return talk.sim.now

    assert seconds(20) > 1.8 * seconds(80)


def test_a_jog_goes_on_until_it_is_ended_or_the_reach_is() -> None:
    talk = Talk()
    talk.do("JOG 0 1", queued=False)
    talk.wait(0.5)
    talk.do("JOG 0 0", queued=False)
    stood = talk.place
    talk.wait(0.5)
    assert talk.place == stood
    assert 205.0 < stood[0] < 230.0
    talk.do("JOG 1 4", queued=False)
    talk.wait(30.0)
    assert talk.ask("Pose")[5] == pytest.approx(0.0, abs=1.5)


def test_ink_is_where_the_pen_was_down_seen_from_the_sheet() -> None:
    talk = Talk(sheet_origin_mm=(190.0, -50.0))
    for text in ("PTP 2 200 0 0 0", "CP 1 220 0 0 50", "CP 1 220 10 0 50", "PTP 2 220 10 20 0", "PTP 2 240 0 20 0"):
        talk.do(text)
    talk.settle()
    assert talk.sim.ink == [[(10.0, 50.0), (30.0, 50.0), (30.0, 60.0)]]


def test_an_empty_queue_on_the_paper_is_counted_as_waiting() -> None:
    talk = Talk(place=(200.0, 0.0, 0.0))
    talk.do("CP 1 220 0 0 50")
    talk.wait(2.0)
    talk.do("CP 1 230 0 0 50")
    talk.settle()
    assert talk.sim.arm.waited_on_paper_s == pytest.approx(1.65, abs=0.05)
