"""Lines whose ink has melted are led to where they meet."""

from __future__ import annotations

import numpy as np
import pytest

from daemon.graph.crossings import Lines, unmelted
from daemon.graph.interpret import interpret
from daemon.graph.strokes import strokes
from daemon.shapes import LineGraph
from tests.daemon.graph.drawn import arrays, degrees, distances, page, polylines, silent


def understood(*lines: list[tuple[float, float]], width_px: int = 3) -> LineGraph:
    drawn = page(list(lines), width_px=width_px)
    return interpret(drawn, silent(drawn))


def lines_of(vertices: list[tuple[float, float]], pairs: list[tuple[int, int]], *, unsound_px: float = 5.0) -> Lines:
    """Straight edges, their points a px apart, unsound near both ends."""
    places, drawn, sound = np.array(vertices, float), [], []
    for a, b in pairs:
        along = np.linspace(places[a], places[b], max(2, round(float(np.hypot(*(places[b] - places[a]))))) + 1)
        away = np.minimum(np.hypot(*(along - along[0]).T), np.hypot(*(along - along[-1]).T))
        drawn.append(along)
        sound.append(away > unsound_px)
    return Lines(drawn, sound, np.array(pairs, np.intp), places)


@pytest.mark.parametrize("degrees_apart", [15, 25, 40])
def test_an_acute_crossing_is_one_vertex_and_two_strokes(degrees_apart: float) -> None:
    slope = np.tan(np.radians(degrees_apart / 2))
    lines = [[(14.0, 64 - 50 * slope), (114.0, 64 + 50 * slope)], [(14.0, 64 + 50 * slope), (114.0, 64 - 50 * slope)]]
    graph = understood(*lines)
    assert degrees(graph) == [1, 1, 1, 1, 4]
    assert len(strokes(graph, width_px=128, height_px=128).strokes) == 2
    assert distances(arrays(lines), polylines(graph)).max() < 0.8


def test_a_sharp_tip_is_one_stroke_up_to_its_point() -> None:
    tip: list[tuple[float, float]] = [(20, 54), (110, 64), (20, 74)]
    graph = understood(tip)
    assert len(strokes(graph, width_px=128, height_px=128).strokes) == 1
    assert distances(arrays([tip]), polylines(graph)).max() < 1.6


def test_a_fork_with_a_stem_keeps_its_stem() -> None:
    graph = understood([(20, 40), (60, 64), (100, 64)], [(20, 88), (60, 64)])
    assert degrees(graph) == [1, 1, 1, 3]


def test_two_branches_on_either_side_of_a_line_stay_apart() -> None:
    graph = understood([(20, 64), (108, 64)], [(55, 64), (55, 20)], [(67, 64), (67, 108)])
    assert degrees(graph) == [1, 1, 1, 1, 3, 3]


def test_a_rung_inside_the_ink_of_two_lines_is_no_line() -> None:
    beside = [(0.0, 0.0), (40.0, 10.0), (80.0, 0.0), (0.0, 23.0), (40.0, 13.0), (80.0, 23.0)]
    pairs = [(0, 1), (1, 2), (3, 4), (4, 5), (1, 4)]
    better = unmelted(lines_of(beside, pairs), width_px=3.0)
    assert better is not None
    assert better.ends.tolist() == [[0, 1], [1, 2], [3, 4], [4, 5]]
    assert (better.kept, better.gone) == ([0, 1, 2, 3], {4: "rung"})
    assert unmelted(lines_of(beside, pairs), width_px=2.0) is None
