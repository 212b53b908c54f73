"""Many lines that run into one point have melted around it into a knot of vertices: they are led into that point."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from daemon.graph.crossings import Entry, Fewer, Lines, entry, half_edges, led, lengths_px
from daemon.graph.skeleton import Indices
from daemon.graph.verdicts import Rule

_KNOT_WIDTHS = 3.0
"""Edges up to so many line widths long tie vertices into a knot."""
_LEAST_LINES = 7
_BESIDE_WIDTHS = 2.0
_OFF_PX = 1.2
_AGREEING = 0.8
"""Share of a knot's lines that must pass within 1.2 px of one point."""


def hubs(lines: Lines, *, width_px: float) -> Fewer | None:
    """The edges with each knot of three or more vertices drawn together where its lines meet; None without one."""
    short = (lengths_px(lines) <= _KNOT_WIDTHS * width_px) & (lines.ends[:, 0] != lines.ends[:, 1])
    knots = _knots(lines.ends[short], len(lines.vertices))
    halves = half_edges(lines.ends, len(lines.vertices)) if knots else []
    names = np.arange(len(lines.vertices))
    places: dict[int, NDArray[np.float64]] = {}
    entries: dict[int, Entry | None] = {}
    for knot in knots:
        outer = [half for vertex in knot for half in halves[vertex] if not short[half >> 1]]
        found = {half: entry(lines, half, width_px) for half in outer}
        place = _meeting([each for each in found.values() if each is not None])
        if place is not None and np.hypot(*(lines.vertices[knot] - place).T).min() <= _BESIDE_WIDTHS * width_px:
            places |= dict.fromkeys(knot, place)
            names[knot] = knot[0]
            entries |= found
    gone: dict[int, Rule] = {edge: "knot" for edge in np.flatnonzero(short).tolist() if lines.ends[edge, 0] in places}
    return led(lines, gone, names, places, entries, width_px=width_px) if places else None


def _knots(pairs: Indices, count: int) -> list[list[int]]:
    """Groups of three or more vertices that the pairs tie together."""
    group = np.arange(count)
    while True:
        lower = group.copy()
        np.minimum.at(lower, pairs[:, 0], group[pairs[:, 1]])
        np.minimum.at(lower, pairs[:, 1], lower[pairs[:, 0]])
        lower = lower[lower]
        if (lower == group).all():
            break
        group = lower
    sizes = np.bincount(group, minlength=count)
    return [np.flatnonzero(group == name).tolist() for name in np.flatnonzero(sizes >= 3)]


def _meeting(entries: list[Entry]) -> NDArray[np.float64] | None:
    """Where nearly all of the lines meet; those that miss it most are left out one after the other."""
    least = max(_LEAST_LINES, int(np.ceil(_AGREEING * len(entries))))
    while len(entries) >= least:
        normals = np.array([each.normal for each in entries])
        right = (normals * np.array([each.point for each in entries])).sum(axis=1)
        place = np.linalg.lstsq(normals, right, rcond=None)[0]
        missed_px = np.abs(normals @ place - right)
        if missed_px.max() <= _OFF_PX:
            return np.asarray(place)
        entries = [each for index, each in enumerate(entries) if index != int(missed_px.argmax())]
    return None
