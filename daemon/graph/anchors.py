"""Every junction and end of the skeleton belongs to a vertex; those that the network missed become vertices."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.bands import Band, bands
from daemon.graph.plausibility import Floats
from daemon.graph.skeleton import Indices, Skeleton, junctions, rings
from daemon.shapes import Points

_HALO_SHARE = 1.1
"""Distances over pixels are up to a tenth too long."""
_DISC_PX = 2.3
"""A vertex owns the centre line in the disc that the network paints for a corner."""


@dataclass(frozen=True, slots=True, eq=False)
class Anchored:
    """Vertices (V, 2) in px and the vertex that owns each pixel of a skeleton (N,), -1 for none.

    The first `corners` vertices are the network's, the others were found on the skeleton.
    """

    vertices: Points
    owners: Indices
    corners: int


@dataclass(frozen=True, slots=True, eq=False)
class Nearest:
    """The nearest vertex of the pixels that have one near by, and how far it is.

    places: (N,) of those pixels, sorted, row * width + column.
    """

    width: int
    places: Indices
    vertex: NDArray[np.int32]
    distance_px: NDArray[np.float16]

    def at(self, y: Indices, x: Indices) -> tuple[NDArray[np.int32], NDArray[np.float16]]:
        """Of pixels the nearest vertex and its distance; 0 and a great distance where none is near."""
        wanted = y * self.width + x
        if not len(self.places):
            return np.zeros(wanted.shape, np.int32), np.full(wanted.shape, np.inf, np.float16)
        found = np.minimum(np.searchsorted(self.places, wanted), len(self.places) - 1)
        held = self.places[found] == wanted
        return np.where(held, self.vertex[found], np.int32(0)), np.where(
            held, self.distance_px[found], np.float16(np.inf)
        )


def anchored(skeleton: Skeleton, corners: Points, shape: tuple[int, int], *, width_px: float) -> Anchored:
    """Give every junction, end and ring of a skeleton a vertex: the corner nearby, else one of its own.

    corners: (C, 2) in px, no two on one pixel. shape: of the page. width_px: of the line. A corner answers
    for junctions and ends within 1.5 line widths (3 px at least): thinning moves a junction by half a width, and one
    crossing becomes two.
    """
    reach_px = max(3.0, 1.5 * width_px)
    owner, distance = nearest_at(corners, skeleton.pixels, shape, within_px=reach_px)
    owners = np.where(distance <= max(_DISC_PX, 0.75 * width_px), owner, -1)
    _seize(skeleton, corners, owners, shape, reach_px)
    clusters = junctions(skeleton) + [np.array([end]) for end in np.flatnonzero(skeleton.degrees <= 1)]
    strays = [_claim(cluster, owner, distance, owners, reach_px) for cluster in clusters]
    vertices = _add_strays(skeleton, [s for s in strays if s is not None], corners, owners, width_px)
    closed = rings(skeleton, owners)
    owners[closed] = len(vertices) + np.arange(len(closed))
    vertices = np.concatenate([vertices, skeleton.pixels[closed].astype(np.float64)])
    return _compact(vertices, owners, len(corners))


def nearest(vertices: Points, shape: tuple[int, int], *, within_px: float) -> Nearest:
    """The nearest vertex of every pixel that has one within that. vertices: (V, 2) in px. shape: (H, W) of the page."""
    parts = [(np.empty(0, np.intp), np.empty(0, np.int32), np.empty(0, np.float16))]
    for band, vertex, distance in _fields(vertices, shape, within_px):
        away = distance.astype(np.float16).reshape(-1)
        near = np.flatnonzero(away <= within_px)
        parts.append((near + band.own.start * shape[1], vertex.reshape(-1)[near], away[near]))
    places, names, away = (np.concatenate(some) for some in zip(*parts, strict=True))
    return Nearest(shape[1], places, names, away)


def nearest_at(
    vertices: Points, pixels: Indices, shape: tuple[int, int], *, within_px: float
) -> tuple[Indices, Floats]:
    """The nearest vertex of each pixel (N, 2) and the distance to it in px, where one is within that; else any."""
    owner = _chamfer_at(vertices, pixels, shape, within_px)[0]
    if not len(vertices):
        return owner, np.full(len(pixels), np.inf)
    return owner, np.hypot(*(pixels - vertices[owner]).T)


def _chamfer_at(
    vertices: Points, places: Indices, shape: tuple[int, int], within_px: float
) -> tuple[Indices, NDArray[np.float32]]:
    """The nearest vertex of each place (N, 2) and how far it is over the pixels between them."""
    found, away = np.zeros(len(places), np.intp), np.full(len(places), np.inf, np.float32)
    x, y = places.T
    for band, vertex, distance in _fields(vertices, shape, within_px):
        here = np.flatnonzero((y >= band.own.start) & (y < band.own.stop))
        found[here] = vertex[y[here] - band.own.start, x[here]]
        away[here] = distance[y[here] - band.own.start, x[here]]
    return found, away


def _fields(
    vertices: Points, shape: tuple[int, int], within_px: float
) -> Iterator[tuple[Band, NDArray[np.int32], NDArray[np.float32]]]:
    """For the own rows of each band that has a vertex near by the nearest one of each pixel and how far it is."""
    x, y = np.clip(np.rint(vertices).astype(int), 0, [shape[1] - 1, shape[0] - 1]).reshape(-1, 2).T
    for band in bands(shape[0], halo_px=_HALO_SHARE * within_px + 1):
        here = np.flatnonzero((y >= band.seen.start) & (y < band.seen.stop))
        if not here.size:
            continue
        seeds = np.ones((band.seen.stop - band.seen.start, shape[1]), np.uint8)
        down, across = y[here] - band.seen.start, x[here]
        seeds[down, across] = 0
        distance, labels = cv2.distanceTransformWithLabels(
            seeds, cv2.DIST_L2, cv2.DIST_MASK_5, labelType=cv2.DIST_LABEL_PIXEL
        )
        names = np.zeros(int(labels.max()) + 1, np.int32)
        names[labels[down, across]] = here
        yield band, names[labels[band.own_of_seen]], np.asarray(distance[band.own_of_seen], np.float32)


def _seize(skeleton: Skeleton, corners: Points, owners: Indices, shape: tuple[int, int], reach_px: float) -> None:
    """Give each corner beside the skeleton the nearest pixel of it, when that is in reach and free."""
    idle = np.setdiff1d(np.arange(len(corners)), owners)
    if not idle.size or not len(owners):
        return
    places = np.rint(corners[idle]).astype(np.intp)
    pixel, distance = _chamfer_at(skeleton.pixels.astype(np.float64), places, shape, reach_px)
    free = (distance <= reach_px) & (owners[pixel] < 0)
    owners[pixel[free]] = idle[free]


def _claim(cluster: Indices, owner: Indices, distance: Floats, owners: Indices, reach_px: float) -> Indices | None:
    """Give a junction or an end to the corner that reaches it; return it when none does."""
    closest = cluster[distance[cluster].argmin()]
    if distance[closest] > reach_px:
        return cluster
    owners[cluster] = owner[closest]
    return None


def _add_strays(skeleton: Skeleton, strays: list[Indices], corners: Points, owners: Indices, width_px: float) -> Points:
    """Vertices with one more for each stray, strays within a line width of each other taken together."""
    if not strays:
        return corners
    centres = np.array([skeleton.pixels[stray].mean(axis=0) for stray in strays])
    groups = _grouped(centres, 1.25 * width_px)
    for stray, group in zip(strays, groups, strict=True):
        owners[stray] = len(corners) + group
    counts = np.bincount(groups)
    sums = np.stack([np.bincount(groups, weights=centres[:, axis]) for axis in (0, 1)], axis=1)
    return np.concatenate([corners, sums / counts[:, None]])


def _grouped(points: Points, apart_px: float) -> Indices:
    """The number of each point's group; points nearer than `apart_px` to the first of a group belong to it."""
    cell = max(apart_px, 1.0)
    cells: dict[tuple[int, int], list[int]] = {}
    firsts: list[int] = []
    groups = []
    for index, (x, y) in enumerate(points.tolist()):
        column, row = int(x // cell), int(y // cell)
        near = [g for dx in (-1, 0, 1) for dy in (-1, 0, 1) for g in cells.get((column + dx, row + dy), ())]
        joined = [g for g in near if np.hypot(*(points[firsts[g]] - (x, y))) < apart_px]
        if not joined:
            joined = [len(firsts)]
            firsts.append(index)
            cells.setdefault((column, row), []).append(joined[0])
        groups.append(joined[0])
    return np.array(groups, np.intp)


def _compact(vertices: Points, owners: Indices, corners: int) -> Anchored:
    """Leave out strays that own nothing."""
    kept = np.arange(len(vertices)) < corners
    kept[owners[owners >= 0]] = True
    number = np.cumsum(kept) - 1
    return Anchored(vertices[kept], np.where(owners >= 0, number[owners], -1), corners)
