"""G-code for GRBL, compared with golden files and read back."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from daemon.program.file import program_text
from daemon.program.gcode import Pen, ServoPen, ZPen, lift_lines, write_gcode
from daemon.shapes import Points, Program, Stroke, Toolpath
from firmware_protocol.grbl.simulator.planner import line_ends
from tests.daemon.program.examples import TOOLPATH
from tests.daemon.toolpath.strokes import polylines

Z, SERVO = ZPen(up_mm=5, down_mm=-0.5, plunge_mm_s=8), ServoPen(up_s=0, down_s=650, dwell_s=0.25)
NAMES = {Z: "z_pen.gcode", SERVO: "servo_pen.gcode"}


def texts(program: Program, stroke: int | None = None) -> list[str]:
    return [line.text for line in program.lines if stroke is None or line.stroke == stroke]


@pytest.mark.parametrize("pen", [Z, SERVO], ids=["z", "servo"])
def test_the_program_is_the_golden_one(pen: Pen, golden: Callable[[str, str], None]) -> None:
    golden(NAMES[pen], program_text(write_gcode(TOOLPATH, pen=pen, draw_mm_s=20)))


@pytest.mark.parametrize(("pen", "lift"), [(Z, "G0 Z5.000"), (SERVO, "M3 S0 G4 P0.25")], ids=["z", "servo"])
def test_the_pen_is_raised_before_anything_moves(pen: Pen, lift: str) -> None:
    program = texts(write_gcode(TOOLPATH, pen=pen, draw_mm_s=20))
    assert program.index(lift) < next(i for i, text in enumerate(program) if "X" in text)


@given(st.lists(polylines(), min_size=1, max_size=5))
def test_a_controller_draws_the_toolpath_with_the_pen_down_and_parks_with_it_up(polyline_list: list[Points]) -> None:
    toolpath = replace(TOOLPATH, strokes=tuple(map(Stroke, polyline_list)))
    program = write_gcode(toolpath, pen=Z, draw_mm_s=20)
    positions = [end.position_mm for end in line_ends(texts(program))]
    for index, points in enumerate(polyline_list):
        own = [position for position, line in zip(positions, program.lines, strict=True) if line.stroke == index]
        down = np.array([position[:2] for position in own if position[2] == Z.down_mm])
        assert down[0] == pytest.approx(points[0], abs=3e-3)
        assert down[-1] == pytest.approx(points[-1], abs=3e-3)
        assert len(down) <= len(points)
        assert own[-1][2] == Z.up_mm
    assert positions[-1] == pytest.approx((*TOOLPATH.park_mm, Z.up_mm), abs=3e-3)


def test_each_line_knows_its_stroke() -> None:
    program = write_gcode(TOOLPATH, pen=Z, draw_mm_s=20)
    strokes = [line.stroke for line in program.lines]
    assert (strokes[:2], strokes[-1], program.strokes) == ([None, None], None, 3)
    assert [index for index in strokes if index is not None] == sorted([0] * 5 + [1] * 7 + [2] * 3)


def test_a_dot_is_the_pen_down_and_up() -> None:
    program = write_gcode(TOOLPATH, pen=Z, draw_mm_s=20)
    assert texts(program, 2) == ["G0 X12.346 Y0.000", "G1 Z-0.500 F480", "G0 Z5.000"]


def test_moves_shorter_than_the_last_decimal_are_not_sent() -> None:
    tiny = replace(TOOLPATH, strokes=(Stroke(np.array([[1.0, 1], [1.0002, 1], [2, 1]])),))
    assert sum("X" in text for text in texts(write_gcode(tiny, pen=Z, draw_mm_s=20), 0)) == 2


@pytest.mark.parametrize("pen", [Z, SERVO], ids=["z", "servo"])
def test_every_line_is_one_that_grbl_takes(pen: Pen) -> None:
    program = texts(write_gcode(TOOLPATH, pen=pen, draw_mm_s=20))
    assert len(line_ends(program)) == len(program)
    assert all(re.fullmatch(r"([GMXYZFSP]-?\d+(\.\d+)?( |$))+", text) for text in program)


@pytest.mark.parametrize("pen", [Z, SERVO], ids=["z", "servo"])
def test_lifting_needs_nothing_that_was_said_before(pen: Pen) -> None:
    lift = lift_lines(pen)
    assert lift[0] == "G21 G90"
    assert lift[1] == ("G0 Z5.000" if pen is Z else "M3 S0 G4 P0.25")


@pytest.mark.parametrize(("pen", "draw_mm_s"), [(Z, 0.0), (ZPen(plunge_mm_s=0), 20.0)])
def test_a_speed_of_nothing_is_refused(pen: Pen, draw_mm_s: float) -> None:
    with pytest.raises(ValueError, match="give speeds above 0"):
        write_gcode(TOOLPATH, pen=pen, draw_mm_s=draw_mm_s)


def test_no_strokes_still_lift_and_park() -> None:
    empty = Toolpath((), np.zeros((2, 3)))
    assert texts(write_gcode(empty, pen=Z, draw_mm_s=20)) == ["G21 G90", "G0 Z5.000", "G0 X0.000 Y0.000"]
