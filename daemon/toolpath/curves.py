"""A traced line as few straight moves and arcs that never leave it by more than a stated error."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from daemon.shapes import Arc, Line, Points, Stroke
from daemon.toolpath.bows import Bow, bow, nearest
from daemon.toolpath.corners import corners

Room: TypeAlias = tuple[tuple[float, float], tuple[float, float]]
"""The lowest and the highest x and y that may be reached."""

CHORD_MM = 0.01
"""The points of a fitted stroke are so near to its arcs."""
_STEP_ERRORS, _SHORTEST_STEP_MM = 2.0, 0.05
_FIRST_REACH = 4


def fitted(stroke: Stroke, *, error_mm: float, shortest_mm: float = 0.0, room: Room | None = None) -> Stroke:
    """The stroke as straight moves and arcs of about half a turn at most, and its points as the chords of these.

    stroke: as it was traced, not simplified. error_mm: above 0; no place of the trace is further from the moves, and
    no place of the moves further from the trace. shortest_mm: points of the trace nearer to the one before are left
    out, the last one not; the moves are then off by so much more. room: no arc bulges out of it where the trace is
    inside. Begins and ends where the trace does and turns on the tips of its corners; its joints lie on the trace, so
    where it is smooth the moves meet almost smoothly. Each move goes as far as the error lets it. For each end it
    is known which arcs from here to there are near enough to every sample between: a range of curvatures, empty when
    there is none. One arc between two joints needs fewer moves than the two of a biarc for the same error. A closed
    trace all within error_mm of its first point becomes that point.
    """
    trace = _thinned(stroke.points, shortest_mm)
    if len(trace) < 2 or _is_dot(trace, error_mm):
        return replace(stroke, points=stroke.points[:1], moves=None)
    samples, vertices = sampled(trace, max(_STEP_ERRORS * error_mm, _SHORTEST_STEP_MM))
    tips = vertices[corners(trace, error_mm=error_mm)].tolist()
    runs = (samples[a : b + 1] for a, b in pairwise([0, *tips, len(samples) - 1]))
    pieces = [piece for run in runs for piece in _greedy(run, error_mm, room)]
    ends = [tuple(piece.start.tolist()) for piece in pieces[1:]] + [tuple(samples[-1].tolist())]
    moves = tuple(piece.bow.move(end) for piece, end in zip(pieces, ends, strict=True))
    return replace(stroke, points=points_of(samples[0], moves), moves=moves)


def points_of(start: NDArray[np.float64], moves: tuple[Line | Arc, ...], *, chord_mm: float = CHORD_MM) -> Points:
    """The polyline (N, 2) along moves from `start`: the ends of all, and of arcs chords at most chord_mm off them."""
    parts = [start[None]]
    for move in moves:
        parts.append(_chords(parts[-1][-1], move, chord_mm) if isinstance(move, Arc) else np.array([move.end]))
    return np.concatenate(parts)


def sampled(trace: Points, step_mm: float) -> tuple[Points, NDArray[np.intp]]:
    """Places along a polyline, its own points among them, at most step_mm apart; and where its own points are."""
    along = np.diff(trace, axis=0)
    counts = np.maximum(1, np.ceil(np.hypot(*along.T) / step_mm)).astype(np.intp)
    firsts = np.concatenate([[0], np.cumsum(counts)])
    parts = (np.arange(firsts[-1]) - np.repeat(firsts[:-1], counts)) / np.repeat(counts, counts)
    between = np.repeat(trace[:-1], counts, axis=0) + parts[:, None] * np.repeat(along, counts, axis=0)
    return np.concatenate([between, trace[-1:]]), firsts


class _Piece(NamedTuple):
    start: NDArray[np.float64]
    bow: Bow


def _greedy(samples: Points, error_mm: float, room: Room | None) -> list[_Piece]:
    """From the first sample on each piece as long as can be. Two neighbouring samples are always joined straight."""
    pieces: list[_Piece] = []
    first, reach = 0, _FIRST_REACH
    while first < len(samples) - 1:
        last, found = _furthest(samples[first:], reach, error_mm, room)
        better = nearest(samples[first : first + last + 1], found, error_mm=error_mm)
        pieces.append(_Piece(samples[first], better if _inside(better, room) else found))
        first, reach = first + last, max(_FIRST_REACH, last // 2)
    return pieces


def _furthest(samples: Points, reach: int, error_mm: float, room: Room | None) -> tuple[int, Bow]:
    """The last sample that one bow from the first leads to, looked for in doubling and then halving steps."""
    good, found, bad = 1, Bow(samples[0], samples[1], 0.0), len(samples)
    trial = min(reach, bad - 1)
    while bad - good > 1:
        longer = bow(samples[: trial + 1], error_mm=error_mm)
        if longer is None or not _inside(longer, room):
            bad = trial
        else:
            good, found = trial, longer
        trial = min(2 * good, bad - 1) if bad == len(samples) else (good + bad) // 2
    return good, found


def _inside(longer: Bow, room: Room | None) -> bool:
    """An arc of about half a turn at most is nowhere further from the ends' chord than its height."""
    if room is None or longer.bulge == 0:
        return True
    low, high = (np.asarray(corner) for corner in room)
    ends = np.stack([longer.start, longer.end])
    return bool(min((ends - low).min(), (high - ends).min()) >= longer.height)


def _thinned(points: Points, shortest_mm: float) -> Points:
    """Without points equal or nearer than shortest_mm to the one before; the last one stays."""
    kept = [0]
    rows = points.tolist()
    for index in range(1, len(rows)):
        if rows[index] != rows[kept[-1]] and math.dist(rows[index], rows[kept[-1]]) >= shortest_mm:
            kept.append(index)
    if kept[-1] != len(rows) - 1 and rows[kept[-1]] != rows[-1]:
        # The last point takes the place of the one that it is too near to, but never of the first.
        kept[max(1, len(kept) - 1) :] = [len(rows) - 1]
    return points[kept]


def _is_dot(trace: Points, error_mm: float) -> bool:
    return bool((trace[0] == trace[-1]).all() and np.hypot(*(trace - trace[0]).T).max() <= error_mm)


def _chords(start: NDArray[np.float64], arc: Arc, chord_mm: float) -> Points:
    """The ends (N, 2) of the chords of an arc."""
    spoke = start - arc.centre
    radius_mm, sweep = float(np.hypot(*spoke)), arc.sweep((float(start[0]), float(start[1])))
    widest = 2 * math.acos(max(0.0, 1 - chord_mm / radius_mm))
    count = max(1, math.ceil(sweep / widest))
    angles = np.arange(1, count) / count * (-sweep if arc.clockwise else sweep)
    cosine, sine = np.cos(angles), np.sin(angles)
    inner = np.stack([cosine * spoke[0] - sine * spoke[1], sine * spoke[0] + cosine * spoke[1]], axis=1) + arc.centre
    return np.concatenate([inner, [arc.end]])
