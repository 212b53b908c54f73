"""Commands for the arm, compared with a golden file and drawn by the simulated one."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from daemon.errors import OutOfReach
from daemon.program.dobot import CHORD_MM, COMMANDS_S, write_dobot
from daemon.program.file import parse_program, program_text
from daemon.shapes import Points, Program, Stroke, Toolpath
from firmware_protocol.dobot.commands import Command, parse
from firmware_protocol.dobot.kinematics import MARGIN_MM, SHEET_ORIGIN_MM, reaches
from firmware_protocol.dobot.simulator.options import simulator_from
from firmware_protocol.ink import PenRule
from firmware_protocol.session import Verdict
from tests.daemon.program.examples import TOOLPATH
from tests.firmware_protocol.dobot.bench import Bench, Line

UP, DOWN = 10.0, -10.0


def written(toolpath: Toolpath, draw_mm_s: float = 40.0, straight: str = "CP") -> Program:
    return write_dobot(toolpath, up_mm=UP, down_mm=DOWN, draw_mm_s=draw_mm_s, straight=straight)


def commands_of(program: Program, name: str) -> list[Command]:
    return [command for command in (parse(line.text) for line in program.lines) if command.kind.name == name]


def toolpath_of(*polylines: list[tuple[float, float]]) -> Toolpath:
    strokes = tuple(Stroke(np.array(polyline, float)) for polyline in polylines)
    return replace(TOOLPATH, strokes=strokes, park_mm=(25.0, 57.0))


def drawn(program: Program) -> Bench:
    """The program on a simulated arm."""
    bench = Bench(up_mm=UP)
    bench.sim = simulator_from({}, pen=PenRule(down_at_mm=DOWN + 0.01))
    bench.sim.open(0.0)
    assert bench.draw([Line(line.text, line.stroke) for line in program.lines]).verdict is Verdict.FINISHED
    return bench


def test_the_program_is_the_golden_one(golden: Callable[[str, str], None]) -> None:
    golden("dobot.txt", program_text(written(TOOLPATH)))


def test_it_survives_being_written_to_a_file() -> None:
    program = written(TOOLPATH)
    assert parse_program(program_text(program)) == program


def test_the_sheets_corner_lies_where_it_is_said() -> None:
    program = write_dobot(TOOLPATH, sheet_origin_mm=(200.0, -60.0), up_mm=UP, down_mm=DOWN, draw_mm_s=20)
    first = commands_of(program, "PTP")[0]
    assert first.values == (2, 230.0, -20.0, UP, 0.0)
    assert commands_of(written(TOOLPATH), "PTP")[0].values[1:3] == (30 + SHEET_ORIGIN_MM[0], 40 + SHEET_ORIGIN_MM[1])


def test_within_a_stroke_the_arm_moves_by_cp_and_between_by_ptp() -> None:
    names = [line.text.split()[0] for line in written(TOOLPATH).lines if line.stroke == 0]
    assert names[:2] == ["PTP", "PTP"]
    assert names[-1] == "PTP"
    assert set(names[2:-1]) == {"CP"}


def test_for_an_arm_without_cp_each_segment_is_a_move_of_its_own() -> None:
    program = written(TOOLPATH, straight="PTP")
    assert commands_of(program, "CP") == []
    assert drawn(program).sim.ink == drawn(written(TOOLPATH)).sim.ink


def test_a_dot_is_the_pen_down_and_up() -> None:
    heights = [command.values[3] for command in commands_of(written(toolpath_of([(40.0, 50.0)])), "PTP")]
    assert heights == [UP, DOWN, UP, UP]


POINTS = st.tuples(st.floats(0, 75), st.floats(0, 75))


@settings(max_examples=40, deadline=None)
@given(st.lists(st.lists(POINTS, min_size=1, max_size=8), min_size=1, max_size=4))
def test_the_arm_draws_the_toolpath_in_bounded_segments(polylines: list[list[tuple[float, float]]]) -> None:
    program = written(toolpath_of(*polylines), draw_mm_s=100.0)
    ink = drawn(program).sim.ink
    assert len(ink) == len(polylines)
    for line, wanted in zip(ink, polylines, strict=True):
        assert line[0] == pytest.approx(wanted[0], abs=2e-3)
        assert line[-1] == pytest.approx(wanted[-1], abs=2e-3)
        for point in wanted:
            assert min(math.dist(point, near) for near in line) < 2e-3
        assert all(math.dist(a, b) <= CHORD_MM + 4e-3 for a, b in pairwise(line))


def test_short_segments_are_drawn_as_slowly_as_the_wire_needs() -> None:
    circle = [(40 + 5 * math.cos(k / 50), 50 + 5 * math.sin(k / 50)) for k in range(315)]
    program = written(toolpath_of(circle), draw_mm_s=100.0)
    speeds = [float(command.values[4]) for command in commands_of(program, "CP")]
    assert all(speed == pytest.approx(0.1 * COMMANDS_S, rel=0.03) for speed in speeds)
    assert drawn(program).sim.arm.waited_on_paper_s == 0.0


def test_what_is_out_of_reach_is_named_with_the_largest_sheet() -> None:
    toolpath = toolpath_of([(10, 10), (20, 20)], [(10, 10), (200, 200)])
    with pytest.raises(OutOfReach) as raised:
        written(toolpath)
    said = str(raised.value)
    assert "stroke 1 leaves the arm's reach on its way to (200.0, 200.0) mm of the sheet" in said
    assert "the largest sheet of its proportions there is 11" in said
    assert said.rsplit(": ", maxsplit=1)[-1] == "make the drawing smaller"


def test_an_origin_out_of_reach_says_where_it_may_lie() -> None:
    with pytest.raises(OutOfReach, match=r"sheet_origin_mm itself is not in reach: set it near \(190, -57\)"):
        write_dobot(TOOLPATH, sheet_origin_mm=(25.0, 25.0), up_mm=UP, down_mm=DOWN, draw_mm_s=20)


def test_the_way_to_the_park_position_is_checked_too() -> None:
    with pytest.raises(OutOfReach, match="the way to the park position leaves"):
        written(replace(toolpath_of([(10, 10), (20, 20)]), park_mm=(0.0, 300.0)))


def test_heights_that_the_arm_does_not_reach_are_refused() -> None:
    with pytest.raises(OutOfReach, match="does not reach the heights -10 and 400 mm"):
        write_dobot(TOOLPATH, up_mm=400.0, down_mm=DOWN, draw_mm_s=20)


@pytest.mark.parametrize(
    ("up_mm", "draw_mm_s", "straight"), [(-10.0, 20.0, "CP"), (10.0, 0.0, "CP"), (10.0, 9.0, "G1")]
)
def test_senseless_settings_are_refused(up_mm: float, draw_mm_s: float, straight: str) -> None:
    with pytest.raises(ValueError, match="draw_mm_s = "):
        write_dobot(TOOLPATH, up_mm=up_mm, down_mm=DOWN, draw_mm_s=draw_mm_s, straight=straight)


@settings(max_examples=60, deadline=None)
@given(st.lists(st.lists(st.tuples(st.floats(-80, 200), st.floats(-80, 200)), min_size=1, max_size=5), max_size=4))
def test_every_place_of_a_written_program_is_in_reach_with_its_margin(
    polylines: list[list[tuple[float, float]]],
) -> None:
    try:
        program = written(toolpath_of(*polylines))
    except OutOfReach:
        return
    for command in (*commands_of(program, "PTP"), *commands_of(program, "CP")):
        x, y, z = (float(value) for value in command.values[1:4])
        further = 1 + (MARGIN_MM - 0.1) / math.hypot(x, y)
        assert reaches((x, y, z))
        assert reaches((x * further, y * further, z))


def test_no_strokes_still_park() -> None:
    empty = Toolpath((), np.zeros((2, 3)), park_mm=(25.0, 57.0))
    assert [line.text.split()[0] for line in written(empty).lines] == [
        "PTPCoordinateParams", "PTPCommonParams", "CPParams", "PTP",
    ]  # fmt: skip


def test_points_are_rounded_not_repeated() -> None:
    points: Points = np.array([[40.0, 40.0], [40.0001, 40.0], [45.0, 40.0]])
    assert len(commands_of(written(replace(TOOLPATH, strokes=(Stroke(points),))), "CP")) == 1
