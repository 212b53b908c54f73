"""The thinned ink as a graph of pixels, and the chains into which vertices cut it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from daemon.components import components
from daemon.ink import Mask, thin
from daemon.shapes import Points

Indices = NDArray[np.intp]

# East, south-east, south, south-west, west, north-west, north, north-east as (dx, dy).
_AROUND = ((1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1))


@dataclass(frozen=True, slots=True, eq=False)
class Skeleton:
    """Centre-line pixels (N, 2) as (x, y) and which of them touch: rows of `links` hold up to 8 indices, -1 for none.

    Two pixels that touch by a corner only are linked when no third pixel links them by its sides (m-adjacency), so
    a line has two links at each pixel, an end one and a junction three or more.
    """

    pixels: Indices
    links: Indices
    degrees: Indices


@dataclass(frozen=True, slots=True, eq=False)
class Chain:
    """Skeleton pixels between two vertices, as indices from `start` to `end`; none when the vertices touch."""

    start: int
    end: int
    path: list[int]


def skeleton_of(mask: Mask) -> Skeleton:
    """The linked pixels of a centre line. mask: bool (H, W), already one pixel wide."""
    ys, xs = np.nonzero(mask)
    links = _touching(ys * (mask.shape[1] + 2) + xs, mask.shape[1] + 2)
    for diagonal in (1, 3, 5, 7):
        bridged = (links[:, diagonal - 1] >= 0) | (links[:, (diagonal + 1) % 8] >= 0)
        links[bridged, diagonal] = -1
    return Skeleton(np.stack([xs, ys], axis=1), links, (links >= 0).sum(axis=1))


def _touching(places: Indices, stride: int) -> Indices:
    """For each pixel the indices of its eight neighbours as in _AROUND, -1 for none. places: y * stride + x, sorted."""
    links = np.full((len(places), len(_AROUND)), -1, np.intp)
    for dy in (-1, 0, 1):
        at = np.searchsorted(places, places + dy * stride - 1)
        for dx in (-1, 0, 1):
            hit = places[np.minimum(at, len(places) - 1)] == places + dy * stride + dx if len(places) else at > 0
            if dx or dy:
                links[hit, _AROUND.index((dx, dy))] = at[hit]
            at += hit
    return links


def thinned(ink: Mask, *, shortest_spur_px: float) -> Skeleton:
    """The skeleton of `ink` without spurs: branches up to `shortest_spur_px` that thinning leaves on wide lines."""
    mask = thin(ink)
    skeleton = skeleton_of(mask)
    spurs = [
        pixel for end in np.flatnonzero(skeleton.degrees == 1) for pixel in _spur(skeleton, int(end), shortest_spur_px)
    ]
    if not spurs:
        return skeleton
    xs, ys = skeleton.pixels[spurs].T
    mask[ys, xs] = False
    return skeleton_of(mask)


def junctions(skeleton: Skeleton) -> list[Indices]:
    """The junctions of a skeleton: pixels with three or more links, those that touch taken together."""
    members = np.flatnonzero(skeleton.degrees >= 3)
    if not members.size:
        return []
    labels = _labels(skeleton.pixels[members])
    order = np.argsort(labels, kind="stable")
    return np.split(members[order], np.flatnonzero(np.diff(labels[order])) + 1)


def chains(skeleton: Skeleton, owners: Indices) -> list[Chain]:
    """Cut the skeleton at its owned pixels.

    owners: (N,) vertex that owns each pixel, -1 for none; every junction and every end must be owned. Each stretch of
    unowned pixels is returned once, pairs of vertices whose pixels touch once. Rings without a vertex are not
    returned: see `rings`.
    """
    owned = np.flatnonzero(owners >= 0)
    links, own = skeleton.links[owned], owners.tolist()
    # Pixels between vertices have two links: the last two of a sorted row.
    onward = np.sort(skeleton.links, axis=1)[:, -2:]
    one, other = onward[:, 0].tolist(), onward[:, 1].tolist()
    walked: set[int] = set()
    found, touching = [], set()
    for pixel, row in zip(owned.tolist(), links.tolist(), strict=True):
        for link in row:
            if link >= 0 and own[link] >= 0:
                if own[pixel] < own[link]:
                    touching.add((own[pixel], own[link]))
            elif link >= 0 and link not in walked:
                chain = _walk(pixel, link, one, other, own)
                walked.update((link, chain.path[-1]))
                found.append(chain)
    return found + [Chain(start, end, []) for start, end in sorted(touching)]


def rings(skeleton: Skeleton, owners: Indices) -> Indices:
    """One pixel of every connected part of the skeleton that no vertex owns a pixel of."""
    if not len(owners):
        return np.empty(0, np.intp)
    labels = _labels(skeleton.pixels)
    names, first = np.unique(labels, return_index=True)
    return np.asarray(first[~np.isin(names, labels[owners >= 0])], np.intp)


def _labels(pixels: Indices) -> Indices:
    """For each of the pixels, (N, 2), the connected part that it belongs to."""
    xs, ys = pixels.T
    canvas = np.zeros((ys.max() + 1, xs.max() + 1), bool)
    canvas[ys, xs] = True
    return components(canvas).at(ys, xs)


def chain_points(skeleton: Skeleton, chain: Chain, vertices: Points) -> Points:
    """A chain as a polyline from vertex to vertex, (N, 2) in px."""
    path = skeleton.pixels[chain.path].astype(np.float64).reshape(-1, 2)
    return np.concatenate([vertices[[chain.start]], path, vertices[[chain.end]]])


def _walk(came: int, pixel: int, one: list[int], other: list[int], own: list[int]) -> Chain:
    """Follow unowned pixels, each with its two links, from an owned pixel until the next owned one."""
    start, path = own[came], []
    while own[pixel] < 0:
        path.append(pixel)
        came, pixel = pixel, other[pixel] if one[pixel] == came else one[pixel]
    return Chain(start, own[pixel], path)


def _spur(skeleton: Skeleton, end: int, shortest_px: float) -> list[int]:
    """The pixels from an end to its junction when that is nearer than `shortest_px`, else none."""
    path, came, pixel = [end], -1, end
    while len(path) <= shortest_px:
        onward = [link for link in skeleton.links[pixel].tolist() if link >= 0 and link != came]
        if len(onward) != 1:
            return []
        came, pixel = pixel, onward[0]
        if skeleton.degrees[pixel] >= 3:
            return path
        path.append(pixel)
    return []
