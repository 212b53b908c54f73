"""Random planar drawings come back with their ends, junctions, cycles and parts, and with all their ink."""

from __future__ import annotations

import numpy as np
from hypothesis import example, given, settings
from hypothesis import strategies as st

from daemon.graph.interpret import interpret
from daemon.shapes import LineGraph
from tests.daemon.graph.drawn import Lines, arrays, channels, degrees, distances, page, polylines, silent

SIDE = 4
PITCH_PX, FIRST_PX = 30.0, 22.0
SPOTS = [(column, row) for row in range(SIDE) for column in range(SIDE)]
PAIRS = [
    (column + SIDE * row, column + dx + SIDE * (row + dy))
    for column, row in SPOTS
    for dx, dy in ((1, 0), (0, 1), (1, 1))
    if column + dx < SIDE and row + dy < SIDE
]
"""A grid with one diagonal in each cell: no two of these edges cross."""
planar_graphs = st.sets(st.sampled_from(PAIRS), min_size=1, max_size=20)
wobbles = st.integers(0, 10_000)


def drawn_lines(pairs: set[tuple[int, int]], wobble: int) -> Lines:
    places = np.array(SPOTS, float) * PITCH_PX + FIRST_PX
    places += np.random.default_rng(wobble).uniform(-3.0, 3.0, places.shape)
    return [[tuple(places[a]), tuple(places[b])] for a, b in sorted(pairs)]


def topology(degree: list[int], edges: int, ends: list[tuple[int, int]]) -> tuple[list[int], int, int]:
    """Degrees other than two (a bend is a vertex or none), independent cycles, connected parts."""
    part = list(range(len(degree)))

    def root(vertex: int) -> int:
        while part[vertex] != vertex:
            vertex = part[vertex]
        return vertex

    for a, b in ends:
        part[root(a)] = root(b)
    used = [vertex for vertex, count in enumerate(degree) if count]
    parts = len({root(vertex) for vertex in used})
    return sorted(count for count in degree if count not in (0, 2)), edges - len(used) + parts, parts


def of_pairs(pairs: set[tuple[int, int]]) -> tuple[list[int], int, int]:
    degree = np.bincount(np.array(sorted(pairs)).ravel(), minlength=SIDE * SIDE).tolist()
    return topology(degree, len(pairs), sorted(pairs))


def of_graph(graph: LineGraph) -> tuple[list[int], int, int]:
    ends = [(edge.start, edge.end) for edge in graph.edges]
    degree = np.bincount(np.array(ends).ravel(), minlength=len(graph.vertices)).tolist()
    assert sorted(degree) == degrees(graph)
    return topology(degree, len(ends), ends)


@settings(max_examples=100, deadline=None, derandomize=True)
@given(planar_graphs, wobbles)
@example({(0, 4), (1, 5), (1, 6), (5, 10), (6, 11), (10, 11), (10, 15)}, 232).via("a ring of a few pixels in a knot")
@example({(1, 2), (1, 6), (3, 7), (5, 6), (8, 12), (10, 14)}, 264).via("a stub into a fork")
def test_a_planar_drawing_keeps_its_topology_and_its_ink(pairs: set[tuple[int, int]], wobble: int) -> None:
    lines = drawn_lines(pairs, wobble)
    drawn = page(lines, size=136, width_px=2)
    graph = interpret(drawn, channels(drawn, [end for line in lines for end in line]))
    assert of_graph(graph) == of_pairs(pairs)
    assert distances(arrays(lines), polylines(graph)).max() < 2.0
    assert distances(polylines(graph), arrays(lines)).max() < 2.0


@settings(max_examples=60, deadline=None, derandomize=True)
@given(planar_graphs, wobbles)
def test_a_silent_network_loses_no_cycle_and_tears_nothing_apart(pairs: set[tuple[int, int]], wobble: int) -> None:
    """A sharp tip that no corner marks may be cut short by two line widths, or become a fork of a few pixels."""
    lines = drawn_lines(pairs, wobble)
    drawn = page(lines, size=136, width_px=2)
    graph = interpret(drawn, silent(drawn))
    assert of_graph(graph)[1:] == of_pairs(pairs)[1:]
    assert distances(arrays(lines), polylines(graph)).max() < 5.0
    assert distances(polylines(graph), arrays(lines)).max() < 2.5
