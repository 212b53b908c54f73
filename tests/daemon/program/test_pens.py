"""Programs of several pens: parked, a stop, and what is said of each pen."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest

from daemon.program.dobot import write_dobot
from daemon.program.emco import write_emco
from daemon.program.file import parse_program, program_text
from daemon.program.gcode import ZPen, write_gcode
from daemon.program.paper import write_paper
from daemon.program.svg import read_svg, write_svg
from daemon.shapes import NamedPen, Program, Stroke, Toolpath
from tests.daemon.program.examples import DOT, LINE, SQUARE, TOOLPATH

PENS = (NamedPen("black", "#111111"), NamedPen("red", "#d03030"), NamedPen("sea-blue", "#2040c0"))
STROKES = (LINE, SQUARE, replace(LINE, pen=2), replace(DOT, pen=2))
THREE = replace(TOOLPATH, strokes=STROKES, pens=PENS)
ON_ARM = replace(THREE, strokes=tuple(Stroke(each.points, each.pen) for each in STROKES), park_mm=(5.0, 5.0))

WRITERS: dict[str, Callable[[Toolpath], Program]] = {
    "grbl": lambda path: write_gcode(path, pen=ZPen(), draw_mm_s=20),
    "paper": write_paper,
    "siemens": lambda path: write_emco(path, dialect="siemens", name="LD_A", pen=ZPen(), draw_mm_s=20),
    "fanuc": lambda path: write_emco(path, dialect="fanuc", name="O0001", pen=ZPen(), draw_mm_s=20),
    "dobot": lambda path: write_dobot(path, up_mm=10, down_mm=0, draw_mm_s=20),
}
STOPS = {"grbl": "M0", "paper": "M0", "siemens": "M0 ; SEA-BLUE PEN", "fanuc": "M0 (SEA-BLUE PEN)", "dobot": "M0"}


@pytest.mark.parametrize("writer", WRITERS)
def test_a_program_parks_and_stops_before_the_next_pen_and_its_file_says_so(writer: str) -> None:
    program = WRITERS[writer](ON_ARM)
    assert dict(program.passes) == {0: "black", 2: "sea-blue"}
    assert [program.pen_of(stroke) for stroke in range(4)] == ["black", "black", "sea-blue", "sea-blue"]
    (stop,) = (number for number, line in enumerate(program.lines) if line.text.startswith("M0"))
    assert (program.lines[stop].text, program.lines[stop].stroke) == (STOPS[writer], 1)
    assert program.lines[stop + 1].stroke == 2
    if writer != "paper":  # in whose form a park position has no place
        parks = [line.text for line in program.lines if line.text == program.lines[stop - 1].text]
        assert len(parks) == 2
    assert parse_program(program_text(program)) == program


@pytest.mark.parametrize("writer", WRITERS)
def test_with_one_pen_everything_is_as_without_pens(writer: str) -> None:
    one = replace(ON_ARM, strokes=ON_ARM.strokes[:2])
    assert WRITERS[writer](one).lines == WRITERS[writer](replace(one, pens=())).lines


def test_the_svg_has_a_group_for_each_pen_in_its_colour() -> None:
    text = write_svg(THREE, size_mm=(90, 90))
    groups = [element for element in ElementTree.fromstring(text) if element.tag.endswith("}g")]
    assert [(group.get("id"), group.get("stroke"), len(group)) for group in groups] == [
        ("black", "#111111", 2),
        ("sea-blue", "#2040c0", 2),
    ]
    assert len(read_svg(text)) == 4


def test_travel_leads_by_the_park_place() -> None:
    path = replace(THREE, strokes=STROKES[:1] + STROKES[3:])
    ways = [((0.0, 0.0), LINE.points[0]), (LINE.points[-1], path.park_mm), (path.park_mm, DOT.points[0])]
    expected = sum(np.hypot(*np.subtract(a, b)) for a, b in [*ways, (DOT.points[-1], path.park_mm)])
    assert path.travelled_mm == pytest.approx(expected)
