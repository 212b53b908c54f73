"""A crooked machine that is told the corrected toolpath draws the lines that were meant."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from daemon.shapes import Arc, Points, Stroke, Toolpath
from daemon.toolpath.correct import Correction, corrected
from daemon.toolpath.curves import fitted, points_of
from firmware_protocol.crooked import Crooked, CrookedInk
from firmware_protocol.ink import PenRule

BACKLASH = (0.3, 0.2)


def toolpath(*strokes: list[tuple[float, float]]) -> Toolpath:
    return Toolpath(tuple(Stroke(np.array(points, float)) for points in strokes), np.eye(2, 3))


def drawn(path: Toolpath, crooked: Crooked) -> list[Points]:
    """By the simulated machine, which starts at the sheet's corner, from one way or the other."""
    ink = CrookedInk(PenRule(), crooked)
    at = (*path.start_mm, 5.0)
    for stroke in path.strokes:
        (x_mm, y_mm), *others = stroke.points.tolist()
        stops = [(x_mm, y_mm, 5.0), (x_mm, y_mm, 0.0), *((x, y, 0.0) for x, y in others)]
        for stop in [*stops, (*stops[-1][:2], 5.0)]:
            ink.travel(at, stop)
            at = stop
    return [np.array(line) for line in ink.polylines]


def farthest_mm(lines: list[Points], meant: list[Points]) -> float:
    """The largest distance of a point of a line from the polyline that was meant, and of its ends from its ends."""
    return max(max(_from(line, other), _from(other, line)) for line, other in zip(lines, meant, strict=True))


def _from(points: Points, line: Points) -> float:
    if len(line) == 1:
        return float(np.hypot(*(points - line[0]).T).max())
    starts, ways = line[:-1], np.diff(line, axis=0)
    lengths = np.maximum((ways**2).sum(axis=1), 1e-18)
    parts = np.clip(((points[:, None] - starts) * ways).sum(axis=2) / lengths, 0, 1)
    return float(np.hypot(*np.moveaxis(points[:, None] - starts - parts[..., None] * ways, 2, 0)).min(axis=1).max())


def test_nothing_is_changed_where_nothing_is_wrong() -> None:
    path = toolpath([(1, 1), (2, 2)])
    assert corrected(path, Correction(corner_mm=(3.0, 4.0))) is path


def test_scale_and_skew_are_undone_about_the_sheets_corner() -> None:
    errors = Correction(1.02, 0.99, skew_deg=0.5, corner_mm=(-50.0, 10.0))
    path = corrected(toolpath([(-50, 10), (50, 10), (50, 110)]), errors)
    crooked = Crooked(1.02, 0.99, skew_deg=0.5)
    came = [np.add(crooked.place(*(point - (-50, 10))), (-50, 10)) for point in path.strokes[0].points]
    assert np.allclose(came, [(-50, 10), (50, 10), (50, 110)])


@settings(max_examples=60, deadline=None)
@given(
    st.lists(
        st.lists(st.tuples(st.integers(5, 90), st.integers(5, 90)), min_size=1, max_size=8, unique=True),
        min_size=1,
        max_size=5,
    ),
    st.floats(0.97, 1.03),
    st.floats(0.97, 1.03),
    st.floats(-1, 1),
)
def test_what_comes_out_is_what_was_meant(
    strokes: list[list[tuple[int, int]]], scale_x: float, scale_y: float, skew_deg: float
) -> None:
    meant = toolpath(*[[(float(x), float(y)) for x, y in stroke] for stroke in strokes])
    path = corrected(meant, Correction(scale_x, scale_y, skew_deg, BACKLASH))
    lines = drawn(path, Crooked(scale_x, scale_y, skew_deg, BACKLASH))
    assert farthest_mm(lines, [stroke.points for stroke in meant.strokes]) < 0.05


def test_a_circle_is_closed_and_round_again() -> None:
    turn = np.linspace(0, 2 * math.pi, 73)
    meant = toolpath([(50 + 20 * math.cos(at), 50 + 20 * math.sin(at)) for at in turn.tolist()])
    crooked = Crooked(backlash_mm=BACKLASH)
    assert farthest_mm(drawn(meant, crooked), [meant.strokes[0].points]) > 0.1
    path = corrected(meant, Correction(backlash_mm=BACKLASH))
    assert farthest_mm(drawn(path, crooked), [meant.strokes[0].points]) < 0.05


def test_a_line_that_trembles_does_not_make_an_axis_turn_round() -> None:
    points = [(float(10 + at), 20 + 0.01 * (at % 2)) for at in range(20)]
    (stroke,) = corrected(toolpath(points), Correction(backlash_mm=BACKLASH)).strokes
    assert len(stroke.points) == len(points)


def test_a_dot_stays_a_dot() -> None:
    path = corrected(toolpath([(10, 10)], [(5, 12)]), Correction(backlash_mm=BACKLASH))
    assert [stroke.points.tolist() for stroke in path.strokes] == [
        [pytest.approx([10.15, 10.1])],
        [pytest.approx([4.85, 12.1])],
    ]


@pytest.mark.parametrize("backlash_mm", [(0.0, 0.0), BACKLASH])
def test_curves_stay_curves(backlash_mm: tuple[float, float]) -> None:
    turn = np.linspace(0, 2 * math.pi, 181)
    circle = np.column_stack([50 + 20 * np.cos(turn), 50 + 20 * np.sin(turn)])
    round_one = fitted(Stroke(circle), error_mm=0.05)
    meant = Toolpath((round_one,), np.eye(2, 3))
    path = corrected(meant, Correction(1.03, 0.98, 0.5, backlash_mm))
    (stroke,) = path.strokes
    assert stroke.moves is not None
    assert any(isinstance(move, Arc) for move in stroke.moves)
    assert len(stroke.moves) < len(stroke.points)
    # What is sent are the moves, so their own points are drawn.
    sent = replace(path, strokes=(Stroke(points_of(stroke.points[0], stroke.moves)),))
    lines = drawn(sent, Crooked(1.03, 0.98, 0.5, backlash_mm))
    assert farthest_mm(lines, [circle]) < 0.05 + 0.02 + 0.02


def test_a_corner_between_curves_stays_one() -> None:
    square = fitted(Stroke(np.array([[10, 10], [40, 10], [40, 40], [10, 40], [10, 10]], float)), error_mm=0.05)
    (stroke,) = corrected(Toolpath((square,), np.eye(2, 3)), Correction(1.01)).strokes
    assert stroke.moves is not None
    assert [move.end for move in stroke.moves] == [
        pytest.approx(end) for end in [(40 / 1.01, 10), (40 / 1.01, 40), (10 / 1.01, 40), (10 / 1.01, 10)]
    ]
