"""Edges are moved onto the ridge of the ink, to a fraction of a pixel, by the grey values across them."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.graph.crossings import Lines
from daemon.graph.plausibility import Floats
from daemon.graph.skeleton import Indices
from daemon.polyline import lengths_along, places_at
from daemon.shapes import Map, Points

_STEP_PX = 0.25
_INKED = 0.25
"""Share of full ink above which a profile still belongs to the line."""
_FIT_FROM_PX, _FIT_TO_PX = 1.5, 6.0
"""Stretch of an edge beyond the junction's own ink that says where the edge enters its vertex."""
_PASSES = 4
_STRAIGHT_PX = 0.05
_MOVE_PX, _JUNCTION_MOVE_PX = 1.5, 2.5
_ROWS = 1 << 14
"""Points whose profiles are looked at together: few enough to stay in the cache; OpenCV allows 32,767."""
_HOLD = 0.05
"""Weight with which a vertex holds its place against the lines that meet in it."""


@dataclass(frozen=True, slots=True, eq=False)
class _Bundle:
    """All edges as one array of points about one px apart: (S, 2), with each edge's first and last row."""

    points: Points
    first: Indices
    last: Indices
    edge: Indices


def onto_ridge(polylines: list[Points], ends: Indices, vertices: Points, ink: Map, *, width_px: float) -> Lines:
    """Polylines and vertices moved sideways onto the middle of the ink.

    polylines: (N, 2) each, from vertex to vertex. ends: (E, 2) indices of their vertices. ink: float32 (H, W), 1 =
    full ink. width_px: of the line. Returns polylines of points about one px apart. A point moves to
    the centroid of the ink across the edge; where other lines run into the profile it follows its neighbours. A vertex
    moves to where the lines that enter it meet (least squares), at most half a line width or a pixel.
    """
    bundle = _smoothed(_bundle(polylines))
    for _ in range(2):
        offsets, valid, normals = _offsets(bundle, ink, width_px)
        bundle = _shifted(bundle, normals, _spread(offsets, valid, bundle))
    moved = _meeting_points(bundle, valid, ends, vertices, width_px)
    bundle = _pinned(bundle, valid, ends, moved)
    rows = [slice(a, b + 1) for a, b in zip(bundle.first, bundle.last, strict=True)]
    return Lines([bundle.points[r] for r in rows], [valid[r] for r in rows], ends, moved)


def _bundle(polylines: list[Points]) -> _Bundle:
    """Every polyline resampled to steps of about one px, all in one array."""
    pieces = [_resampled(polyline) for polyline in polylines]
    counts = np.array([len(piece) for piece in pieces])
    last = np.cumsum(counts) - 1
    return _Bundle(np.concatenate(pieces), last - counts + 1, last, np.repeat(np.arange(len(counts)), counts))


def _resampled(polyline: Points) -> Points:
    along = lengths_along(polyline)
    at = np.linspace(0.0, along[-1], max(2, round(along[-1])) + 1)
    return places_at(at, polyline, along)


def _smoothed(bundle: _Bundle) -> _Bundle:
    """The steps of the pixel raster taken out of the polylines; ends stay."""
    points = bundle.points
    for _ in range(_PASSES):
        points = _blurred(points, bundle)
        points[bundle.first], points[bundle.last] = bundle.points[bundle.first], bundle.points[bundle.last]
    return _Bundle(points, bundle.first, bundle.last, bundle.edge)


def _blurred(values: Floats, bundle: _Bundle) -> Floats:
    """One pass of the binomial filter 1 2 1 along each edge."""
    index = np.arange(len(values))
    ahead = np.minimum(index + 1, bundle.last[bundle.edge])
    behind = np.maximum(index - 1, bundle.first[bundle.edge])
    return np.asarray(0.25 * values[behind] + 0.5 * values + 0.25 * values[ahead])


def _offsets(bundle: _Bundle, ink: Map, width_px: float) -> tuple[Floats, NDArray[np.bool_], Points]:
    """How far the middle of the ink lies to the side of each point, whether the profile is one line's, the normals."""
    normals = _normals(bundle)
    rows = range(0, len(normals), _ROWS)
    parts = [_profiles(bundle.points[r : r + _ROWS], normals[r : r + _ROWS], ink, width_px) for r in rows]
    offsets, widths, closed = (np.concatenate(some) for some in zip(*parts, strict=True))
    usual = np.maximum(_medians(widths, bundle), _STEP_PX)
    valid = closed & (widths <= usual + 0.75) & (np.abs(offsets) <= width_px / 2 + 1.0)
    return offsets.astype(np.float64), valid, normals


def _profiles(
    points: Points, normals: Points, ink: Map, width_px: float
) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.bool_]]:
    """The ink across each point: how far its middle lies aside, how wide it is, whether paper bounds it."""
    reach = width_px / 2 + 2.0
    across = np.arange(-reach, reach + _STEP_PX / 2, _STEP_PX, dtype=np.float32)
    x, y = (points[:, None, k].astype(np.float32) + across * normals[:, None, k].astype(np.float32) for k in (0, 1))
    profiles = np.asarray(cv2.remap(ink, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT), np.float32)
    inked = profiles > _INKED
    centre = np.abs(np.where(inked, across, np.float32(np.inf))).argmin(axis=1)
    run = _run_around(inked, centre)
    weights = np.where(run, profiles, np.float32(0.0))
    total = weights.sum(axis=1)
    offsets = weights @ across / np.maximum(total, np.float32(1e-9))
    return offsets, run.sum(axis=1, dtype=np.float32) * np.float32(_STEP_PX), (total > 0) & ~run[:, 0] & ~run[:, -1]


def _normals(bundle: _Bundle) -> Points:
    """Unit normals from points three px apart on either side, within each edge."""
    index = np.arange(len(bundle.points))
    ahead = np.minimum(index + 3, bundle.last[bundle.edge])
    behind = np.maximum(index - 3, bundle.first[bundle.edge])
    along = bundle.points[ahead] - bundle.points[behind]
    unit = along / np.maximum(np.hypot(*along.T), 1e-9)[:, None]
    return np.stack([-unit[:, 1], unit[:, 0]], axis=1)


def _run_around(inked: NDArray[np.bool_], centre: Indices) -> NDArray[np.bool_]:
    """The stretch of True around `centre` in each row."""
    columns = np.arange(inked.shape[1])
    bare_left = np.where(~inked & (columns <= centre[:, None]), columns, -1).max(axis=1)
    bare_right = np.where(~inked & (columns >= centre[:, None]), columns, inked.shape[1]).min(axis=1)
    return np.asarray((columns > bare_left[:, None]) & (columns < bare_right[:, None]))


def _medians(values: NDArray[np.float32], bundle: _Bundle) -> Floats:
    """For each point the lower quartile of the values on its edge."""
    order = np.lexsort((values, bundle.edge))
    quartile = bundle.first + (bundle.last - bundle.first) // 4
    return np.asarray(values[order][quartile][bundle.edge], np.float64)


def _spread(offsets: Floats, valid: NDArray[np.bool_], bundle: _Bundle) -> Floats:
    """Offsets smoothed along each edge; invalid points take over from the nearest valid ones on their edge."""
    index = np.arange(len(offsets), dtype=np.float64)
    known = np.flatnonzero(valid)
    counts = np.bincount(bundle.edge[known], minlength=len(bundle.first))
    if not known.size:
        return np.zeros(len(offsets))
    # Each edge's first and last known offset again just outside the edge: interpolation never leaves its edge.
    edges = np.flatnonzero(counts)
    ends = np.cumsum(counts)[edges] - 1
    begins = ends - counts[edges] + 1
    x = np.concatenate([index[known], bundle.first[edges] - 0.4, bundle.last[edges] + 0.4])
    y = np.concatenate([offsets[known], offsets[known[begins]], offsets[known[ends]]])
    order = np.argsort(x, kind="stable")
    filled = np.where(counts[bundle.edge] > 0, np.interp(index, x[order], y[order]), 0.0)
    for _ in range(2):
        filled = _blurred(filled, bundle)
    return np.asarray(filled)


def _shifted(bundle: _Bundle, normals: Points, offsets: Floats) -> _Bundle:
    return _Bundle(bundle.points + normals * offsets[:, None], bundle.first, bundle.last, bundle.edge)


def _meeting_points(
    bundle: _Bundle, valid: NDArray[np.bool_], ends: Indices, vertices: Points, width_px: float
) -> Points:
    """Where the lines that enter each vertex meet: least squares over the distances to them and to the old place."""
    lead = _FIT_FROM_PX + width_px / 2
    index = np.arange(len(bundle.points))
    from_start, from_end = index - bundle.first[bundle.edge], bundle.last[bundle.edge] - index
    normal_matrix = np.zeros((len(vertices), 2, 2)) + _HOLD * np.eye(2)
    right = _HOLD * vertices
    for side, distance in ((0, from_start), (1, from_end)):
        used = valid & (distance >= lead) & (distance <= lead + _FIT_TO_PX)
        means, normals, trust = _fits(bundle.points[used], bundle.edge[used], len(bundle.first))
        enough = trust > 0
        outer = trust[:, None, None] * normals[:, :, None] * normals[:, None, :]
        at = ends[enough, side]
        np.add.at(normal_matrix, at, outer[enough])
        np.add.at(right, at, np.einsum("eij,ej->ei", outer, means)[enough])
    moved = np.linalg.solve(normal_matrix, right[:, :, None])[:, :, 0]
    step = moved - vertices
    length = np.hypot(*step.T)
    degree = np.bincount(ends.ravel(), minlength=len(vertices))
    most = np.where(degree >= 3, _JUNCTION_MOVE_PX, _MOVE_PX)
    return np.asarray(vertices + step * np.minimum(1.0, most / np.maximum(length, 1e-9))[:, None])


def _fits(points: Points, edge: Indices, count: int) -> tuple[Points, Points, Floats]:
    """The line through each edge's points: its mean, its unit normal, and how far it is to be trusted, 0..1.

    A line that is not straight says little about where it enters its vertex, and one of few points nothing.
    """
    total = np.bincount(edge, minlength=count)
    safe = np.maximum(total, 1)[:, None]
    means = np.stack([np.bincount(edge, points[:, axis], count) for axis in (0, 1)], axis=1) / safe
    x, y = (points - means[edge]).T
    xx, yy, xy = (np.bincount(edge, product, count) for product in (x * x, y * y, x * y))
    angle = 0.5 * np.arctan2(2 * xy, xx - yy)
    least = (xx + yy) / 2 - np.hypot((xx - yy) / 2, xy)
    variance = np.maximum(least, 0.0) / np.maximum(total, 1)
    trust = np.where(total >= 4, 1.0 / (1.0 + variance / _STRAIGHT_PX**2) ** 2, 0.0)
    return means, np.stack([-np.sin(angle), np.cos(angle)], axis=1), trust


def _pinned(bundle: _Bundle, valid: NDArray[np.bool_], ends: Indices, vertices: Points) -> _Bundle:
    """Edges that end in their vertices; doubtful points near an end lie on the line to the first sound one."""
    index = np.arange(len(bundle.points))
    sound = valid.copy()
    sound[bundle.first] = sound[bundle.last] = True
    points = bundle.points.copy()
    points[bundle.first], points[bundle.last] = vertices[ends[:, 0]], vertices[ends[:, 1]]
    inner = np.flatnonzero(sound)
    lengths = np.minimum(index - bundle.first[bundle.edge], bundle.last[bundle.edge] - index)
    doubtful = ~sound & (lengths <= 12)
    for axis in (0, 1):
        points[doubtful, axis] = np.interp(index[doubtful], inner, points[inner, axis])
    return _Bundle(points, bundle.first, bundle.last, bundle.edge)
