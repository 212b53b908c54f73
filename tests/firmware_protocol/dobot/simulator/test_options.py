"""A simulated arm as a URL describes it."""

from __future__ import annotations

import pytest

from firmware_protocol.dobot.commands import NONE_YET
from firmware_protocol.dobot.kinematics import SHEET_ORIGIN_MM
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
from firmware_protocol.dobot.simulator.options import simulator_from
from firmware_protocol.ink import PenRule


def test_without_options_it_is_the_usual_arm() -> None:
    arm = simulator_from({}).arm
    assert arm.build == Build()
    assert arm._trace._origin_mm == SHEET_ORIGIN_MM


def test_every_option_of_the_build() -> None:
    options = {
        "depth": "8", "first_index": "2", "unused": "none", "left_holds_running": "0", "clear_resets": "1",
        "abort_counts": "1", "home_s": "3", "left_bytes": "8", "alarms": "00:50", "origin": "200:-60", "pen_z": "-12.5",
    }  # fmt: skip
    simulator = simulator_from(options, pen=PenRule(down_at_mm=1.0))
    assert simulator.arm.build == Build(8, 2, NONE_YET, False, True, 3.0, True)
    assert simulator.arm.alarms == {0x00, 0x50}
    assert simulator.arm._trace._origin_mm == (200.0, -60.0)
    assert simulator.arm._trace._ink.rule == PenRule(down_at_mm=-12.5)


def test_every_fault() -> None:
    options = {
        "drop": "3", "corrupt": "a4", "stray": "5", "delay": "a6:0.5", "lose": "7", "close": "1.5", "cut": "@8",
        "hang": "2", "stop": "@9", "alarm": "50:@10",
    }  # fmt: skip
    assert simulator_from(options)._faults == (
        DropReply(3), CorruptReply(4, answers=True), StrayByte(5), DelayReply(6, answers=True, by_s=0.5),
        CorruptRequest(7), ClosePort(at_s=1.5), PowerCut(after_acks=8), Hang(at_s=2.0), StopQueue(after_acks=9),
        RaiseAlarm(after_acks=10, code=0x50),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("key", "value"),
    [("deep", "3"), ("depth", "x"), ("unused", "1"), ("drop", "x"), ("cut", "@x"), ("alarm", "zz:1"), ("origin", "3")],
)
def test_what_cannot_be_understood_is_refused(key: str, value: str) -> None:
    with pytest.raises(ValueError, match=key):
        simulator_from({key: value})


def test_a_timed_fault_needs_one_moment() -> None:
    with pytest.raises(ValueError, match="state either"):
        PowerCut()
