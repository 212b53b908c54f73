"""Programs for an EMCO control, compared with golden files and read as the control reads them."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from daemon.errors import OutOfReach, SettingsError
from daemon.program.emco import lift_lines, stop_lines, write_emco
from daemon.program.file import parse_program, program_text
from daemon.program.gcode import ZPen
from daemon.shapes import Points, Program, Stroke, Toolpath
from firmware_protocol.emco.dialects import DIALECTS, DialectName
from firmware_protocol.emco.simulator.interpreter import Interpreter, Room
from tests.daemon.program.examples import TOOLPATH
from tests.daemon.toolpath.strokes import polylines

PEN = ZPen(up_mm=5, down_mm=-0.5, plunge_mm_s=8)
NAMES: dict[DialectName, str] = {"siemens": "LD_TEST", "fanuc": "O0001"}
both = pytest.mark.parametrize("dialect", list(NAMES))


def write(dialect: DialectName, toolpath: Toolpath = TOOLPATH, *, pen: ZPen = PEN, draw_mm_s: float = 20) -> Program:
    return write_emco(toolpath, dialect=dialect, name=NAMES[dialect], pen=pen, draw_mm_s=draw_mm_s)


def texts(program: Program, stroke: int | None = None) -> list[str]:
    return [line.text for line in program.lines if stroke is None or line.stroke == stroke]


def to(x_mm: float, y_mm: float) -> Toolpath:
    """A dot here, and then one there."""
    return Toolpath((Stroke(np.array([[1.0, 1.0]])), Stroke(np.array([[x_mm, y_mm]]))), np.zeros((2, 3)))


@both
def test_the_program_is_the_golden_one(dialect: DialectName, golden: Callable[[str, str], None]) -> None:
    golden(f"emco_{dialect}.gcode", program_text(write(dialect)))


@both
def test_it_survives_being_written_to_a_file_and_read_back(dialect: DialectName) -> None:
    assert parse_program(program_text(write(dialect))) == write(dialect)


@both
@given(polyline_list=st.lists(polylines(), min_size=1, max_size=5))
def test_a_control_draws_the_toolpath_with_the_pen_down_and_parks_with_it_up(
    dialect: DialectName, polyline_list: list[Points]
) -> None:
    program = write(dialect, replace(TOOLPATH, strokes=tuple(map(Stroke, polyline_list))))
    control = Interpreter(DIALECTS[dialect], room=Room((0, 0, -100), (350, 250, 200)))
    drawn: dict[int | None, list[tuple[float, float]]] = {}
    for line in program.lines:
        for move in control.take(line.text):
            if move.end[2] == PEN.down_mm:
                drawn.setdefault(line.stroke, []).append(move.end[:2])
    assert control.ended
    assert control.position_mm == (*TOOLPATH.park_mm, PEN.up_mm)
    for index, points in enumerate(polyline_list):
        kept = [points[0], *(b for a, b in itertools.pairwise(points) if tuple(a) != tuple(b))]
        assert np.array(drawn[index]) == pytest.approx(np.array(kept), abs=6e-4)


@both
def test_blocks_are_short_numbers_have_points_and_neither_spindle_nor_coolant_is_started(dialect: DialectName) -> None:
    blocks = texts(write(dialect))[2:]
    words = [word for block in blocks for word in block.split(" ") if word != "%"]
    assert max(map(len, blocks)) <= 80
    assert all("." in word for word in words if word[0] in "XYZFIJ")
    assert {word for word in words if word[0] not in "XYZFIJ"} == {
        "G0", "G1", "G17", "G54", "G64", DIALECTS[dialect].metric, "G90", "G94", "M5", "M9", "M30",
    }  # fmt: skip


@both
def test_the_pen_is_raised_before_anything_moves(dialect: DialectName) -> None:
    program = texts(write(dialect))
    assert program.index("G54 G0 Z5.0") < next(i for i, text in enumerate(program) if "X" in text)
    assert lift_lines(dialect, PEN)[-1] == "G54 G0 Z5.0"


@both
def test_a_program_that_is_broken_off_is_ended_for_the_control(dialect: DialectName) -> None:
    control = Interpreter(DIALECTS[dialect])
    for text in (*texts(write(dialect))[:8], *stop_lines(dialect, PEN)):
        control.take(text)
    assert control.ended
    assert control.position_mm[2] == PEN.up_mm


@both
def test_each_line_knows_its_stroke(dialect: DialectName) -> None:
    program = write(dialect)
    strokes = [line.stroke for line in program.lines]
    assert (strokes[:4], strokes[-1], program.strokes) == ([None] * 4, None, 3)
    assert [index for index in strokes if index is not None] == [0] * 5 + [1] * 7 + [2] * 3


@pytest.mark.parametrize(("place", "axis"), [((350.001, 0), "X"), ((0, 250.001), "Y"), ((-350.1, 0), "X")])
def test_more_than_the_travel_is_refused_and_the_stroke_is_named(place: tuple[float, float], axis: str) -> None:
    with pytest.raises(OutOfReach, match=rf"stroke 1 the drawing reaches from {axis}"):
        write("fanuc", to(*place))


@pytest.mark.parametrize("place", [(350, 250), (-349, -249), (0, 0)])
def test_all_of_the_travel_can_be_used_on_either_side_of_the_origin(place: tuple[float, float]) -> None:
    write("siemens", to(*place))


def test_a_park_position_out_of_travel_is_refused() -> None:
    with pytest.raises(OutOfReach, match="the park position"):
        write("fanuc", replace(TOOLPATH, park_mm=(0, 300)))


def test_a_lift_higher_than_z_travels_is_refused() -> None:
    with pytest.raises(OutOfReach, match="Z travels 300"):
        write("fanuc", pen=ZPen(up_mm=301))


@pytest.mark.parametrize(
    ("pen", "draw_mm_s", "name"), [(PEN, 251, "draw_mm_s = 251"), (ZPen(plunge_mm_s=300), 20, "plunge_mm_s = 300")]
)
def test_a_feed_that_the_machine_does_not_have_is_refused(pen: ZPen, draw_mm_s: float, name: str) -> None:
    with pytest.raises(SettingsError, match=name):
        write("fanuc", pen=pen, draw_mm_s=draw_mm_s)


@pytest.mark.parametrize(("pen", "draw_mm_s"), [(PEN, 0.0), (ZPen(plunge_mm_s=0), 20.0)])
def test_a_speed_of_nothing_is_refused(pen: ZPen, draw_mm_s: float) -> None:
    with pytest.raises(ValueError, match="give speeds above 0"):
        write("siemens", pen=pen, draw_mm_s=draw_mm_s)


def test_a_name_that_the_control_does_not_take_is_refused() -> None:
    with pytest.raises(SettingsError, match="two letters"):
        write_emco(TOOLPATH, dialect="siemens", name="1", pen=PEN, draw_mm_s=20)


def test_moves_shorter_than_the_last_decimal_are_not_sent() -> None:
    tiny = replace(TOOLPATH, strokes=(Stroke(np.array([[1.0, 1], [1.0002, 1], [2, 1]])),))
    assert sum("X" in text for text in texts(write("siemens", tiny), 0)) == 2
