"""Where a program leads the pen, line by line."""

from __future__ import annotations

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from firmware_protocol.grbl.moves import Arc, Straight
from firmware_protocol.grbl.path import Modal, Path, Spot
from firmware_protocol.grbl.replies import Triple

STEPS = (250.0, 250.0, 250.0)
START = Modal(place=(0.0, 0.0, 5.0))


def path(*lines: str, start: Modal = START) -> Path:
    return Path(lines, start, steps_mm=STEPS)


@pytest.mark.parametrize(
    ("lines", "place"),
    [
        (["G0 X1 Y2"], (1.0, 2.0, 5.0)),
        (["G1X1F100", "Y2", "Z-.5"], (1.0, 2.0, -0.5)),
        (["g20 g0 x1"], (25.4, 0.0, 5.0)),
        (["G91 G0 X1", "X1", "G90", "Y7"], (2.0, 7.0, 5.0)),
        (["G2 X10 Y0 I5 J0"], (10.0, 0.0, 5.0)),
        (["N7 G0 X3"], (3.0, 0.0, 5.0)),
        (["G4 P1", "M3 S90", "S30"], (0.0, 0.0, 5.0)),
        (["$H", "G0 X1"], (1.0, None, None)),
        (["G28", "G0 X1 Y1 Z1"], (1.0, 1.0, 1.0)),
        (["G92 X0", "G0 X1"], (None, None, None)),
    ],
)
def test_the_place_behind_the_last_line(lines: list[str], place: tuple[float | None, ...]) -> None:
    assert path(*lines).end.place == place


def test_the_modal_state_goes_from_line_to_line() -> None:
    end = path("G20 G91 G18", "M4 S80", "G1 X1 F10", "S70").end
    assert (end.inches, end.relative, end.plane, end.motion) == (True, True, 18, 1)
    assert (end.spindle, end.speed, end.feed_mm_min) == (4, 70.0, 254.0)


def test_what_nobody_knows_is_no_place_on_the_path() -> None:
    for line in ("$H", "G28", "G53 G0 X1", "G2 X1 R5"):
        assert path(line).spots((0.0, 0.0, 5.0), 0, 1, within_mm=0.1) is None
    assert path("G92 X7", "G0 X9").spots((9.0, 0.0, 5.0), 1, 2, within_mm=0.1) is None


def test_spots_are_found_on_the_lines_in_question() -> None:
    square = path("G1 X10 F600", "Y10", "X0", "Y0")
    assert square.spots((10.0, 5.0, 5.0), 0, 4, within_mm=0.01) == [Spot(1, 0.5)]
    assert square.spots((10.0, 5.0, 5.0), 2, 4, within_mm=0.01) == []
    assert square.spots((10.0, 10.0, 5.0), 0, 4, within_mm=0.01) == [Spot(1, 1.0), Spot(2, 0.0)]
    assert square.spots((10.0, 5.0, 4.0), 0, 4, within_mm=0.01) == []


def test_lines_that_do_not_move_a_motor_take_no_room_in_the_planner() -> None:
    lines = path("G0 X1", "X1", "X1.0001", "M3 S1", "X2", "Y1", "G2 X2 Y1 I1 J0")
    assert [lines.back_from(7, moves) for moves in (0, 1, 2, 3, 4, 5)] == [7, 6, 5, 4, 0, 0]


def test_the_program_can_go_on_in_another_way() -> None:
    other = path("G0 X1", "X2", "X3")
    other.replace_from(1, ["G91", "Y4", "Y4"])
    assert (len(other.steps), other.end.place) == (4, (1.0, 8.0, 5.0))


@pytest.mark.parametrize(
    ("clockwise", "end", "length"),
    [(True, (10.0, 0.0, 0.0), 15.708), (False, (5.0, 5.0, 0.0), 23.562), (True, (0.0, 0.0, 0.0), 31.416)],
)
def test_arcs_have_the_length_of_the_way_round(clockwise: bool, end: Triple, length: float) -> None:
    arc = Arc((0.0, 0.0, 0.0), end, (5.0, 0.0), clockwise)
    assert arc.length_mm == pytest.approx(length, abs=0.001)


PLACES = st.tuples(*[st.floats(-50, 50)] * 3)


@given(PLACES, PLACES, st.floats(0, 1), st.booleans(), st.booleans())
def test_every_place_of_a_move_is_found_on_it(
    start: Triple, end: Triple, part: float, clockwise: bool, round_: bool
) -> None:
    move: Arc | Straight = Straight(start, end)
    if round_:
        assume(math.dist(start[:2], end[:2]) > 0.1)
        # The end is brought onto the circle about the middle.
        middle = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2)
        move = Arc(start, end, middle, clockwise)
    off_mm, found = move.nearest(move.at(part))
    assert off_mm < 1e-3
    assert move.length_mm * abs(found - part) < 1e-3 or move.at(found) == pytest.approx(move.at(part), abs=1e-3)


def test_a_flat_arc_is_watched_as_closely_as_a_line_and_one_off_its_circle_less() -> None:
    flat, off = path("G0 X0 Y0", "G2 X100 Y0 I50 J-500"), path("G0 X0 Y0", "G2 X100.3 Y0 I50 J-500")
    top_mm = math.hypot(50, 500) - 500
    assert flat.spots((50.0, top_mm, 5.0), 1, 2, within_mm=0.03)
    assert flat.spots((50.0, top_mm + 0.04, 5.0), 1, 2, within_mm=0.03) == []
    assert off.spots((50.0, top_mm + 0.04, 5.0), 1, 2, within_mm=0.03)
