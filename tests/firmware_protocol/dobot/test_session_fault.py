"""A job that something goes wrong with."""

from __future__ import annotations

import pytest

from firmware_protocol.dobot.commands import Command
from firmware_protocol.dobot.packet import PacketReader
from firmware_protocol.dobot.simulator.arm import Arm, Build
from firmware_protocol.dobot.simulator.faults import (
    ClosePort,
    CorruptReply,
    CorruptRequest,
    DelayReply,
    DropReply,
    Fault,
    Hang,
    PowerCut,
    RaiseAlarm,
    StopQueue,
    StrayByte,
)
from firmware_protocol.dobot.states import State
from firmware_protocol.dobot.steps import TRIES
from firmware_protocol.session import Ended, Verdict
from tests.firmware_protocol.dobot.bench import Bench, Line, stroke, strokes
from tests.firmware_protocol.dobot.test_session_job import rounded, whole

LINES = strokes(3)
BEFORE = 1
"""Commands for the queue before the first line: the arm is asked to wait, which tells where its count stands."""
LAST = len(LINES) - 1 + BEFORE


def bench_with(*faults: Fault, build: Build | None = None) -> Bench:
    """The faults count the commands for the queue: BEFORE of them, and then those of the job."""
    bench = Bench(arm={"faults": faults, "build": build or Build()})
    bench.draw(LINES)
    return bench


def queued(bench: Bench) -> int:
    """Commands for the queue that were sent, but for those that only wait."""
    packets = PacketReader().feed(b"".join(data for _, data in bench.sent))
    return sum(packet.queued and packet.id != 110 for packet in packets)


@pytest.mark.parametrize("number", [0, 3, 17, 20, 33, LAST])
@pytest.mark.parametrize("build", [Build(), Build(left_holds_running=False)], ids=["holds", "does not hold"])
@pytest.mark.parametrize("fault", [DropReply, CorruptReply, CorruptRequest])
def test_a_command_is_neither_lost_nor_drawn_twice(
    fault: type[DropReply | CorruptReply | CorruptRequest], build: Build, number: int
) -> None:
    bench = bench_with(fault(number), build=build)
    assert bench.ended.verdict is Verdict.FINISHED
    assert rounded(bench.sim.ink) == whole(3)
    assert queued(bench) == len(LINES) + (fault is CorruptRequest and number >= BEFORE)


@pytest.mark.parametrize("number", [3, 20, LAST])
@pytest.mark.parametrize("by_s", [0.1, 0.302, 0.31, 0.5, 2.0])
def test_an_acknowledgement_that_comes_late_changes_nothing(number: int, by_s: float) -> None:
    bench = bench_with(DelayReply(number, by_s=by_s))
    assert bench.ended.verdict is Verdict.FINISHED
    assert bench.sim.arm.left == 32
    assert rounded(bench.sim.ink) == whole(3)


@pytest.mark.parametrize("by_ms", range(300, 340, 2))
def test_done_is_said_when_the_queue_is_empty_even_where_acknowledgements_were_mistaken(by_ms: int) -> None:
    """The last but one comes so late that it is taken for the last, which is lost."""
    bench = bench_with(DelayReply(LAST - 1, by_s=by_ms / 1000), DropReply(LAST))
    assert bench.ended.verdict is Verdict.FINISHED
    assert bench.sim.arm.left == 32


def test_several_faults_of_the_wire_in_a_job_are_got_over() -> None:
    bench = bench_with(DropReply(5), CorruptRequest(12), StrayByte(14), DropReply(30), DropReply(9, answers=True))
    assert bench.ended.verdict is Verdict.FINISHED
    assert rounded(bench.sim.ink) == whole(3)


def test_a_command_that_is_never_taken_is_sent_twice_and_ends_the_job() -> None:
    # Between the two the arm is asked to wait, which tells that it has not taken the first.
    bench = bench_with(CorruptRequest(20 + BEFORE), CorruptRequest(22 + BEFORE))
    end = bench.ended
    assert (end.verdict, end.position_known, end.pen_lifted) == (Verdict.REJECTED, True, True)
    assert "line 21 ('CP 1 " in end.why
    assert queued(bench) == 22
    assert bench.session.state is State.READY


def test_where_no_index_tells_the_command_is_not_sent_again() -> None:
    bench = bench_with(*(DropReply(20 + BEFORE + k) for k in range(TRIES + 1)))
    end = bench.ended
    assert (end.verdict, end.pen_lifted) == (Verdict.SILENT, True)
    assert "acknowledgement of line 21" in end.why
    assert queued(bench) == 22  # the last one lifts the pen


def test_an_arm_that_does_not_count_by_one_draws_as_well(monkeypatch: pytest.MonkeyPatch) -> None:
    bench = bench_by_three(monkeypatch)
    assert bench.ended.verdict is Verdict.FINISHED
    assert rounded(bench.sim.ink) == whole(3)


@pytest.mark.parametrize("number", [1, 2, 3, 20, LAST])
@pytest.mark.parametrize("fault", [DropReply, CorruptRequest])
def test_an_arm_that_does_not_count_by_one_is_not_trusted_with_a_gap(
    fault: type[DropReply | CorruptRequest], number: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench = bench_by_three(monkeypatch, fault(number))
    end = bench.ended
    assert end.verdict is Verdict.SILENT
    assert "acknowledgement of line" in end.why


def bench_by_three(monkeypatch: pytest.MonkeyPatch, *faults: Fault) -> Bench:
    """The arm's indices rise by three."""
    enqueue = Arm.enqueue

    def by_three(arm: Arm, command: Command) -> int | None:
        index = enqueue(arm, command)
        arm._next_index += 2
        return index

    monkeypatch.setattr(Arm, "enqueue", by_three)
    return bench_with(*faults)


def test_an_alarm_of_planning_is_named_and_the_pen_lifted() -> None:
    lines = [*stroke(0, (200, 0), (220, 0)), *stroke(1, (220, 10), (400, 10))]
    bench = Bench()
    end = bench.draw(lines)
    assert (end.verdict, end.strokes_certain, end.strokes_possible) == (Verdict.ALARM, 1, 2)
    assert "alarm 0x11 (planning: target out of the workspace)" in end.why
    assert (end.position_known, end.pen_lifted) == (True, True)
    assert bench.session.state is State.LOST


@pytest.mark.parametrize("code", [0x30, 0x41, 0x50, 0x65, 0x7F])
def test_after_another_alarm_the_arm_is_not_moved(code: int) -> None:
    bench = bench_with(RaiseAlarm(after_acks=30, code=code))
    end = bench.ended
    assert (end.verdict, end.position_known, end.pen_lifted) == (Verdict.ALARM, False, False)
    assert f"alarm 0x{code:02X}" in end.why
    assert bench.sim.arm.alarms == {code}


def test_a_restart_is_seen_and_nothing_moves() -> None:
    bench = bench_with(PowerCut(after_acks=30))
    end = bench.ended
    assert (end.verdict, end.position_known, end.pen_lifted) == (Verdict.RESTARTED, False, False)
    at = bench.now
    bench.wait(5.0)
    assert [data for sent, data in bench.sent if sent > at] == []


def test_an_arm_that_hangs_is_told_to_stop_once() -> None:
    bench = bench_with(Hang(after_acks=30))
    end = bench.ended
    assert (end.verdict, end.pen_lifted) == (Verdict.SILENT, False)
    assert "has not answered for 5 s" in end.why
    at = bench.now
    bench.wait(5.0)
    assert [packet.id for packet in PacketReader().feed(b"".join(d for t, d in bench.sent if t >= at))] == [242, 245]


def test_a_queue_that_stands_without_an_alarm_is_stuck() -> None:
    bench = bench_with(StopQueue(after_acks=30))
    end = bench.ended
    assert (end.verdict, end.position_known, end.pen_lifted) == (Verdict.SILENT, True, True)
    assert "stood still for 3 s before line " in end.why


def test_without_the_cable_the_arm_may_draw_what_is_in_its_queue() -> None:
    bench = bench_with(ClosePort(after_acks=30))
    end = bench.ended
    bench.drain()
    assert end.verdict is Verdict.UNPLUGGED
    assert end.strokes_certain <= len(bench.sim.ink) <= end.strokes_possible


@pytest.mark.parametrize("lost", [PowerCut, Hang, StopQueue, ClosePort, RaiseAlarm])
@pytest.mark.parametrize("after_acks", [4, 16, 29, 31, len(LINES)])
def test_the_truth_lies_within_what_is_said(
    lost: type[PowerCut | Hang | StopQueue | ClosePort | RaiseAlarm], after_acks: int
) -> None:
    bench = bench_with(lost(after_acks=after_acks))
    end = bench.ended
    bench.drain()
    drawn = rounded(bench.sim.ink)
    complete = sum(line == full for line, full in zip(drawn, whole(3), strict=False))
    assert end.strokes_certain <= complete
    assert len(drawn) <= end.strokes_possible
    assert sum(isinstance(event, Ended) for event in bench.events) == 1


def test_a_line_that_stops_the_wire_for_a_moment_is_only_a_pause() -> None:
    bench = Bench(arm={"faults": [DropReply(k, answers=True) for k in range(12, 20)]})
    assert bench.draw([*LINES, Line("WAIT 1")]).verdict is Verdict.FINISHED
