"""Modal state, known words, the limits of travel and feed, arcs."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_protocol.emco.blocks import Alarm, arc
from firmware_protocol.emco.dialects import FANUC, SIEMENS
from firmware_protocol.emco.simulator.interpreter import CHORD_MM, Interpreter, Move, Room
from firmware_protocol.errors import ProtocolError

ROOM = Room((0, 0, -100), (350, 250, 200), 15_000)


def reader(*, metric: str = "G71") -> Interpreter:
    """Behind the head of a Siemens program."""
    control = Interpreter(SIEMENS, room=ROOM)
    for line in ("%_N_LD_MPF", ";$PATH=/_N_MPF_DIR", f"G90 G17 {metric} G94 G64", "G54 G0 Z5.0"):
        control.take(line)
    return control


def test_coordinates_motion_and_feed_stay_until_others_are_given() -> None:
    control = reader()
    control.take("G1 X10.0 F600.0")
    assert control.take("Y5.0") == [Move((10, 0, 5), (10, 5, 5), 10)]


def test_a_block_without_axes_moves_nothing() -> None:
    assert reader().take("M5") == []


@pytest.mark.parametrize(
    ("line", "screen"),
    [
        ("G1 X351.0 F600.0", "axis X would leave its travel at X351.000"),
        ("G0 Y-0.1", "axis Y would leave"),
        ("G0 Z201.0", "axis Z would leave"),
        ("G1 X1.0", "no feed"),
        ("G1 X1.0 F0.0", "feed F0"),
        ("G1 X1.0 F15001.0", "feed F15001"),
        ("G91 X1.0", "G91 is not known"),
        ("M3", "M3 is not known"),
        ("M8", "M8 is not known"),
        ("G20", "G20 is not known"),
        ("G21", "G21 is not known"),
        ("G0 X1.0 X2.0", "stands twice"),
        ("G0 Q1.0", "address Q"),
        ("G2 X10.0 Y0.0 I4.0 J0.0 F600.0", "not on its circle"),
        ("G2 X10.0 Y0.0 CR=4.0 F600.0", "no arc of radius 4"),
    ],
)
def test_what_the_control_does_not_take_raises_an_alarm(line: str, screen: str) -> None:
    with pytest.raises(Alarm, match=screen):
        reader().take(line)


def test_nothing_moves_before_a_motion_is_chosen() -> None:
    control = Interpreter(SIEMENS)
    control.take("%_N_LD_MPF")
    with pytest.raises(Alarm, match="no G0"):
        control.take("X1.0")


def test_a_program_for_another_control_is_refused() -> None:
    with pytest.raises(Alarm, match="speaks fanuc"):
        Interpreter(FANUC).take("%_N_LD_MPF")
    with pytest.raises(Alarm, match="no program begins"):
        Interpreter(FANUC).take("G21")


def test_a_fanuc_program_has_a_number() -> None:
    control = Interpreter(FANUC)
    control.take("%")
    with pytest.raises(Alarm, match="no program number"):
        control.take("G21")


def test_what_follows_m30_is_passed_over() -> None:
    control = reader()
    control.take("M30")
    assert control.ended
    assert control.take("G1 X999.0") == []


@given(
    centre=st.tuples(st.floats(-50, 50), st.floats(-50, 50)),
    turn=st.floats(0.05, 2 * math.pi - 0.05),
    clockwise=st.booleans(),
)
def test_an_arc_stays_on_its_circle_and_goes_the_right_way(
    centre: tuple[float, float], turn: float, clockwise: bool
) -> None:
    radius = math.hypot(*centre)
    if radius < 0.5:
        return
    control = Interpreter(SIEMENS)
    for line in ("%_N_LD_MPF", "G90 G17 G71", "G1 X0.0 Y0.0 F600.0"):
        control.take(line)
    begin = math.atan2(-centre[1], -centre[0])
    end = begin + (-turn if clockwise else turn)
    to_mm = centre[0] + radius * math.cos(end), centre[1] + radius * math.sin(end)
    moves = control.take(arc(to_mm, centre, clockwise=clockwise))
    for move in moves:
        middle = [(a + b) / 2 for a, b in zip(move.start, move.end, strict=True)][:2]
        assert math.dist(move.end[:2], centre) == pytest.approx(radius, abs=0.01)
        assert math.dist(middle, centre) == pytest.approx(radius, abs=CHORD_MM + 0.01)
    assert sum(move.length_mm for move in moves) == pytest.approx(radius * turn, rel=0.01, abs=0.02)


@pytest.mark.parametrize("clockwise", [True, False])
@pytest.mark.parametrize("radius", [5.0, 8.0, -8.0])
def test_an_arc_by_radius_goes_the_short_way_or_with_a_minus_the_long_way(radius: float, clockwise: bool) -> None:
    control = reader()
    control.take("G0 X20.0 Y20.0")
    moves = control.take(f"G{2 if clockwise else 3} X30.0 Y20.0 CR={radius} F600.0")
    half_turn = math.asin(5 / abs(radius))
    turn = 2 * half_turn if radius > 0 else 2 * math.pi - 2 * half_turn
    assert sum(move.length_mm for move in moves) == pytest.approx(abs(radius) * turn, rel=0.01)
    middle = moves[len(moves) // 2].start
    assert (middle[1] > 20) == clockwise


@given(st.lists(st.text(max_size=40) | st.from_regex(r"[GMXYZIJF]-?\d{1,4}\.\d", fullmatch=True), max_size=10))
def test_noise_raises_nothing_but_protocol_errors(lines: list[str]) -> None:
    control = Interpreter(room=ROOM)
    for line in ("%_N_LD_MPF", *lines):
        try:
            control.take(line)
        except ProtocolError:
            return
