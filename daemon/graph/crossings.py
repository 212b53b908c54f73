"""Two junctions, or a junction and an end, whose lines all meet in one point between them are one vertex."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from daemon.graph.plausibility import Floats
from daemon.graph.skeleton import Indices
from daemon.graph.verdicts import Rule
from daemon.shapes import Points

_FIT_PX = 10
_LEAST_PX = 4
"""Points, about a px apart, that say where a line runs, and the fewest that say anything."""
_LONGEST_WIDTHS, _LEAST_LONGEST_PX = 8.0, 6.0
"""Lines that cross at 15 degrees share their ink for about so many line widths."""
_OFF_PX, _OFF_SHARE = 0.6, 0.06
"""By how much a line may miss the point, and by how much more a px of the bridge: lines bend."""
_BESIDE_PX = 1.5
_SHORT_WIDTHS, _RUNG_WIDTHS = 1.5, 1.15
_HOLD = 0.02


@dataclass(frozen=True, slots=True, eq=False)
class Lines:
    """Edges on the ridge of the ink: polylines of points about a px apart, which of them lie in sound ink, and ends.

    ends: (E, 2) indices of vertices (V, 2). sound: for each polyline (N,) False where other lines run into the profile.
    """

    polylines: list[Points]
    sound: list[NDArray[np.bool_]]
    ends: Indices
    vertices: Points


@dataclass(frozen=True, slots=True, eq=False)
class Entry:
    """How an edge comes to a vertex: a point on its line, the line's normal, and its first row that is in sound ink."""

    point: NDArray[np.float64]
    normal: NDArray[np.float64]
    row: int


@dataclass(frozen=True, slots=True, eq=False)
class Fewer:
    """Some edges of others: polylines, ends (E, 2), and vertices (V, 2), in some of which no edge ends any more.

    kept: for each edge which of the others it was. gone: those that are left out and the rule that decided.
    """

    polylines: list[Points]
    ends: Indices
    vertices: Points
    kept: Sequence[int]
    gone: Mapping[int, Rule]


def unmelted(lines: Lines, *, width_px: float) -> Fewer | None:
    """The edges without the bridges that melted ink has put between lines; None where there is none.

    A bridge is an edge from a junction to another vertex, at most eight line widths long. It is taken out where the
    other edges of both, seen from where they lie in ink of their own, meet in one point of it, two lines that cross at
    an acute angle, or where those of a fork meet in its other end, two lines that run into one tip: they are led
    there. An edge of hardly a line's width between two lines that go on on both sides is taken out, too.
    """
    halves = half_edges(lines.ends, len(lines.vertices))
    entries: dict[int, Entry | None] = {}
    places: dict[int, NDArray[np.float64]] = {}
    gone: dict[int, Rule] = {}
    touched: set[int] = set()
    longest_px = max(_LEAST_LONGEST_PX, _LONGEST_WIDTHS * width_px)
    for bridge in _bridges(lines, halves, longest_px, _SHORT_WIDTHS * width_px):
        a, b = lines.ends[bridge].tolist()
        outer = [half for half in (*halves[a], *halves[b]) if half >> 1 != bridge]
        if a in touched or b in touched:
            continue
        entries |= {half: entry(lines, half, width_px) for half in outer if half not in entries}
        place = _place(lines, bridge, halves, entries, width_px)
        if place is not None:
            places[a], places[b] = place, place
        elif not _is_rung(lines, bridge, halves, width_px):
            continue
        gone[bridge] = "bridge" if place is not None else "rung"
        touched |= {a, b}
    names = np.arange(len(lines.vertices))
    for a, b in (lines.ends[bridge].tolist() for bridge in gone):
        names[b] = a if a in places else b
    return led(lines, gone, names, places, entries, width_px=width_px) if gone else None


def _bridges(lines: Lines, halves: list[list[int]], longest_px: float, short_px: float) -> list[int]:
    """Edges that may be bridges, shortest first."""
    lengths = lengths_px(lines)
    degrees = np.array([len(some) for some in halves])[lines.ends]
    forks = (degrees == 3).any(axis=1) | (lengths <= short_px)
    may = forks & (degrees.max(axis=1) >= 3) & (lines.ends[:, 0] != lines.ends[:, 1])
    found = np.flatnonzero(may & (lengths <= longest_px))
    return list(found[np.argsort(lengths[found], kind="stable")].tolist())


def lengths_px(lines: Lines) -> Floats:
    """Of each edge."""
    return np.array([np.hypot(*np.diff(polyline, axis=0).T).sum() for polyline in lines.polylines])


def half_edges(ends: Indices, count: int) -> list[list[int]]:
    """For each vertex the half-edges that leave it: 2 i from the start of edge i, 2 i + 1 from its end."""
    halves: list[list[int]] = [[] for _ in range(count)]
    for index, (start, end) in enumerate(ends.tolist()):
        halves[start].append(2 * index)
        halves[end].append(2 * index + 1)
    return halves


def entry(lines: Lines, half: int, width_px: float) -> Entry | None:
    """How a half-edge (2 i from the start of edge i, 2 i + 1 from its end) leaves its vertex; None for a short one."""
    points, sound = (some[half >> 1][:: -1 if half & 1 else 1] for some in (lines.polylines, lines.sound))
    lead = round(width_px / 2 + 1.5)
    rows = lead + np.flatnonzero(sound[lead:])[:1]
    if not rows.size:
        return None
    stretch = points[rows[0] : rows[0] + _FIT_PX][sound[rows[0] : rows[0] + _FIT_PX]]
    if len(stretch) < _LEAST_PX:
        return None
    middle = stretch.mean(axis=0)
    return Entry(middle, np.linalg.svd(stretch - middle)[2][1], int(rows[0]))


def _place(
    lines: Lines, bridge: int, halves: list[list[int]], entries: dict[int, Entry | None], width_px: float
) -> NDArray[np.float64] | None:
    """Where the lines at both ends of a bridge meet, None where they do not: on the bridge, or at one of its ends."""
    points, (a, b) = lines.polylines[bridge], lines.ends[bridge].tolist()
    length_px = float(np.hypot(*np.diff(points, axis=0).T).sum())
    off_px = _OFF_PX + _OFF_SHARE * length_px
    at_a, at_b = ([entries[half] for half in halves[v] if half >> 1 != bridge] for v in (a, b))
    if min(len(at_a), len(at_b)) > 0 and (len(at_a) % 2 == len(at_b) % 2 or length_px <= _SHORT_WIDTHS * width_px):
        place = _meeting(at_a + at_b, points, off_px)
        if place is not None and np.hypot(*(points - place).T).min() <= _BESIDE_PX:
            return place
    for fork, tip, at_tip in ((at_a, points[-1], at_b), (at_b, points[0], at_a)):
        if len(fork) == 2 and _pass(fork, tip, off_px if at_tip else max(off_px, width_px / 2)):
            return np.asarray(tip)
    return None


def _is_rung(lines: Lines, bridge: int, halves: list[list[int]], width_px: float) -> bool:
    """Whether an edge joins two lines whose inks touch beside each other: its own ink is theirs."""
    points, ends = lines.polylines[bridge], lines.ends[bridge].tolist()
    odd = all(len(halves[vertex]) % 2 and len(halves[vertex]) >= 3 for vertex in ends)
    return odd and float(np.hypot(*np.diff(points, axis=0).T).sum()) <= _RUNG_WIDTHS * width_px


def _pass(fork: list[Entry | None], tip: NDArray[np.float64], off_px: float) -> bool:
    """Whether both lines of a fork pass a point."""
    return all(entry is not None and abs(entry.normal @ (tip - entry.point)) <= off_px for entry in fork)


def _meeting(entries: list[Entry | None], bridge: Points, off_px: float) -> NDArray[np.float64] | None:
    """Where all lines meet (least squares), None where one of them misses that point or too few are known."""
    known = [entry for entry in entries if entry is not None]
    if len(known) < max(2, len(entries) - 1):
        return None
    normals = np.array([entry.normal for entry in known])
    right = (normals * np.array([entry.point for entry in known])).sum(axis=1)
    # The bridge holds the point a little: lines that are nearly parallel meet anywhere along them.
    middle = bridge[len(bridge) // 2]
    place = np.linalg.solve(normals.T @ normals + _HOLD * np.eye(2), normals.T @ right + _HOLD * middle)
    return place if np.abs(normals @ place - right).max() <= off_px else None


def led(
    lines: Lines,
    gone: Mapping[int, Rule],
    names: Indices,
    places: dict[int, NDArray[np.float64]],
    entries: dict[int, Entry | None],
    *,
    width_px: float,
) -> Fewer:
    """The edges without those gone, led from their sound ink straight to the new places of their vertices.

    names: (V,) the vertex that each is one with. entries: of half-edges that end in a new place.
    """
    vertices = np.array([places.get(vertex, place) for vertex, place in enumerate(lines.vertices)])
    new = names[lines.ends]
    loops = (new[:, 0] == new[:, 1]) & (lines.ends[:, 0] != lines.ends[:, 1])
    tiny: dict[int, Rule] = {i: "loop" for i in np.flatnonzero(loops).tolist() if _is_tiny(lines, i, width_px)}
    kept = [index for index in range(len(lines.polylines)) if index not in gone and index not in tiny]
    polylines = [_led_edge(lines, index, places, entries) for index in kept]
    return Fewer(polylines, new[kept], vertices, kept, tiny | dict(gone))


def _is_tiny(lines: Lines, index: int, width_px: float) -> bool:
    """Whether an edge stays within a line's width of its start: there is no ring in so little ink."""
    points = lines.polylines[index]
    return bool(np.hypot(*(points - points[0]).T).max() <= max(4.0, 2 * width_px))


def _led_edge(
    lines: Lines, index: int, places: dict[int, NDArray[np.float64]], entries: dict[int, Entry | None]
) -> Points:
    points, (start, end) = lines.polylines[index], lines.ends[index].tolist()
    first, last = (entries.get(2 * index + side) for side in (0, 1))
    low = first.row if start in places and first else 1
    high = len(points) - (last.row if end in places and last else 1)
    inner = points[low:high] if low < high else points[:0]
    return np.concatenate([[places.get(start, points[0])], inner, [places.get(end, points[-1])]])
