"""The simulated control: what it reads, what it draws, what stands on its screen and nowhere else."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_protocol.emco.dialects import FANUC
from firmware_protocol.emco.line_format import FORMATS
from firmware_protocol.emco.simulator.faults import FlipBit, LoseXon, PowerCut, Reset, Stall, Unplug
from firmware_protocol.emco.simulator.setup import Setup
from firmware_protocol.emco.simulator.simulator import EmcoSimulator, simulator_from
from firmware_protocol.ink import PenRule

XON, XOFF = b"\x11", b"\x13"
HEAD = b"%\nO0001\nG90 G17 G21 G94 G64\nG54 G0 Z5.0\n"
TAIL = b"M5\nM9\nM30\n%\n"


def opened(setup: Setup | None = None, **options: object) -> EmcoSimulator:
    simulator = EmcoSimulator(setup, **options)  # type: ignore[arg-type]
    simulator.open(0.0)
    return simulator


def drawn(body: bytes, **options: object) -> EmcoSimulator:
    """A control that has been given a whole program and all the time that it needs."""
    simulator = opened(Setup(buffer_bytes=1024), **options)
    simulator.receive(HEAD + body + TAIL, 1.0)
    simulator.advance(100.0)
    return simulator


def test_it_asks_for_the_program_when_it_is_opened_and_again_until_bytes_come() -> None:
    simulator = opened(Setup(start_s=2.0, repeat_xon_s=5.0))
    assert simulator.advance(1.9) == b""
    assert simulator.advance(12.9) == XON * 3
    simulator.receive(b"%", 13.0)
    assert simulator.advance(60.0) == b""


def test_without_repetition_it_asks_once() -> None:
    assert opened(Setup(repeat_xon_s=None)).advance(60.0) == XON


def test_what_comes_before_start_is_lost() -> None:
    simulator = opened(Setup(start_s=2.0))
    simulator.receive(b"%\n", 0.0)
    simulator.advance(1.0)
    assert simulator.unread == 2


def test_lines_and_an_arc_leave_their_ink() -> None:
    simulator = drawn(b"G0 X10.0 Y10.0\nG1 Z0.0 F600.0\nG1 X20.0 F1200.0\nG2 X30.0 Y0.0 I0.0 J-10.0\nG0 Z5.0\n")
    (line,) = simulator.ink
    assert line[:2] == [(10, 10), (20, 10)]
    assert line[-1] == (30, 0)
    middle = line[len(line) // 2 + 1]
    assert (middle[0] - 20) ** 2 + middle[1] ** 2 == pytest.approx(100, abs=1e-6)


def test_the_pen_touches_where_its_rule_says() -> None:
    body = b"G0 X10.0\nG1 Z1.0 F600.0\nG1 X20.0\nG0 Z5.0\n"
    assert drawn(body).ink == []
    assert len(drawn(body, pen=PenRule(down_at_mm=1.0)).ink) == 1


def test_ink_grows_while_a_move_is_executed() -> None:
    simulator = opened()
    simulator.receive(HEAD + b"G1 Z0.0 F600.0\nG1 X100.0 F600.0\n", 0.0)
    simulator.advance(3.0)
    at = [simulator.ink[-1][-1][0] for now in (4.0, 5.0) if simulator.advance(now) is not None]
    assert at[1] - at[0] == pytest.approx(10.0, abs=0.1)


def test_xoff_comes_at_three_quarters_and_xon_at_a_quarter() -> None:
    simulator = opened(Setup(buffer_bytes=256, ahead=1))
    simulator.advance(0.5)
    slow = b"G1 X100.0 F60.0\n"
    simulator.receive(HEAD + slow, 1.0)
    simulator.advance(1.5)
    simulator.receive(b"X0.0001\n" * 23, 2.0)
    assert simulator.advance(3.0) == b""
    simulator.receive(b"X0.0001\n", 3.0)
    assert simulator.advance(4.0) == XOFF
    assert simulator.advance(90.0) == b""
    assert simulator.advance(300.0) == XON


def test_bytes_without_room_vanish_and_are_counted() -> None:
    simulator = opened(Setup(buffer_bytes=256, ahead=1))
    simulator.receive(HEAD + b"G1 X100.0 F60.0\n" + b"X0.00001\n" * 40, 0.0)
    simulator.advance(5.0)
    assert simulator.peak == 256
    assert simulator.overruns > 0


def test_a_fanuc_control_takes_x100_for_a_tenth_of_a_millimetre() -> None:
    assert drawn(b"G1 X100 Y10. F600.\n").position_mm == pytest.approx((0.1, 10.0, 5.0))


@pytest.mark.parametrize(
    ("body", "screen"),
    [
        (b"G1 X400.0 F600.0\n", "block 5: axis X would leave"),
        (b"G1 X1.0 F20000.0\n", "block 5: feed"),
        (b"G0 X1.0\nM3\n", "block 6: M3 is not known"),
    ],
)
def test_an_alarm_stands_on_the_screen_and_nothing_on_the_wire(body: bytes, screen: str) -> None:
    simulator = opened(Setup(buffer_bytes=1024))
    simulator.advance(1.0)
    simulator.receive(HEAD + body + b"G0 X5.0\n", 1.0)
    assert simulator.advance(60.0) == b""
    assert simulator.screen.startswith(screen)
    assert simulator.position_mm[0] <= 1.0
    simulator.receive(b"G0 X5.0\n", 61.0)
    assert simulator.advance(90.0) == b""
    assert simulator.unread >= len("G0 X5.0\n")


def test_a_dialect_that_it_is_not_set_up_for_raises_an_alarm() -> None:
    simulator = opened(Setup(dialect=FANUC))
    simulator.receive(b"%_N_LD_MPF\n", 0.0)
    simulator.advance(1.0)
    assert "speaks fanuc" in simulator.screen


def test_a_flipped_bit_is_an_alarm_with_parity_and_another_number_without() -> None:
    at = len(HEAD) + len(b"G0 X1")
    seen = opened(Setup(line=FORMATS["7E1"]), faults=[FlipBit(at)])
    seen.receive(HEAD + b"G0 X10.0\nG0 X20.0\n", 0.0)
    seen.advance(5.0)
    assert "parity" in seen.screen
    unseen = opened(faults=[FlipBit(at)])
    unseen.receive(HEAD + b"G0 X10.0\n", 0.0)
    unseen.advance(5.0)
    assert (unseen.screen, unseen.position_mm[0]) == ("", 11.0)


@pytest.mark.parametrize("fault", [Reset(1.0), PowerCut(1.0)])
def test_reset_and_power_cut_stop_the_motion_and_say_nothing(fault: Reset) -> None:
    simulator = opened(faults=[fault])
    simulator.advance(0.1)
    simulator.receive(HEAD + b"G1 X100.0 F600.0\n", 0.1)
    assert simulator.advance(60.0) == b""
    assert 0 < simulator.position_mm[0] < 10
    assert not simulator.moving


def test_a_fault_with_a_time_happens_once_however_often_the_port_is_opened() -> None:
    simulator = opened(faults=[Reset(1.0)])
    simulator.advance(2.0)
    simulator.open(2.0)
    simulator.advance(2.1)
    simulator.receive(HEAD + b"G1 X50.0 F600.0\n", 2.1)
    simulator.advance(60.0)
    assert simulator.position_mm[0] == 50.0


def test_nothing_goes_either_way_through_a_pulled_cable() -> None:
    simulator = opened(Setup(repeat_xon_s=1.0), faults=[Unplug(1.5)])
    assert simulator.advance(1.4) == XON * 2
    assert simulator.advance(5.0) == b""
    assert simulator.unplugged
    simulator.receive(HEAD + b"G0 X1.0\n", 5.0)
    simulator.advance(10.0)
    assert (simulator.position_mm[0], simulator.blocks) == (0.0, 0)


def test_a_stalled_control_says_xoff_and_draws_what_it_has_read() -> None:
    simulator = opened(faults=[Stall(1.0)])
    simulator.advance(0.1)
    simulator.receive(HEAD + b"G1 X100.0 F600.0\nG1 X0.0\n" + b"M5\n" * 100, 0.1)
    assert simulator.advance(60.0) == XOFF
    assert simulator.position_mm[0] == 0.0


def test_a_lost_xon_does_not_arrive() -> None:
    assert opened(faults=[LoseXon(0)]).advance(6.0) == XON


def test_each_block_is_answered_when_there_is_room_for_it() -> None:
    simulator = opened(Setup(link="blocks", ahead=1))
    for line in HEAD.splitlines(keepends=True):
        simulator.receive(line, simulator.now)
        assert simulator.advance(simulator.now + 1) == b"\x06"
    simulator.receive(b"G1 X10.0 F600.0\n", 10.0)
    assert simulator.advance(10.5) == b"\x06"
    simulator.receive(b"G1 X20.0\n", 10.5)
    assert simulator.advance(10.9) == b""
    assert simulator.advance(12.0) == b"\x06"


def test_behind_m30_the_next_program_may_come() -> None:
    simulator = drawn(b"G0 X1.0\n")
    simulator.receive(HEAD + b"G0 X2.0\n" + TAIL, 101.0)
    simulator.advance(200.0)
    assert (simulator.position_mm[0], simulator.screen, simulator.unread) == (2.0, "", 0)


def test_it_asks_for_the_next_program_only_when_the_last_motion_has_ended() -> None:
    simulator = opened(Setup(repeat_xon_s=None))
    assert simulator.advance(0.5) == XON
    simulator.receive(HEAD + b"G1 X20.0 F600.0\n" + TAIL, 0.5)
    assert simulator.advance(2.0) == b""
    assert simulator.moving
    assert simulator.advance(4.0) == XON
    assert simulator.position_mm[0] == 20.0


@given(st.lists(st.binary(max_size=40) | st.floats(0, 20), max_size=12), st.sampled_from(["xonxoff", "blocks"]))
def test_noise_does_no_harm_and_time_goes_on(course: list[bytes | float], link: str) -> None:
    simulator = simulator_from({"link": link, "format": "7E1", "software_parity": "1"})
    simulator.open(0.0)
    for step in course:
        if isinstance(step, bytes):
            simulator.receive(step, simulator.now)
        else:
            simulator.advance(simulator.now + step)
        following = simulator.next_time()
        assert following is None or following > simulator.now or simulator.advance(simulator.now) is not None


@given(st.integers(0, 400), st.integers(0, 400))
def test_what_is_drawn_does_not_depend_on_how_bytes_are_chunked(a: int, b: int) -> None:
    data = HEAD + b"G1 Z0.0 F600.0\nG1 X10.0 F1200.0\nY10.0\n" + TAIL
    simulator = opened()
    for part in (data[: min(a, b)], data[min(a, b) : max(a, b)], data[max(a, b) :]):
        simulator.receive(part, 0.0)
    simulator.advance(60.0)
    assert simulator.ink == [[(0, 0), (10, 0), (10, 10)]]
