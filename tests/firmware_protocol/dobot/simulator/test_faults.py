"""The simulated arm and its faults: what is lost, late or damaged on the wire, and what becomes of the arm itself."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

from firmware_protocol.dobot.commands import parse, question
from firmware_protocol.dobot.simulator.arm import Build
from firmware_protocol.dobot.simulator.faults import (
    ClosePort,
    CorruptReply,
    CorruptRequest,
    DelayReply,
    DropReply,
    Hang,
    PowerCut,
    RaiseAlarm,
    StopQueue,
    StrayByte,
)
from firmware_protocol.dobot.simulator.simulator import BOOT_S
from tests.firmware_protocol.dobot.simulator.bench import Talk

POSE = question("Pose").encode()


def test_a_dropped_reply_leaves_what_was_done_done() -> None:
    talk = Talk(faults=[DropReply(1)])
    assert [talk.do("WAIT 1") for _ in range(3)] == [1, None, 3]


def test_a_late_reply_comes_later() -> None:
    talk = Talk(faults=[DelayReply(0, by_s=0.5)])
    assert talk.do("WAIT 1") is None
    assert [packet.id for packet in talk.wait(0.6)] == [110]


def test_a_corrupt_reply_is_no_packet_and_a_stray_byte_comes_before_one() -> None:
    talk = Talk(faults=[CorruptReply(0), StrayByte(1)])
    assert [talk.do("WAIT 1") for _ in range(2)] == [None, 2]
    assert talk.reader.damaged == 1


def test_a_corrupt_request_is_not_taken() -> None:
    talk = Talk(faults=[CorruptRequest(1)])
    assert [talk.do("WAIT 1") for _ in range(3)] == [1, None, 2]


def test_questions_are_counted_apart() -> None:
    talk = Talk(faults=[DropReply(1, answers=True)])
    assert talk.do("WAIT 1") == 1
    assert [len(talk.send(POSE)) for _ in range(2)] == [0, 1]  # the start of the queue was answer 0


def test_a_pulled_cable_lets_the_arm_go_on() -> None:
    talk = Talk(faults=[ClosePort(after_acks=1)])
    talk.do("CP 1 250 0 0 50")
    assert talk.sim.unplugged
    talk.sim.advance(10.0)
    assert talk.sim.arm.place == pytest.approx((250.0, 0.0, 0.0))
    talk.sim.open(11.0)
    assert not talk.sim.unplugged


def test_a_power_cut_loses_queue_and_place() -> None:
    talk = Talk(faults=[PowerCut(at_s=0.6)], place=(200.0, 0.0, 0.0))
    talk.do("CP 1 200 100 0 100")
    talk.do("CP 1 250 100 0 100")
    talk.wait(0.6)
    assert talk.send(POSE) == []
    talk.wait(BOOT_S)
    assert (talk.alarms, talk.ask("LeftSpace"), talk.ask("CurrentIndex")) == ((0,), (32,), (0,))
    x, y, z = talk.place
    assert (y, z) == (0.0, 0.0)
    talk.do("Alarms", queued=False)
    talk.do("StartExec")
    before = talk.sim.ink[-1][-1]
    talk.do(f"CP 1 {x + 20} 0 0 100")
    talk.settle()
    after = talk.sim.ink[-1][-1]
    # It believes that it moves along x, and moves along the direction in which it stood.
    assert math.atan2(after[1] - before[1], after[0] - before[0]) == pytest.approx(math.atan2(before[1], before[0]))
    assert before[1] == pytest.approx(60.0, abs=6.0)


def test_homing_finds_the_place_again() -> None:
    talk = Talk(faults=[PowerCut(at_s=0.1)], place=(150.0, 150.0, 50.0), build=Build(home_s=1.0))
    talk.wait(2.0)
    talk.do("StartExec")
    talk.do("HOME 0")
    talk.settle()
    talk.do("Alarms", queued=False)
    talk.do("PTP 2 220 0 0 0")
    talk.do("CP 1 230 0 0 50")
    talk.settle()
    assert talk.sim.ink[-1][-1] == pytest.approx((230.0, 0.0))


def test_a_hang_is_the_end_of_words_and_steps() -> None:
    talk = Talk(faults=[Hang(at_s=1.0)])
    talk.do("CP 1 250 0 0 10")
    talk.wait(2.0)
    place = talk.sim.arm.now_at()
    assert talk.send(POSE) == []
    talk.wait(5.0)
    assert talk.sim.arm.now_at() == place


def test_the_queue_may_stand_without_an_alarm() -> None:
    talk = Talk(faults=[StopQueue(after_acks=2)])
    talk.do("WAIT 10")
    talk.do("WAIT 10")
    talk.do("WAIT 10")
    talk.wait(1.0)
    assert (talk.alarms, talk.ask("LeftSpace")) == ((), (31,))


def test_an_alarm_stops_the_motion_at_once() -> None:
    talk = Talk(faults=[RaiseAlarm(at_s=0.5, code=0x51)])
    talk.do("CP 1 250 0 50 50")
    talk.wait(3.0)
    assert talk.alarms == (0x51,)
    assert 200.0 < talk.place[0] < 230.0


@pytest.mark.parametrize(
    ("sentence", "seen"),
    [
        ("unplug", lambda talk: talk.sim.unplugged),
        ("hang", lambda talk: talk.send(POSE) == []),
        ("power cut", lambda talk: talk.sim.arm.alarms == {0}),
        ("alarm 50", lambda talk: talk.alarms == (0x50,)),
        ("stop queue", lambda talk: not talk.sim.arm.running),
    ],
)
def test_things_can_happen_while_it_runs(sentence: str, seen: Callable[[Talk], bool]) -> None:
    talk = Talk()
    talk.sim.happen(sentence, talk.now)
    assert seen(talk)


def test_what_cannot_happen_is_refused() -> None:
    with pytest.raises(ValueError, match="'rain' does not happen to an arm"):
        Talk().sim.happen("rain", 0.0)


def test_a_reply_takes_its_time_on_the_wire() -> None:
    talk = Talk()
    talk.sim.receive(parse("WAIT 1").packet().encode(), talk.now)
    event = talk.sim.next_time()
    assert event == pytest.approx(talk.now + 10 * 10 / 115200)
    talk.sim.advance(event or 0.0)
    assert talk.sim.next_time() == pytest.approx(talk.now + 24 * 10 / 115200, abs=1e-3)
