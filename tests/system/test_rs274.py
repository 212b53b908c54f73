"""LinuxCNC reads our programs without a complaint, and what it would do is what we have planned."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from daemon.graph.interpret import interpret
from daemon.graph.strokes import strokes
from daemon.intake.decode import decode
from daemon.page.prepare import prepare
from daemon.program.emco import write_emco
from daemon.program.gcode import ServoPen, ZPen, write_gcode
from daemon.program.paper import write_paper
from daemon.shapes import Arc, Program, Toolpath
from daemon.toolpath.place import Layout
from daemon.toolpath.plan import Precision, plan_toolpath
from daemon.vision.segmenter import Segmenter
from tests.drawings.make import SHEETS, Sheet
from tests.system.rs274 import Canonical, Rs274

pytestmark = pytest.mark.system

DRAWINGS = Path(__file__).parents[1] / "drawings"
PEN = ZPen(up_mm=5.0, down_mm=-0.5)
DRAW_MM_S = 20.0
MICROMETRE = 1e-3 + 1e-9

PROGRAMS = {
    "siemens": lambda path: write_emco(path, dialect="siemens", name="LD_TEST", pen=PEN, draw_mm_s=DRAW_MM_S),
    "fanuc": lambda path: write_emco(path, dialect="fanuc", name="O0001", pen=PEN, draw_mm_s=DRAW_MM_S),
    "grbl": lambda path: write_gcode(path, pen=PEN, draw_mm_s=DRAW_MM_S),
    "grbl servo": lambda path: write_gcode(path, pen=ServoPen(0, 1000), draw_mm_s=DRAW_MM_S),
    "paper": lambda path: write_paper(path, draw_mm_s=DRAW_MM_S),
}
PEN_Z = {"siemens": (5.0, -0.5), "fanuc": (5.0, -0.5), "grbl": (5.0, -0.5), "paper": (-5.0, 0.0)}
"""Up and down; the servo hangs on no axis."""
DECIMALS = {"paper": 2}
"""The paper writes two; all others three."""


@pytest.fixture(scope="module")
def rs274() -> Iterator[Rs274]:
    with tempfile.TemporaryDirectory() as folder:
        yield Rs274(Path(folder))


@pytest.fixture(scope="module")
def segmenter() -> Segmenter:
    return Segmenter(threads=1)


def planned(file: str, segmenter: Segmenter, *, curve_mm: float = 0.0) -> Toolpath:
    """The toolpath of one of our own drawings, through every room."""
    page = prepare(decode(DRAWINGS / file))
    height_px, width_px = page.grey.shape
    drawing = strokes(interpret(page, segmenter.segment(page)), width_px=width_px, height_px=height_px)
    layout, precision = Layout((64.0, 64.0), (25.0, 25.0)), Precision(curve_mm=curve_mm)
    return plan_toolpath(drawing, layout=layout, precision=precision, park_mm=(10.0, 80.0))


def as_linuxcnc_reads_it(program: Program, kind: str) -> str:
    """A Siemens frame is not LinuxCNC's language: its two head lines are left out, and its G71 is LinuxCNC's G21.

    A GRBL program has no end of its own, so it is put between two `%`, which LinuxCNC takes for one. All others are
    read as they are.
    """
    lines = [line.text for line in program.lines]
    if kind == "siemens":
        lines = [line.replace("G71", "G21") for line in lines[2:]]
    elif kind.startswith("grbl"):
        lines = ["%", *lines, "%"]
    return "\n".join(lines) + "\n"


def wanted(toolpath: Toolpath, kind: str) -> list[tuple[str, float, float]]:
    """Each move in the plane: travel to a stroke, along it, and at last to the park position."""
    moves = [move for stroke in toolpath.strokes for move in _along(stroke.points.tolist())]
    parks = [] if kind == "paper" else [("TRAVERSE", *toolpath.park_mm)]
    places = [*moves, *parks]
    if decimals := DECIMALS.get(kind):
        places = [(how, round(x, decimals), round(y, decimals)) for how, x, y in places]
    return _that_move(places)


def _along(points: list[list[float]]) -> Iterator[tuple[str, float, float]]:
    for index, (x, y) in enumerate(points):
        yield ("FEED" if index else "TRAVERSE"), x, y


def _that_move(places: list[tuple[str, float, float]]) -> list[tuple[str, float, float]]:
    """Without those that stay in the plane where they are, as far as three decimals show."""
    begun = [("TRAVERSE", 0.0, 0.0), *places]
    return [b for a, b in pairwise(begun) if (round(a[1], 3), round(a[2], 3)) != (round(b[1], 3), round(b[2], 3))]


def done(moves: list[Canonical]) -> list[tuple[str, float, float]]:
    return _that_move([(move.kind, move.x, move.y) for move in moves])


@pytest.mark.parametrize("sheet", SHEETS, ids=lambda sheet: sheet.file)
def test_every_drawing_is_read_and_drawn_as_planned(sheet: Sheet, rs274: Rs274, segmenter: Segmenter) -> None:
    toolpath = planned(sheet.file, segmenter)
    for kind, write in PROGRAMS.items():
        moves = rs274.read(as_linuxcnc_reads_it(write(toolpath), kind))
        expected, found = wanted(toolpath, kind), done(moves)
        assert [how for how, *_ in found] == [how for how, *_ in expected], kind
        off_mm = np.array([place for _, *place in found]) - np.array([place for _, *place in expected])
        assert np.hypot(*off_mm.T).max() <= MICROMETRE, kind
        check_pen(moves, kind)


def check_pen(moves: list[Canonical], kind: str) -> None:
    """The pen is down where it draws and up where it travels."""
    if kind not in PEN_Z:
        return
    up_mm, down_mm = PEN_Z[kind]
    for before, move in pairwise(moves):
        if (before.x, before.y) != (move.x, move.y):
            assert (before.z, move.z) == ((down_mm,) * 2 if move.kind == "FEED" else (up_mm,) * 2), kind


@pytest.mark.parametrize("kind", ["siemens", "fanuc", "grbl"])
@pytest.mark.parametrize("file", ["spiral.png", "flower.png", "script.png"])
def test_every_arc_is_read_as_it_is_meant(file: str, kind: str, rs274: Rs274, segmenter: Segmenter) -> None:
    """Its end, its centre and the way round; LinuxCNC complains about an end off its circle."""
    toolpath = planned(file, segmenter, curve_mm=0.05)
    moves = [move for stroke in toolpath.strokes for move in stroke.moves or ()]
    read = rs274.read(as_linuxcnc_reads_it(PROGRAMS[kind](toolpath), kind))
    check_pen(read, kind)
    arcs, found = [move for move in moves if isinstance(move, Arc)], [move for move in read if move.centre]
    assert len(arcs) > 30
    assert [(-1 if arc.clockwise else 1) for arc in arcs] == [move.turns for move in found]
    places = [(move.x, move.y, *(move.centre or ())) for move in found]
    off_mm = np.abs(np.array(places) - [(*arc.end, *arc.centre) for arc in arcs])
    assert off_mm.max() <= 2 * MICROMETRE


def test_a_program_that_is_wrong_is_complained_about(rs274: Rs274) -> None:
    """Otherwise the test above would say nothing."""
    with pytest.raises(AssertionError, match="rs274 complains"):
        rs274.read("%\nG21 G90\nG1 X10 Y10\n%\n")


def test_a_program_that_leaves_its_toolpath_by_two_micrometres_is_noticed(rs274: Rs274, segmenter: Segmenter) -> None:
    toolpath = planned("star.png", segmenter)
    moved = Toolpath(
        tuple(type(stroke)(stroke.points + np.array([0.002, 0.0])) for stroke in toolpath.strokes), toolpath.from_px,
        toolpath.start_mm, toolpath.park_mm,
    )  # fmt: skip
    found = done(rs274.read(as_linuxcnc_reads_it(PROGRAMS["fanuc"](moved), "fanuc")))
    expected = wanted(toolpath, "fanuc")
    off_mm = np.array([place for _, *place in found]) - np.array([place for _, *place in expected])
    assert np.hypot(*off_mm.T).max() > MICROMETRE
