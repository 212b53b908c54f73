"""Where no straight edge explains the ink, the edge follows the thinned ink from vertex to vertex."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.bands import bands
from daemon.graph.skeleton import Chain, Indices, Skeleton
from daemon.graph.verdicts import Rule
from daemon.shapes import Points

_COVERED_PX = 1.6
"""Centre-line pixels this near to a straight edge are drawn by it."""
_RUN_PX = 4
"""An uncovered stretch of a chain shorter than this is the rounding of a junction, not a line."""
_SHIFT = 4
_NEEDED_WIDTHS = 4.0


def unexplained(
    chains: list[Chain],
    skeleton: Skeleton,
    vertices: Points,
    straight: Indices,
    shape: tuple[int, int],
    *,
    width_px: float,
) -> tuple[list[Chain], list[Rule]]:
    """The chains that no straight edge draws, and for each chain the rule that decided.

    straight: (E, 2) pairs of vertices. A chain of which straight edges cover all but a few pixels is left out (rule
    *covered*), and so is a chain that touches itself at its vertex within the ink's own width (*loop*). Chains without
    pixels, between vertices that touch, are kept when they are needed to connect the two (*short*).
    """
    near = _near(straight, vertices, shape)
    drawn = {(min(pair), max(pair)) for pair in straight.tolist()}
    rules: dict[int, Rule] = {id(c): _first_rule(c, skeleton, vertices, near, width_px) for c in chains}
    lines = [chain for chain in chains if rules[id(chain)] == "traced"]
    kept = _once(lines, longest_px=2 * width_px)
    rules |= dict.fromkeys(_missing(lines, kept), "twice")
    joined = [*drawn, *((chain.start, chain.end) for chain in kept)]
    touching = [chain for chain in chains if not chain.path and (chain.start, chain.end) not in drawn]
    kept += _short(touching, vertices, joined)
    kept += _needed(chains, kept, len(vertices), drawn, longest_px=_NEEDED_WIDTHS * width_px)
    followed = _without_stubs(kept, chains, drawn, longest_px=width_px)
    rules |= dict.fromkeys(_missing(kept, followed), "stub")
    rules |= dict.fromkeys(map(id, followed), "traced")
    return followed, [rules[id(chain)] for chain in chains]


def _missing(chains: list[Chain], others: list[Chain]) -> set[int]:
    """The ids of the chains that are not among the others."""
    return {id(chain) for chain in chains} - {id(chain) for chain in others}


def _first_rule(chain: Chain, skeleton: Skeleton, vertices: Points, near: NDArray[np.bool_], width_px: float) -> Rule:
    """What a chain is by itself, before it is seen beside the others."""
    if not chain.path:
        return "short"
    if not _is_bare(chain, skeleton, vertices, near):
        return "covered"
    away = np.hypot(*(skeleton.pixels[chain.path] - vertices[chain.start]).T).max()
    return "traced" if chain.start != chain.end or away > max(4.0, 2 * width_px) else "loop"


def _is_bare(chain: Chain, skeleton: Skeleton, vertices: Points, near: NDArray[np.bool_]) -> bool:
    """Whether straight edges leave out more of a chain than the rounding of a junction."""
    x, y = skeleton.pixels[chain.path].T
    bare = ~near[y, x]
    if _longest_run(bare) >= min(_RUN_PX, len(chain.path)):
        return True
    # The pixels that its vertices own are ink of this chain, too.
    before, after = (_bare(chain, skeleton, vertices, near, end) for end in (0, -1))
    return _longest_run(np.concatenate([before, bare, after[::-1]])) >= _RUN_PX


def _once(chains: list[Chain], *, longest_px: float) -> list[Chain]:
    """Of short chains between the same two vertices one: there is no ring in so little ink."""
    kept, joined = [], set()
    for chain in chains:
        pair = (min(chain.start, chain.end), max(chain.start, chain.end))
        if len(chain.path) > longest_px or pair not in joined:
            kept.append(chain)
        if len(chain.path) <= longest_px:
            joined.add(pair)
    return kept


def _bare(chain: Chain, skeleton: Skeleton, vertices: Points, near: NDArray[np.bool_], end: int) -> NDArray[np.bool_]:
    """Whether straight edges leave out the points, one px apart, from the vertex at one end to the chain's pixels."""
    vertex, pixel = vertices[(chain.start, chain.end)[end]], skeleton.pixels[chain.path[end]]
    count = int(np.hypot(*(pixel - vertex)))
    x, y = np.rint(np.linspace(vertex, pixel, count, endpoint=False)).astype(np.intp).T
    return np.asarray(~near[y.clip(0, near.shape[0] - 1), x.clip(0, near.shape[1] - 1)])


def _short(touching: list[Chain], vertices: Points, joined: list[tuple[int, int]]) -> list[Chain]:
    """The shortest of the touching pairs that connect what is not connected near by: no triangle within one blob."""
    near = [(a, b) for a, b in joined if np.hypot(*(vertices[b] - vertices[a])) <= 6.0]
    root, join = _groups(len(vertices), near)
    kept = []
    for chain in sorted(touching, key=lambda c: float(np.hypot(*(vertices[c.end] - vertices[c.start])))):
        if root(chain.start) != root(chain.end):
            join(chain.start, chain.end)
            kept.append(chain)
    return kept


def _needed(
    chains: list[Chain], kept: list[Chain], count: int, drawn: set[tuple[int, int]], *, longest_px: float
) -> list[Chain]:
    """Short chains under the ink of other edges without which what is joined on the page would fall apart."""
    used = [*drawn, *((chain.start, chain.end) for chain in kept)]
    root, join = _groups(count, used)
    found = []
    for chain in sorted(chains, key=lambda c: len(c.path)):
        if len(chain.path) <= longest_px and root(chain.start) != root(chain.end):
            join(chain.start, chain.end)
            found.append(chain)
    found += _loose(chains, kept + found, drawn, longest_px=longest_px / 2)
    return _without_dead_ends(found, {vertex for pair in used for vertex in pair})


def _without_stubs(
    kept: list[Chain], chains: list[Chain], drawn: set[tuple[int, int]], *, longest_px: float
) -> list[Chain]:
    """Without the shortest chains into a fork of the ink whose other branches straight edges draw already."""
    degrees = Counter(vertex for pair in drawn for vertex in pair)
    degrees.update(vertex for chain in kept for vertex in (chain.start, chain.end))
    forks = Counter(vertex for chain in chains for vertex in (chain.start, chain.end))
    return [
        chain
        for chain in kept
        if len(chain.path) > longest_px or not any(degrees[v] == 1 and forks[v] > 2 for v in (chain.start, chain.end))
    ]


def _loose(chains: list[Chain], kept: list[Chain], drawn: set[tuple[int, int]], *, longest_px: float) -> list[Chain]:
    """The shortest chain on from each vertex in which only one edge ends although the ink goes on."""
    pairs = [*drawn, *((chain.start, chain.end) for chain in kept)]
    degrees = Counter(vertex for pair in pairs for vertex in pair)
    joined = {(min(pair), max(pair)) for pair in pairs}
    found = []
    for chain in sorted(chains, key=lambda c: len(c.path)):
        ends = (min(chain.start, chain.end), max(chain.start, chain.end))
        if len(chain.path) > longest_px or chain.start == chain.end or ends in joined:
            continue
        if 1 in (degrees[chain.start], degrees[chain.end]) and min(degrees[v] for v in ends) > 0:
            found.append(chain)
            joined.add(ends)
            degrees.update(ends)
    return found


def _without_dead_ends(chains: list[Chain], used: set[int]) -> list[Chain]:
    """The chains without those that lead only to a vertex in which nothing else ends."""
    while True:
        ends = Counter(vertex for chain in chains for vertex in (chain.start, chain.end))
        lively = [c for c in chains if all(vertex in used or ends[vertex] > 1 for vertex in (c.start, c.end))]
        if len(lively) == len(chains):
            return chains
        chains = lively


def _groups(count: int, pairs: Iterable[tuple[int, int]]) -> tuple[Callable[[int], int], Callable[[int, int], None]]:
    """Vertices in groups (union-find): what names the group of a vertex, and what joins the groups of two."""
    group = list(range(count))

    def root(vertex: int) -> int:
        while group[vertex] != vertex:
            group[vertex] = group[group[vertex]]
            vertex = group[vertex]
        return vertex

    def join(one: int, other: int) -> None:
        group[root(one)] = root(other)

    for pair in pairs:
        join(*pair)
    return root, join


def _near(edges: Indices, vertices: Points, shape: tuple[int, int]) -> NDArray[np.bool_]:
    """Which pixels straight edges draw."""
    near = np.ones(shape, np.uint8)
    segments = np.rint(vertices[edges] * (1 << _SHIFT)).astype(np.int32)
    cv2.polylines(near, list(segments), False, 0, 1, cv2.LINE_8, _SHIFT)
    blank = near.copy()
    for band in bands(shape[0], halo_px=2 * _COVERED_PX):
        away = cv2.distanceTransform(blank[band.seen], cv2.DIST_L2, cv2.DIST_MASK_5)
        near[band.own] = away[band.own_of_seen] <= _COVERED_PX
    return near.view(np.bool_)


def _longest_run(flags: NDArray[np.bool_]) -> int:
    """Length of the longest stretch of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(np.int8), [0]])))
    return int((edges[1::2] - edges[::2]).max(initial=0))
