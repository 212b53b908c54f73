"""Strokes in an order that keeps the way with the pen up short."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from daemon.shapes import Points, Stroke
from daemon.toolpath.tour import improve

Place: TypeAlias = tuple[float, float]

_DOORS = 16
"""On a closed stroke the nearest start is looked for on so many of its points first, on all of them at the end."""


def order(strokes: Sequence[Stroke], *, start_mm: Place, end_mm: Place | None) -> tuple[Stroke, ...]:
    """The same strokes, drawn one after the other on a short way from start_mm to end_mm, or to anywhere (None).

    A stroke may be drawn from its other end, a closed one (first point = last point) from any of its points; nothing
    else about it changes. Nearest neighbour first, then 2-opt and Or-opt on neighbour lists with local kicks (see
    `tour`); the work is bounded by the number of strokes, never by a clock, so the same strokes always give the same
    order. Never longer than the given order.
    """
    if not strokes:
        return ()
    given = list(strokes)
    greedy = _nearest(given, start_mm)
    best = min((given, greedy), key=lambda tour: travel_mm(tour, start_mm, end_mm))
    improved = turn_closed(_improved(best, start_mm, end_mm), start_mm, end_mm)
    if not any(map(is_closed, given)):
        return tuple(improved)
    return tuple(turn_closed(_improved(improved, start_mm, end_mm), start_mm, end_mm))


def is_closed(stroke: Stroke) -> bool:
    return len(stroke.points) > 2 and bool((stroke.points[0] == stroke.points[-1]).all())


def turn_closed(strokes: list[Stroke], start_mm: Place, end_mm: Place | None) -> list[Stroke]:
    """Each closed stroke begun where the way to it and from it is shortest."""
    tour: list[Stroke] = []
    here = np.asarray(start_mm, float)
    for index, stroke in enumerate(strokes):
        following = strokes[index + 1].points[0] if index + 1 < len(strokes) else end_mm
        tour.append(_turned(stroke, here, here if following is None else np.asarray(following, float)))
        here = tour[-1].points[-1]
    return tour


def _improved(strokes: list[Stroke], start_mm: Place, end_mm: Place | None) -> list[Stroke]:
    ends = np.array([[stroke.points[0], stroke.points[-1]] for stroke in strokes])
    end = None if end_mm is None else np.asarray(end_mm, float)
    tour = improve(ends, start=np.asarray(start_mm, float), end=end)
    return [_reversed(strokes[code >> 1]) if code & 1 else strokes[code >> 1] for code in tour.tolist()]


def travel_mm(strokes: Sequence[Stroke], start_mm: Place, end_mm: Place | None) -> float:
    """The way with the pen up, from start_mm through the strokes as they are given to end_mm, or to anywhere (None)."""
    last = strokes[-1].points[-1]
    leave = np.array([start_mm, *(stroke.points[-1] for stroke in strokes)], float)
    arrive = np.array([*(stroke.points[0] for stroke in strokes), last if end_mm is None else end_mm], float)
    return float(np.hypot(*(arrive - leave).T).sum())


def _nearest(strokes: Sequence[Stroke], start_mm: Place) -> list[Stroke]:
    """Always on to the nearest end (or point of a closed stroke) that is left."""
    owner, point_index, places = _doors(strokes)
    here = np.asarray(start_mm, float)
    tour: list[Stroke] = []
    while len(owner):
        off = places - here
        nearest = int(np.argmin((off * off).sum(axis=1)))
        index = int(owner[nearest])
        stroke = _begun_at(strokes[index], int(point_index[nearest]))
        tour.append(stroke)
        here = stroke.points[-1]
        places[owner == index] = np.inf
        if len(tour) % 64 == 0 or len(tour) == len(strokes):
            left = np.isfinite(places[:, 0])
            owner, point_index, places = owner[left], point_index[left], places[left]
    return tour


def _doors(strokes: Sequence[Stroke]) -> tuple[NDArray[np.int64], NDArray[np.int64], Points]:
    """Where strokes may be begun: whose, at which of its points, and where that is."""
    indices = [_door_indices(stroke) for stroke in strokes]
    owner = np.repeat(np.arange(len(strokes)), [len(some) for some in indices])
    places = np.concatenate([stroke.points[some] for stroke, some in zip(strokes, indices, strict=True)])
    return owner, np.concatenate(indices), places


def _door_indices(stroke: Stroke) -> NDArray[np.int64]:
    last = len(stroke.points) - 1
    if is_closed(stroke):
        return np.unique(np.linspace(0, last - 1, min(last, _DOORS)).astype(np.int64))
    return np.unique(np.array([0, last], np.int64))


def _begun_at(stroke: Stroke, index: int) -> Stroke:
    """The stroke from its point `index` on: closed ones are turned, open ones reversed."""
    if index == 0:
        return stroke
    if not is_closed(stroke):
        return _reversed(stroke)
    return replace(stroke, points=np.concatenate([stroke.points[index:-1], stroke.points[: index + 1]]))


def _reversed(stroke: Stroke) -> Stroke:
    return replace(stroke, points=stroke.points[::-1])


def _turned(stroke: Stroke, before: NDArray[np.float64], after: NDArray[np.float64]) -> Stroke:
    if not is_closed(stroke):
        return stroke
    detour = np.hypot(*(stroke.points[:-1] - before).T) + np.hypot(*(stroke.points[:-1] - after).T)
    return _begun_at(stroke, int(np.argmin(detour)))
