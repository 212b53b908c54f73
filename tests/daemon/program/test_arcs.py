"""Arcs in programs: what a controller makes of them is the toolpath's line."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from daemon.program.dobot import write_dobot
from daemon.program.emco import write_emco
from daemon.program.gcode import ZPen, write_gcode
from daemon.shapes import Arc, Line, Points, Program, Stroke, Toolpath
from daemon.toolpath.curves import CHORD_MM, fitted, points_of
from firmware_protocol.dobot.commands import parse
from firmware_protocol.emco.dialects import BLOCK_CHARACTERS, DIALECTS, DialectName
from firmware_protocol.emco.simulator.interpreter import Interpreter
from firmware_protocol.gcode import LINE_CHARACTERS
from firmware_protocol.grbl.simulator.planner import line_ends, line_times_s
from firmware_protocol.session import Ended, Paused, Verdict
from tests.daemon.program.examples import TOOLPATH
from tests.daemon.toolpath.strokes import curves, hausdorff_mm, nearest_mm
from tests.firmware_protocol.grbl.driver import Line as JobLine
from tests.firmware_protocol.grbl.pair import FAST, TOUCHES_MM, Pair, plotter

PEN = ZPen(up_mm=5, down_mm=0, plunge_mm_s=10)
NAMES: dict[DialectName, str] = {"siemens": "LD_TEST", "fanuc": "O0001"}
START = np.array([10.0, 0.0])
MOVES = (
    Arc((5.0, 5.0), (5.0, 0.0), clockwise=False),
    Arc((0.0, 0.0), (5.0, 0.0), clockwise=False),
    Line((0.0, -3.0)),
    Line((2.0, -3.0)),
    Arc((4.0, -3.0), (3.0, -3.0), clockwise=True),
)
BOWS = Stroke(points_of(START, MOVES), moves=MOVES)


def toolpath_of(*strokes: Stroke) -> Toolpath:
    return replace(TOOLPATH, strokes=strokes, park_mm=(0.0, 0.0))


def placed(points: Points) -> Stroke:
    """A traced curve as a stroke that any machine reaches."""
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    return fitted(Stroke(points - middle + [60.0, 60.0]), error_mm=0.05)


def drawing_texts(program: Program) -> list[str]:
    return [line.text for line in program.lines if line.stroke == 0]


def test_arcs_state_their_end_and_the_way_to_their_centre_and_g2_and_g3_where_they_change() -> None:
    assert drawing_texts(write_gcode(toolpath_of(BOWS), pen=PEN, draw_mm_s=20))[2:-1] == [
        "G3 X5.000 Y5.000 I-5.000 J0.000 F1200",
        "X0.000 Y0.000 I0.000 J-5.000",
        "G1 X0.000 Y-3.000",
        "X2.000 Y-3.000",
        "G2 X4.000 Y-3.000 I1.000 J0.000",
    ]


@pytest.mark.parametrize("dialect", list(NAMES))
def test_an_emco_gets_whole_blocks(dialect: DialectName) -> None:
    program = write_emco(toolpath_of(BOWS), dialect=dialect, name=NAMES[dialect], pen=PEN, draw_mm_s=20)
    assert drawing_texts(program)[2:-1] == [
        "G3 X5.0 Y5.0 I-5.0 J0.0 F1200.0",
        "G3 X0.0 Y0.0 I0.0 J-5.0",
        "G1 X0.0 Y-3.0",
        "G1 X2.0 Y-3.0",
        "G2 X4.0 Y-3.0 I1.0 J0.0",
    ]


def test_an_arc_that_three_decimals_do_not_show_is_not_sent_for_it_would_be_a_whole_turn() -> None:
    moves = (Arc((10.0004, 0.0), (10.0002, 0.0), clockwise=True), Line((12.0, 0.0)))
    tiny = Stroke(np.array([START, [12.0, 0.0]]), moves=moves)
    assert drawing_texts(write_gcode(toolpath_of(tiny), pen=PEN, draw_mm_s=20))[2:-1] == ["G1 X12.000 Y0.000 F1200"]


@settings(max_examples=40, deadline=None)
@given(curves())
def test_grbl_takes_every_arc_and_draws_the_line(points: Points) -> None:
    stroke = placed(points)
    program = write_gcode(toolpath_of(stroke), pen=PEN, draw_mm_s=20)
    texts = [line.text for line in program.lines]
    assert line_ends(texts)[-1].position_mm == pytest.approx((0, 0, 5), abs=0.01)
    assert max(len(text.replace(" ", "")) for text in texts) <= LINE_CHARACTERS
    pair = Pair(plotter()).ready()
    assert pair.draw([JobLine(line.text, line.stroke) for line in program.lines]).verdict is Verdict.FINISHED
    ink = max(pair.sim.ink, key=len)
    assert hausdorff_mm(np.array(ink), stroke.points, step_mm=0.5) <= CHORD_MM + 0.01


@settings(max_examples=40, deadline=None)
@given(curves(), st.sampled_from(sorted(NAMES)))
def test_an_emco_takes_every_arc_and_draws_the_line(points: Points, dialect: DialectName) -> None:
    stroke = placed(points)
    program = write_emco(toolpath_of(stroke), dialect=dialect, name=NAMES[dialect], pen=PEN, draw_mm_s=20)
    control = Interpreter(DIALECTS[dialect])
    moves = [move for line in program.lines for move in control.take(line.text)]
    ink = np.array([place[:2] for move in moves if move.end[2] == 0 for place in (move.start, move.end)])
    assert hausdorff_mm(ink, stroke.points, step_mm=0.5) <= CHORD_MM + 0.01
    assert max(len(line.text) for line in program.lines) <= BLOCK_CHARACTERS


def test_an_arm_gets_points_near_to_the_arcs() -> None:
    ring = fitted(
        Stroke(np.array([[40 + 9 * math.cos(n / 50), 50 + 9 * math.sin(n / 50)] for n in range(250)])), error_mm=0.05
    )
    program = write_dobot(toolpath_of(ring), up_mm=10, down_mm=-10, draw_mm_s=40, sheet_origin_mm=(190.0, -57.0))
    commands = [parse(line.text) for line in program.lines if line.text.startswith("CP ")]
    on_sheet = np.array([(float(c.values[1]) - 190, float(c.values[2]) + 57) for c in commands])
    way = points_of(ring.points[0], ring.moves or (), chord_mm=1e-3)
    assert hausdorff_mm(np.concatenate([ring.points[:1], on_sheet]), way) <= CHORD_MM + 2e-3


def test_a_curve_is_drawn_faster_as_arcs_than_as_the_pieces_that_are_as_near_to_it() -> None:
    angle = np.linspace(0, 3 * math.tau, 600)
    spiral = np.stack([60 + (2 + angle) * np.cos(angle), 60 + (2 + angle) * np.sin(angle)], axis=1)
    arcs = fitted(Stroke(spiral), error_mm=0.05)
    pieces = Stroke(points_of(spiral[0], arcs.moves or (), chord_mm=0.05))
    programs = [write_gcode(toolpath_of(each), pen=PEN, draw_mm_s=40) for each in (arcs, pieces)]
    times_s = [line_times_s([line.text for line in program.lines], FAST)[-1] for program in programs]
    assert times_s[0] < 0.9 * times_s[1]


@pytest.mark.parametrize("pauses_s", [[0.9], [1.5, 0.3, 0.3], [2.2, 1.0], [1.2, 0.05, 2.0, 0.4]])
def test_a_line_that_is_cut_within_an_arc_goes_on_there(pauses_s: list[float]) -> None:
    angle = np.linspace(0, 2 * math.tau, 300)
    snail = np.stack([30 + (3 + angle) * np.cos(angle), 30 + (3 + angle) * np.sin(angle)], axis=1)
    toolpath = toolpath_of(fitted(Stroke(snail), error_mm=0.05), BOWS)
    program = write_gcode(toolpath, pen=PEN, draw_mm_s=40)
    pair = Pair(plotter()).ready()
    pair.session.start([JobLine(line.text, line.stroke) for line in program.lines], pair.now)
    for pause_s in pauses_s:
        pair.wait(pause_s)
        pair.session.pause(pair.now, at_once=True)
        pair.wait_for(lambda: pair.session.state.name in {"PAUSED", "READY"})
        if pair.session.state.name == "PAUSED":
            pair.session.resume(pair.now)
    pair.wait_for(lambda: any(isinstance(event, Ended) for event in pair.events))
    (end,) = [event for event in pair.events if isinstance(event, Ended)]
    assert any(isinstance(event, Paused) for event in pair.events)
    assert (end.verdict, end.strokes_certain) == (Verdict.FINISHED, 2)
    ink = np.concatenate([np.array(line) for line in pair.sim.ink if len(line) > 1])
    wanted = np.concatenate([stroke.points for stroke in toolpath.strokes])
    assert furthest_mm(wanted, pair.sim.ink) < TOUCHES_MM
    assert furthest_mm(ink, [stroke.points.tolist() for stroke in toolpath.strokes]) < TOUCHES_MM


def furthest_mm(places: Points, lines: Sequence[Sequence[tuple[float, float]]]) -> float:
    """The furthest that one of the places lies from the nearest of some polylines."""
    every = [nearest_mm(places, np.array(line, float)) for line in lines]
    return float(np.min(every, axis=0).max())
