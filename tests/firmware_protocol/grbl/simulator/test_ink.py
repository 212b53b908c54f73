"""The ink of the simulated plotter, and the faults that it shows on request."""

from __future__ import annotations

from itertools import pairwise

import pytest

from firmware_protocol.grbl.simulator.faults import BrownOut, DropByte, FlipByte, Hang, HardLimit, LoseOk, Unplug
from firmware_protocol.ink import PenRule
from tests.firmware_protocol.grbl.bench import BRISK, talk

SQUARE = ["G0Z5", "G0X10Y10", "G1Z0F900", "G1X20F1800", "Y20", "X10", "Y10", "G0Z5", "G0X0Y0"]
CORNERS = [(10.0, 10.0), (20.0, 10.0), (20.0, 20.0), (10.0, 20.0), (10.0, 10.0)]


def test_what_is_drawn_with_the_pen_down_is_on_the_sheet() -> None:
    conversation = talk()
    conversation.stream(SQUARE)
    conversation.settle()
    assert conversation.sim.ink == [CORNERS]


def test_the_pen_may_hang_on_a_servo() -> None:
    conversation = talk(pen=PenRule(down_s=800, up_s=200))
    conversation.stream(["M3S200", "G0X10Y10", "M3S800", "G4P0.1", "G1X20F1800", "M3S200", "G0X5Y5", "M3S800", "M5"])
    conversation.settle()
    assert conversation.sim.ink == [[(10.0, 10.0), (20.0, 10.0)], [(5.0, 5.0)]]


def test_the_pen_touches_at_the_height_of_the_rule_on_its_way_down() -> None:
    conversation = talk(pen=PenRule(down_at_mm=1.0))
    conversation.stream(["G0Z2", "G1X4Z0F900", "G1Z2X8"])
    conversation.settle()
    (line,) = conversation.sim.ink
    assert [x for x, _ in line] == pytest.approx([2.0, 4.0, 6.0])


def test_up_may_be_minus() -> None:
    conversation = talk(pen=PenRule(up_is_minus=True))
    conversation.stream([line.replace("Z5", "Z-5") for line in SQUARE])
    conversation.settle()
    assert conversation.sim.ink == [CORNERS]


def test_a_pen_that_goes_down_and_up_makes_a_dot() -> None:
    conversation = talk()
    conversation.stream(["G0Z5", "G0X3Y4", "G1Z0F900", "G0Z5"])
    conversation.settle()
    assert conversation.sim.ink == [[(3.0, 4.0)]]


def test_ink_grows_while_the_pen_moves() -> None:
    conversation = talk()
    conversation.ask("G1X30F1200\n", within_s=0.8)
    drawn = conversation.sim.ink[0][-1][0]
    assert drawn == pytest.approx(conversation.sim.position_mm[0])
    assert 14 < drawn < 15.2


@pytest.mark.parametrize(("rests", "times"), [((), 0), ((1, 8), 0), ((7,), 1), ((3, 4, 6), 3)])
def test_a_planner_that_runs_dry_leaves_the_pen_standing_on_the_sheet(rests: tuple[int, ...], times: int) -> None:
    """rests: numbers of lines that come only when the machine has come to rest."""
    conversation = talk()
    for first, after in pairwise((0, *rests, len(SQUARE))):
        conversation.stream(SQUARE[first:after])
        conversation.settle()
    assert conversation.sim.stood_on_sheet == times


def test_a_lost_position_shifts_what_is_drawn_on_the_sheet() -> None:
    conversation = talk()
    conversation.ask("G0Z5\nG0X10\n", within_s=2.0)
    conversation.sim.open(conversation.now)
    conversation.ask("", within_s=0.1)
    conversation.ask("G0Z-5\nG1X3F1200\n", within_s=2.0)
    assert conversation.sim.ink == [[(10.0, 0.0), (13.0, 0.0)]]


def test_a_dropped_byte_joins_what_is_left() -> None:
    conversation = talk(faults=[DropByte(4)])
    assert conversation.ask("G0X1\nY2\n", within_s=1.0) == ["ok"]
    assert conversation.sim.position_mm == (1.0, 2.0, 0.0)


def test_a_flipped_byte_may_be_taken_for_good() -> None:
    conversation = talk(faults=[FlipByte(3, 0x02)])
    assert conversation.ask("G0X1\n", within_s=1.0) == ["ok"]
    assert conversation.sim.position_mm == (3.0, 0.0, 0.0)


def test_a_lost_ok_is_lost_for_the_host_only() -> None:
    conversation = talk(faults=[LoseOk(1)])
    assert conversation.ask("G0X1\nG0Y1\nG0Z1\n", within_s=2.0) == ["ok", "ok"]
    assert (conversation.sim.oks, conversation.sim.position_mm) == (3, (1.0, 1.0, 1.0))


def test_a_hang_stops_everything_until_the_port_is_opened_again() -> None:
    conversation = talk(faults=[Hang(at_s=2.5)])
    conversation.ask("G1X30F1200\n", within_s=1.0)
    stopped = conversation.sim.position_mm
    assert conversation.ask("?\x18", within_s=60.0) == []
    assert conversation.sim.position_mm == stopped
    assert 8.5 < stopped[0] < 9.5
    conversation.sim.open(conversation.now)
    assert conversation.wait(0.1)[-1].startswith("Grbl")


def test_a_brown_out_forgets_the_position_and_says_nothing_but_the_banner() -> None:
    conversation = talk(faults=[BrownOut(after_acks=2)])
    assert conversation.ask("G1X30F1200\n\n", within_s=3.0) == ["ok", "ok", "", "Grbl 1.1h ['$' for help]"]
    assert conversation.ask("?")[0].startswith("<Idle|MPos:0.000,0.000,0.000|")
    assert 0 <= conversation.sim.position_mm[0] < 1


def test_a_limit_switch_is_alarm_1_and_locks_until_a_reset() -> None:
    conversation = talk(faults=[HardLimit(at_s=2.5)])
    assert conversation.ask("G1X30F1200\n", within_s=3.0) == ["ok", "ALARM:1", "[MSG:Reset to continue]"]
    assert conversation.ask("?$X\n") == []
    assert conversation.ask("\x18")[-1] == "[MSG:'$H'|'$X' to unlock]"


def test_an_unplugged_machine_says_nothing_and_says_so_to_its_transport() -> None:
    conversation = talk(faults=[Unplug(at_s=2.5)])
    conversation.ask("G1X30F1200\n", within_s=1.0)
    assert (conversation.sim.unplugged, conversation.ask("?", within_s=9.0)) == (True, [])


def test_a_fault_has_one_moment() -> None:
    with pytest.raises(ValueError, match="Hang needs one moment"):
        Hang()


def test_a_servo_pen_comes_up_at_a_reset() -> None:
    conversation = talk(pen=PenRule(down_s=800), settings=BRISK)
    conversation.ask("M3S800\nG1X30F1200\n", within_s=0.5)
    conversation.ask("\x18", within_s=2.0)
    conversation.ask("$X\nG0X0\n", within_s=3.0)
    assert len(conversation.sim.ink) == 1
    assert conversation.sim.ink[0][-1][0] < 11
