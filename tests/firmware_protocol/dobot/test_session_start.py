"""From the first question to Ready."""

from __future__ import annotations

import pytest

from firmware_protocol.dobot.commands import NONE_YET
from firmware_protocol.dobot.packet import PacketReader
from firmware_protocol.dobot.simulator.arm import Build
from firmware_protocol.dobot.simulator.faults import CorruptReply, DropReply, Hang
from firmware_protocol.dobot.states import State
from firmware_protocol.errors import LocalProtocolError
from firmware_protocol.session import NotReady, Ready
from tests.firmware_protocol.dobot.bench import UP_MM, Bench, Line


def asked(bench: Bench) -> list[tuple[int, int]]:
    """Id and control byte of what was sent."""
    packets = PacketReader().feed(b"".join(data for _, data in bench.sent))
    return [(packet.id, packet.ctrl) for packet in packets]


def test_alarms_are_read_and_cleared_the_queue_cleared_started_and_measured() -> None:
    bench = Bench().ready()
    start = [(10, 0), (2, 0), (20, 0), (20, 1), (20, 0), (245, 1), (240, 1), (246, 0), (247, 0), (10, 0)]
    assert asked(bench)[: len(start)] == start
    assert bench.told == [Ready("Dobot Magician 3.7.0", 32 * 23)]


@pytest.mark.parametrize("build", [Build(depth=8), Build(unused=NONE_YET), Build(first_index=2, clear_resets=True)])
def test_arms_of_every_build_become_ready(build: Build) -> None:
    bench = Bench(arm={"build": build, "left_bytes": 8}).ready()
    assert bench.session.queue_depth == build.depth


def test_an_alarm_of_the_past_is_cleared() -> None:
    bench = Bench(arm={"alarms": [0x00, 0x50]}).ready()
    assert bench.session.state is State.READY
    assert bench.sim.arm.alarms == set()


def test_an_alarm_that_comes_back_is_named_with_its_remedy() -> None:
    bench = Bench()
    bench.until(lambda: len(bench.sent) == 5)
    bench.sim.arm.raise_alarm(0x40)
    bench.ready()
    (told,) = bench.told
    assert isinstance(told, NotReady)
    assert "0x40 (joint limit: joint 1 +): move the arm back by hand" in told.why


def test_the_arm_homes_where_that_is_wanted() -> None:
    bench = Bench(arm={"build": Build(home_s=20.0), "place": (230.0, 20.0, 60.0)}, home=True).ready()
    assert bench.session.state is State.READY
    assert bench.time_of(Ready) > 20.0
    assert bench.sim.arm.place == pytest.approx((200.0, 0.0, 50.0))


def test_homing_has_a_time_limit() -> None:
    bench = Bench(arm={"build": Build(home_s=60.0)}, home=True, home_within_s=30.0).ready()
    assert "homing has not ended after 30 s" in bench.all_of(NotReady)[0].why


def test_a_pen_that_is_down_is_lifted_before_anything_else_moves() -> None:
    bench = Bench(arm={"place": (230.0, 20.0, -5.0)}).ready()
    assert bench.sim.arm.place == pytest.approx((230.0, 20.0, UP_MM))
    assert bench.sim.ink == []


def test_nobody_there_is_said_in_time() -> None:
    bench = Bench(arm={"faults": [Hang(at_s=0.0)]}).ready()
    assert bench.told == [NotReady("nothing answered within 5 s: check the port and that the arm is switched on")]
    assert bench.now == pytest.approx(5.0)


def test_something_else_that_babbles_is_no_arm() -> None:
    bench = Bench(arm={"faults": [Hang(at_s=0.0)]})
    bench.act()
    bench.session.receive(b"Grbl 1.1h ['$' for help]\r\n", 0.1)
    bench.ready()
    assert "no Dobot Magician" in bench.all_of(NotReady)[0].why


@pytest.mark.parametrize("fault", [DropReply, CorruptReply])
@pytest.mark.parametrize("index", range(10))
def test_a_reply_that_is_lost_at_the_start_is_asked_for_again(
    fault: type[DropReply | CorruptReply], index: int
) -> None:
    assert Bench(arm={"faults": [fault(index, answers=True)]}).ready().session.state is State.READY


def test_a_false_header_holds_nothing_up() -> None:
    bench = Bench()
    bench.session.receive(b"\xaa\xaa\xa9\x01", 0.0)
    bench.ready()
    assert bench.time_of(Ready) < 0.5


def test_an_idle_arm_that_restarts_is_noticed() -> None:
    bench = Bench().ready()
    bench.sim.arm.restart()
    bench.wait(2.0)
    assert "restarted by itself" in bench.all_of(NotReady)[0].why


def test_an_idle_arm_that_falls_silent_is_noticed() -> None:
    bench = Bench().ready()
    bench.sim.dead = True
    bench.wait(7.0)
    assert "has not answered for 5 s" in bench.all_of(NotReady)[0].why


@pytest.mark.parametrize(
    ("text", "why"), [("CP 1 2", "line 1: .*takes"), ("StartExec", "line 1 .*queue"), ("G0 X1", "no command 'G0'")]
)
def test_a_line_that_is_no_command_for_the_queue_is_refused(text: str, why: str) -> None:
    bench = Bench().ready()
    with pytest.raises(LocalProtocolError, match=why):
        bench.start([Line(text)])
    assert bench.session.state is State.READY


def test_a_job_before_ready_is_refused() -> None:
    with pytest.raises(LocalProtocolError, match="wait for Ready"):
        Bench().start([Line("WAIT 1")])
