"""The graph falls into strokes: every edge drawn once, with as few pen lifts as can be."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import Literal

import numpy as np

from daemon.shapes import Drawing, Edge, LineGraph, Points, Stroke

_TANGENT_PX = 5.0


def strokes(
    graph: LineGraph,
    *,
    width_px: int,
    height_px: int,
    px_per_mm: float | None = None,
    mode: Literal["fewest", "paper"] = "fewest",
) -> Drawing:
    """The strokes that draw every edge of a graph exactly once, in the graph's own px.

    `fewest`: in each connected part half as many strokes as it has vertices of odd degree, one when it has none
    (Euler 1736), going straight on at crossings where that costs no lift; closed strokes end on the point where they
    began. `paper`: Strokes_Gen and Get_Sequence of Raghav et al. (2020, Sec. 3.4), without recursion. An edge of one
    point is a stroke of one point. width_px, height_px: of the page.
    """
    dots = [Stroke(edge.polyline) for edge in graph.edges if len(edge.polyline) == 1]
    lines = LineGraph(graph.vertices, tuple(edge for edge in graph.edges if len(edge.polyline) > 1))
    walks = _strokes_gen(lines) if mode == "paper" else _trails(lines)
    drawn = [Stroke(_joined(lines.edges, walk)) for walk in walks]
    return Drawing(tuple(drawn + dots), width_px, height_px, px_per_mm)


def _joined(edges: tuple[Edge, ...], walk: list[int]) -> Points:
    """The polyline of a walk. walk: half-edges, 2 i for edge i from its start, 2 i + 1 from its end."""
    pieces = [edges[half >> 1].polyline[:: -1 if half & 1 else 1] for half in walk]
    return np.concatenate([pieces[0], *(piece[1:] for piece in pieces[1:])])


def _strokes_gen(graph: LineGraph) -> list[list[int]]:
    """Strokes_Gen: from the first vertex that has an edge left, again and again, as far as Get_Sequence goes."""
    adjacency = _half_edges(graph)
    for halves in adjacency:
        halves.reverse()
    popped = [False] * len(graph.edges)
    walks: list[list[int]] = []
    for start in range(len(adjacency)):
        while walk := _get_sequence(graph, adjacency, popped, start):
            walks.append(walk)
    return walks


def _get_sequence(graph: LineGraph, adjacency: list[list[int]], popped: list[bool], vertex: int) -> list[int]:
    """Get_Sequence: the first edge left at each vertex, popped as it is traversed, until a vertex has none."""
    walk: list[int] = []
    while True:
        while adjacency[vertex] and popped[adjacency[vertex][-1] >> 1]:
            adjacency[vertex].pop()
        if not adjacency[vertex]:
            return walk
        half = adjacency[vertex].pop()
        popped[half >> 1] = True
        walk.append(half)
        vertex = _far_vertex(graph, half)


@dataclass(slots=True, eq=False)
class _Pairing:
    """Which half-edge goes on in which (-1: the trail ends), and the trail of each edge (union-find)."""

    mates: list[int]
    parents: list[int]
    closed: list[bool]

    def trail(self, half: int) -> int:
        edge = half >> 1
        while self.parents[edge] != edge:
            self.parents[edge] = self.parents[self.parents[edge]]
            edge = self.parents[edge]
        return edge

    def join(self, a: int, b: int) -> None:
        """Let the trail go on from half-edge a in half-edge b."""
        self.mates[a], self.mates[b] = b, a
        one, other = self.trail(a), self.trail(b)
        if one == other:
            self.closed[one] = True
        else:
            self.parents[one] = other


def _trails(graph: LineGraph) -> list[list[int]]:
    """Trails that go straight on at each vertex, then closed ones spliced into the others that pass there."""
    count = len(graph.edges)
    pairing = _Pairing([-1] * (2 * count), list(range(count)), [False] * count)
    directions = _directions(graph)
    adjacency = _half_edges(graph)
    for halves in adjacency:
        _go_straight(halves, directions, pairing)
    for halves in adjacency:
        _splice(halves, directions, pairing)
    return _walks(graph, pairing)


def _go_straight(halves: list[int], directions: Points, pairing: _Pairing) -> None:
    """Pair the half-edges of a vertex, the straightest pair first; one is left over when their number is odd."""
    turns = sorted((_turn(a, b, directions), a, b) for a, b in combinations(halves, 2))
    for _, a, b in turns:
        if pairing.mates[a] < 0 and pairing.mates[b] < 0:
            pairing.join(a, b)


def _splice(halves: list[int], directions: Points, pairing: _Pairing) -> None:
    """Join each closed trail through this vertex with another trail through it, at the least turn."""
    while True:
        options = [
            (_turn(a, b, directions), a, b)
            for a in halves
            for b in halves
            if pairing.trail(a) != pairing.trail(b) and pairing.closed[pairing.trail(a)]
        ]
        if not options:
            return
        _, a, b = min(options)
        _merge(a, b, pairing)


def _merge(a: int, b: int, pairing: _Pairing) -> None:
    """Open the closed trail at half-edge a and let it go on in b; what followed b now follows a's former mate."""
    after_a, after_b = pairing.mates[a], pairing.mates[b]
    still_closed = pairing.closed[pairing.trail(b)]
    pairing.join(a, b)
    pairing.mates[after_a] = after_b
    if after_b >= 0:
        pairing.mates[after_b] = after_a
    pairing.closed[pairing.trail(a)] = still_closed


def _walks(graph: LineGraph, pairing: _Pairing) -> list[list[int]]:
    """Follow the mates: open trails from their ends, then closed ones from any edge."""
    seen = [False] * len(graph.edges)
    open_ends = [half for half, mate in enumerate(pairing.mates) if mate < 0]
    walks = []
    for half in [*open_ends, *range(0, 2 * len(graph.edges), 2)]:
        walk: list[int] = []
        onward = half
        while onward >= 0 and not seen[onward >> 1]:
            seen[onward >> 1] = True
            walk.append(onward)
            onward = pairing.mates[onward ^ 1]
        if walk:
            walks.append(walk)
    return walks


def _half_edges(graph: LineGraph) -> list[list[int]]:
    """For each vertex the half-edges that leave it."""
    adjacency: list[list[int]] = [[] for _ in graph.vertices]
    for index, edge in enumerate(graph.edges):
        adjacency[edge.start].append(2 * index)
        adjacency[edge.end].append(2 * index + 1)
    return adjacency


def _far_vertex(graph: LineGraph, half: int) -> int:
    edge = graph.edges[half >> 1]
    return edge.start if half & 1 else edge.end


def _directions(graph: LineGraph) -> Points:
    """The unit direction in which each half-edge leaves its vertex, over its first 5 px."""
    directions = np.zeros((2 * len(graph.edges), 2))
    for index, edge in enumerate(graph.edges):
        for side, points in enumerate((edge.polyline, edge.polyline[::-1])):
            away = np.hypot(*(points - points[0]).T)
            far = int(np.argmax(away >= _TANGENT_PX)) or len(points) // 2 or -1
            along = points[far] - points[0]
            directions[2 * index + side] = along / max(float(np.hypot(*along)), 1e-9)
    return directions


def _turn(a: int, b: int, directions: Points) -> float:
    """0 for straight on, 2 for turning back."""
    return float(1.0 + directions[a] @ directions[b])
