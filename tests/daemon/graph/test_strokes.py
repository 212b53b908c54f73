"""Every edge is drawn once, in as few strokes as can be."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from daemon.graph.strokes import strokes
from daemon.shapes import Drawing, LineGraph
from tests.daemon.graph.drawn import graph_of, of_points

CROSSING = graph_of([(0, 5), (5, 5), (10, 5), (5, 0), (5, 10)], [(0, 1), (1, 2), (3, 1), (1, 4)])
POINTS = [(float(7 * i % 11), float(i * i % 13)) for i in range(9)]
PAIRS = st.sets(st.tuples(st.integers(0, 8), st.integers(0, 8)).filter(lambda pair: pair[0] < pair[1]), min_size=1)


def drawn(graph: LineGraph, **options: str) -> Drawing:
    return strokes(graph, width_px=20, height_px=20, **options)  # type: ignore[arg-type]


def segments(drawing: Drawing) -> list[tuple[tuple[float, float], ...]]:
    walks = of_points(drawing)
    return sorted(tuple(sorted(pair)) for walk in walks for pair in pairwise(walk))


def fewest(pairs: set[tuple[int, int]]) -> int:
    """Half the odd vertices of each connected part, one where it has none."""
    part = {vertex: vertex for pair in pairs for vertex in pair}
    for _ in part:
        for a, b in pairs:
            part[a] = part[b] = min(part[a], part[b])
    odd = dict.fromkeys(part.values(), 0)
    for vertex, name in part.items():
        odd[name] += sum(vertex in pair for pair in pairs) % 2
    return sum(max(1, count // 2) for count in odd.values())


@given(PAIRS)
def test_draws_every_edge_once_in_the_fewest_strokes(pairs: set[tuple[int, int]]) -> None:
    graph = graph_of(POINTS, sorted(pairs))
    drawing = drawn(graph)
    assert segments(drawing) == sorted(tuple(sorted((POINTS[a], POINTS[b]))) for a, b in pairs)
    assert len(drawing.strokes) == fewest(pairs)


@given(PAIRS)
def test_the_papers_way_draws_every_edge_once_too(pairs: set[tuple[int, int]]) -> None:
    drawing = drawn(graph_of(POINTS, sorted(pairs)), mode="paper")
    assert segments(drawing) == sorted(tuple(sorted((POINTS[a], POINTS[b]))) for a, b in pairs)


def test_a_crossing_is_two_straight_lines() -> None:
    assert of_points(drawn(CROSSING)) == [[(0, 5), (5, 5), (10, 5)], [(5, 0), (5, 5), (5, 10)]]


def test_the_papers_way_takes_the_first_edge_at_each_vertex() -> None:
    square = graph_of([(0, 0), (9, 0), (9, 9), (0, 9)], [(1, 2), (0, 1), (2, 3)])
    assert of_points(drawn(square, mode="paper")) == [[(0, 0), (9, 0), (9, 9), (0, 9)]]
    assert of_points(drawn(CROSSING, mode="paper")) == [[(0, 5), (5, 5), (10, 5)], [(5, 5), (5, 0)], [(5, 5), (5, 10)]]


def test_a_closed_shape_ends_where_it_began() -> None:
    (stroke,) = drawn(graph_of([(0, 0), (9, 0), (5, 9)], [(0, 1), (2, 1), (2, 0)])).strokes
    assert len(stroke.points) == 4
    assert np.array_equal(stroke.points[0], stroke.points[-1])


def test_two_loops_that_touch_are_one_stroke() -> None:
    bow = graph_of([(5, 5), (0, 0), (0, 10), (10, 0), (10, 10)], [(0, 1), (1, 2), (2, 0), (0, 3), (3, 4), (4, 0)])
    assert len(drawn(bow).strokes) == 1


@pytest.mark.parametrize("mode", ["fewest", "paper"])
def test_a_long_line_needs_no_recursion(mode: str) -> None:
    points = [(float(i), float(i % 2)) for i in range(5000)]
    graph = graph_of(points, [(i, i + 1) for i in range(4999)])
    assert of_points(drawn(graph, mode=mode)) == [points]


def test_two_vertices_on_one_place_are_drawn_through() -> None:
    folded = graph_of([(0, 0), (5, 5), (5, 5), (9, 0)], [(0, 1), (1, 2), (2, 3)])
    assert of_points(drawn(folded)) == [[(0, 0), (5, 5), (5, 5), (9, 0)]]


def test_the_page_is_carried_on() -> None:
    drawing = strokes(CROSSING, width_px=12, height_px=34, px_per_mm=5.0)
    assert (drawing.width_px, drawing.height_px, drawing.px_per_mm) == (12, 34, 5.0)
