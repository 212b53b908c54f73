"""Straight moves and arcs stay within the stated error of the traced line, and turn where it turns."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from daemon.shapes import Arc, Line, Points, Stroke
from daemon.toolpath.curves import CHORD_MM, fitted, points_of
from daemon.toolpath.simplify import simplify
from tests.daemon.toolpath.strokes import curves, hausdorff_mm, open_or_closed

ERROR_MM, ALLOWED_MM = 0.05, 0.06


def line_of(stroke: Stroke) -> Points:
    """Along its moves, nearer than any error here."""
    if stroke.moves is None:
        return stroke.points
    return points_of(stroke.points[0], stroke.moves, chord_mm=1e-3)


def ring(radius_mm: float, turn: float = math.tau, count: int = 400) -> Points:
    angle = np.linspace(0, turn, count + 1)
    points = np.stack([50 + radius_mm * np.cos(angle), 50 + radius_mm * np.sin(angle)], axis=1)
    points[-1] = points[0] if turn == math.tau else points[-1]
    return points


@settings(max_examples=60, deadline=None)
@given(curves())
def test_neither_line_leaves_the_other_by_more_than_the_error(points: Points) -> None:
    stroke = fitted(Stroke(points), error_mm=ERROR_MM)
    assert hausdorff_mm(line_of(stroke), points) <= ALLOWED_MM
    assert hausdorff_mm(stroke.points, points) <= ALLOWED_MM
    assert (stroke.points[[0, -1]] == points[[0, -1]]).all()


@settings(max_examples=60, deadline=None)
@given(open_or_closed(), st.sampled_from([0.01, 0.05, 0.3]))
def test_lines_of_any_form_keep_their_ends_and_their_way(stroke: Stroke, error_mm: float) -> None:
    found = fitted(stroke, error_mm=error_mm)
    assert hausdorff_mm(line_of(found), stroke.points) <= 1.2 * error_mm
    assert (found.points[0] == stroke.points[0]).all()
    if found.moves is not None:
        assert (found.points[-1] == stroke.points[-1]).all()


@pytest.mark.parametrize("radius_mm", [0.4, 5.0, 80.0])
def test_a_circle_is_two_arcs(radius_mm: float) -> None:
    moves = fitted(Stroke(ring(radius_mm)), error_mm=ERROR_MM).moves
    assert moves is not None
    arcs = [move for move in moves if isinstance(move, Arc)]
    assert len(moves) == len(arcs) == 2
    assert all(math.dist(arc.centre, (50, 50)) < ERROR_MM for arc in arcs)
    assert not any(arc.clockwise for arc in arcs)


def test_the_same_line_backwards_goes_the_other_way_round() -> None:
    moves = fitted(Stroke(ring(5.0, 2.0)[::-1]), error_mm=ERROR_MM).moves
    assert [type(move) for move in moves or ()] == [Arc]
    assert moves is not None
    assert isinstance(moves[0], Arc)
    assert moves[0].clockwise


@pytest.mark.parametrize("turn_deg", [40, 90, 150, 180])
def test_a_bend_stays_a_point_of_the_line(turn_deg: float) -> None:
    turn = math.radians(turn_deg)
    tip = np.array([10.0, 3.0])
    points = np.stack([[0, 3], tip, tip + 8 * np.array([math.cos(turn), math.sin(turn)])])
    moves = fitted(Stroke(points), error_mm=ERROR_MM).moves
    assert moves == (Line((10.0, 3.0)), Line(tuple(points[2].tolist())))


def test_a_bend_between_curves_stays_a_point_of_the_line() -> None:
    half = ring(8.0, math.pi)
    points = np.concatenate([half, half[1:] - [16.0, 0.0]])
    moves = fitted(Stroke(points), error_mm=ERROR_MM).moves
    assert moves is not None
    assert [type(move) for move in moves] == [Arc, Arc]
    assert math.dist(moves[0].end, half[-1]) < 1e-9


def test_no_arc_rounds_off_bends_that_lie_near_enough_to_it() -> None:
    nonagon = ring(1.46, count=9)
    moves = fitted(Stroke(nonagon), error_mm=ERROR_MM).moves
    assert [move.end for move in moves or ()] == [tuple(corner) for corner in nonagon[1:].tolist()]


def test_a_straight_line_is_one_move_whatever_its_points() -> None:
    points = np.stack([np.linspace(0, 30, 90), np.full(90, 2.0)], axis=1)
    assert fitted(Stroke(points), error_mm=ERROR_MM).moves == (Line((30.0, 2.0)),)


def test_curves_take_a_third_of_the_moves_of_a_polyline() -> None:
    angle = np.linspace(0, 6 * math.pi, 1500)
    spiral = np.stack([(2 + angle) * np.cos(angle), (2 + angle) * np.sin(angle)], axis=1)
    wave = np.stack([np.linspace(0, 60, 600), 6 * np.sin(np.linspace(0, 12, 600))], axis=1)
    for points in (ring(20), spiral, wave):
        moves = fitted(Stroke(points), error_mm=ERROR_MM).moves
        assert 3 * len(moves or ()) <= len(simplify(points, error=ERROR_MM)) - 1


def test_no_arc_bulges_out_of_the_room_that_the_line_stays_in() -> None:
    flat = ring(30.0)
    flat[:, 1] = np.minimum(flat[:, 1], 79.98)
    room = (flat.min(axis=0), flat.max(axis=0))
    free, held = (line_of(fitted(Stroke(flat), error_mm=ERROR_MM, room=each)) for each in (None, room))
    assert (free > room[1] + 1e-6).any()
    assert ((held >= room[0] - 1e-9) & (held <= room[1] + 1e-9)).all()
    assert hausdorff_mm(held, flat) <= ALLOWED_MM


def test_a_closed_line_within_the_error_is_a_dot_and_a_dot_stays_one() -> None:
    for points in (ring(0.02), np.array([[3.0, 4.0]]), np.array([[3.0, 4.0], [3.0, 4.0]])):
        stroke = fitted(Stroke(points, pen=2), error_mm=ERROR_MM)
        assert (stroke.points.tolist(), stroke.moves, stroke.pen) == ([points[0].tolist()], None, 2)


def test_points_nearer_than_a_machine_can_resolve_are_left_out() -> None:
    points = np.array([[0.0, 0], [5, 0], [5.004, 0.006], [5, 5], [5.003, 5.001]])
    moves = fitted(Stroke(points), error_mm=0.001, shortest_mm=0.02).moves
    assert moves == (Line((5.0, 0.0)), Line((5.003, 5.001)))


def test_points_are_the_chords_of_the_moves() -> None:
    stroke = fitted(Stroke(ring(12.0, 4.0)), error_mm=ERROR_MM)
    assert 1e-3 < hausdorff_mm(stroke.points, line_of(stroke)) <= CHORD_MM + 2e-3


def test_moves_that_end_elsewhere_than_the_points_are_refused() -> None:
    with pytest.raises(ValueError, match="fit them again"):
        Stroke(np.array([[0.0, 0], [1, 1]]), moves=(Line((1.0, 2.0)),))
