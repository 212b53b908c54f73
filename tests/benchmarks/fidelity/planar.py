"""The true strokes as a planar graph, by snap rounding (Hobby 1999): fewest strokes, length of the union."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import cv2
import numpy as np

from daemon.shapes import Edge, LineGraph, Points
from training.render import crossings

GRID_PX = 0.5
_BEND_PX = 0.1
_SHARED_PX = 1.0
_CHUNK = 256

Node: TypeAlias = tuple[int, int]
_Pair: TypeAlias = tuple[Node, Node]


@dataclass(frozen=True, slots=True)
class Planar:
    """fewest_strokes: sum over the components of max(1, odd vertices / 2). union_px: length with repeats left out."""

    fewest_strokes: int
    union_px: float


def planar(strokes: Sequence[Points]) -> Planar:
    """Every end, bend and crossing is rounded to a grid of 0.5 px; a line bends to each such place that it passes.

    Points that lie within 0.1 px of the line without them are no bends: a smooth curve is not one bend after another.
    Lines that share no more than 1 px meet in one place there: rounding has drawn out their crossing.
    """
    passed = list(_passes(strokes))
    times = Counter(pair for pair, _ in passed if pair[0] != pair[1])
    union_px = sum(length / max(1, times[pair]) for pair, length in passed)
    return Planar(_fewest(*_lines([pair for pair, _ in passed])), float(union_px))


def graph(strokes: Sequence[Points]) -> LineGraph:
    """The same as a graph whose edges run from junction to junction or end; a dot is an edge of one point."""
    pairs, places = _lines([pair for pair, _ in _passes(strokes)])
    ways: dict[Node, list[Node]] = {}
    for p, q in pairs:
        ways.setdefault(p, []).append(q)
        ways.setdefault(q, []).append(p)
    walks = [[place] for place in places if place not in ways]
    junctions = {node for node, to in ways.items() if len(to) != 2}
    # Junctions and ends first; what is left then are closed curves without any.
    for start in sorted(ways, key=lambda node: node not in junctions):
        while ways[start]:
            walks.append(_walk(ways, start, junctions))
    number = {node: i for i, node in enumerate(dict.fromkeys(end for walk in walks for end in (walk[0], walk[-1])))}
    edges = tuple(Edge(number[w[0]], number[w[-1]], np.array(w, float) * GRID_PX, 1.0) for w in walks)
    return LineGraph(np.array(list(number), float).reshape(-1, 2) * GRID_PX, edges)


def _lines(passed: list[_Pair]) -> tuple[list[_Pair], list[Node]]:
    """Each bit of line once, and all places; the ends of a short bit that lines share are one place."""
    times = Counter(passed)
    root: dict[Node, Node] = {node: node for pair in times for node in pair}
    for (p, q), count in times.items():
        if count > 1 and math.dist(p, q) * GRID_PX <= _SHARED_PX:
            root[_root(root, p)] = _root(root, q)
    moved = [(_root(root, p), _root(root, q)) for p, q in times]
    return [pair for pair in moved if pair[0] != pair[1]], list(dict.fromkeys(p for p, _ in moved))


def _root(root: dict[Node, Node], node: Node) -> Node:
    while root[node] != node:
        root[node] = root[root[node]]
        node = root[node]
    return node


def _walk(ways: dict[Node, list[Node]], start: Node, junctions: set[Node]) -> list[Node]:
    """On from a node, up to the next that is a junction, an end or the start; the ways gone are taken out."""
    walk = [start]
    while True:
        here, then = walk[-1], ways[walk[-1]].pop()
        ways[then].remove(here)
        walk.append(then)
        if then in junctions or then == start:
            return walk


def _passes(strokes: Sequence[Points]) -> Iterator[tuple[_Pair, float]]:
    """Between which two places each bit of line runs, and how long the bit is in truth, in px."""
    strokes = [_bends(s) for s in strokes]
    lines = [s for s in strokes if len(s) > 1]
    met = crossings(lines) if lines else np.empty((0, 2))
    hot = np.unique(np.rint(np.concatenate([*strokes, met]) / GRID_PX), axis=0)
    for dot in (s for s in strokes if len(s) == 1):
        node = _node(np.rint(dot[0] / GRID_PX))
        yield (node, node), 0.0
    if not lines:
        return
    starts, ends = np.concatenate([s[:-1] for s in lines]), np.concatenate([s[1:] for s in lines])
    for first in range(0, len(starts), _CHUNK):
        yield from _along(starts[first : first + _CHUNK] / GRID_PX, ends[first : first + _CHUNK] / GRID_PX, hot)


def _bends(stroke: Points) -> Points:
    if len(stroke) == 1:
        return stroke
    kept = cv2.approxPolyDP(stroke.astype(np.float32)[:, None], _BEND_PX, False)[:, 0].astype(np.float64)
    # OpenCV leaves out the last point of a closed curve.
    return np.concatenate([kept, stroke[-1:]])


def _along(a: Points, b: Points, hot: Points) -> Iterator[tuple[_Pair, float]]:
    """The bits of some segments, all in grid units, cut at the hot places that they pass."""
    enter, leave = _clipped(a, b, hot)
    segment, place = np.nonzero(enter <= leave)
    run = (b - a)[segment]
    part = np.clip(((hot[place] - a[segment]) * run).sum(axis=1) / np.maximum((run**2).sum(axis=1), 1e-12), 0, 1)
    order = np.lexsort((part, segment))
    segment, place, part = segment[order], place[order], part[order]
    follow = np.nonzero(segment[1:] == segment[:-1])[0]
    lengths = np.hypot(*(b - a).T) * GRID_PX
    # The first and the last place may lie a little inside the segment: stretched, the bits add up to its length.
    whole = np.zeros(len(a))
    np.add.at(whole, segment[follow], np.diff(part)[follow])
    for i in follow.tolist():
        p, q = _node(hot[place[i]]), _node(hot[place[i + 1]])
        share = (part[i + 1] - part[i]) / whole[segment[i]] if whole[segment[i]] else 0.0
        yield (min(p, q), max(p, q)), float(lengths[segment[i]] * share)
    single = np.setdiff1d(segment, segment[follow])
    for s in single.tolist():
        node = _node(np.rint(a[s]))
        yield (node, node), float(lengths[s])


def _clipped(a: Points, b: Points, hot: Points) -> tuple[Points, Points]:
    """Where each segment enters and leaves each hot pixel, as shares of it (Liang and Barsky 1984); (S, H) each."""
    enter, leave = np.zeros((len(a), len(hot))), np.ones((len(a), len(hot)))
    for axis in (0, 1):
        start, run = a[:, axis, None], (b - a)[:, axis, None]
        low, high = hot[None, :, axis] - 0.5 - start, hot[None, :, axis] + 0.5 - start
        with np.errstate(divide="ignore", invalid="ignore"):
            t, u = low / run, high / run
        still = run == 0
        inside = (low <= 0) & (high >= 0)
        enter = np.maximum(enter, np.where(still, np.where(inside, 0.0, 2.0), np.minimum(t, u)))
        leave = np.minimum(leave, np.where(still, np.where(inside, 1.0, -2.0), np.maximum(t, u)))
    return enter, leave


def _node(place: Points) -> Node:
    return int(place[0]), int(place[1])


def _fewest(pairs: list[_Pair], places: list[Node]) -> int:
    root = {node: node for node in (*places, *(node for pair in pairs for node in pair))}
    for p, q in pairs:
        root[_root(root, p)] = _root(root, q)
    degree = Counter(node for pair in pairs for node in pair)
    odd = Counter(_root(root, node) for node, count in degree.items() if count % 2)
    return sum(max(1, odd[component] // 2) for component in {_root(root, node) for node in root})
