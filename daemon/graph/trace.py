"""Where no straight edge explains the ink, the edge follows the thinned ink from vertex to vertex."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.graph.skeleton import Chain, Indices, Skeleton
from daemon.shapes import Points

_COVERED_PX = 1.6
"""Centre-line pixels this near to a straight edge are drawn by it."""
_RUN_PX = 4
"""An uncovered stretch of a chain shorter than this is the rounding of a junction, not a line."""
_SHIFT = 4


def unexplained(
    chains: list[Chain],
    skeleton: Skeleton,
    vertices: Points,
    straight: Indices,
    shape: tuple[int, int],
    *,
    width_px: float,
) -> list[Chain]:
    """The chains that no straight edge draws.

    straight: (E, 2) pairs of vertices. A chain of which straight edges cover all but a few pixels is left out, and so
    is a chain that touches itself at its vertex within the ink's own width. Chains without pixels, between vertices
    that touch, are kept when they are needed to connect the two (rule *short*).
    """
    near = _distance_to(straight, vertices, shape) <= _COVERED_PX
    drawn = {(min(pair), max(pair)) for pair in straight.tolist()}
    kept = [chain for chain in chains if chain.path and _is_line(chain, skeleton, vertices, near, width_px)]
    touching = [chain for chain in chains if not chain.path and (chain.start, chain.end) not in drawn]
    joined = [*drawn, *((chain.start, chain.end) for chain in kept)]
    return kept + _short(touching, vertices, joined)


def _is_line(chain: Chain, skeleton: Skeleton, vertices: Points, near: NDArray[np.bool_], width_px: float) -> bool:
    x, y = skeleton.pixels[chain.path].T
    bare = ~near[y, x]
    if _longest_run(bare) < min(_RUN_PX, len(chain.path)):
        # The pixels that its vertices own are ink of this chain, too.
        before, after = (_bare(chain, skeleton, vertices, near, end) for end in (0, -1))
        if _longest_run(np.concatenate([before, bare, after[::-1]])) < _RUN_PX:
            return False
    if chain.start != chain.end:
        return True
    away = np.hypot(*(skeleton.pixels[chain.path] - vertices[chain.start]).T).max()
    return bool(away > max(4.0, 2 * width_px))


def _bare(chain: Chain, skeleton: Skeleton, vertices: Points, near: NDArray[np.bool_], end: int) -> NDArray[np.bool_]:
    """Whether straight edges leave out the points, one px apart, from the vertex at one end to the chain's pixels."""
    vertex, pixel = vertices[(chain.start, chain.end)[end]], skeleton.pixels[chain.path[end]]
    count = int(np.hypot(*(pixel - vertex)))
    x, y = np.rint(np.linspace(vertex, pixel, count, endpoint=False)).astype(np.intp).T
    return np.asarray(~near[y.clip(0, near.shape[0] - 1), x.clip(0, near.shape[1] - 1)])


def _short(touching: list[Chain], vertices: Points, joined: list[tuple[int, int]]) -> list[Chain]:
    """The shortest of the touching pairs that connect what is not connected near by: no triangle within one blob."""
    group = list(range(len(vertices)))

    def root(vertex: int) -> int:
        while group[vertex] != vertex:
            group[vertex] = group[group[vertex]]
            vertex = group[vertex]
        return vertex

    for start, end in joined:
        if np.hypot(*(vertices[end] - vertices[start])) <= 6.0:
            group[root(start)] = root(end)
    kept = []
    for chain in sorted(touching, key=lambda c: float(np.hypot(*(vertices[c.end] - vertices[c.start])))):
        if root(chain.start) != root(chain.end):
            group[root(chain.start)] = root(chain.end)
            kept.append(chain)
    return kept


def _distance_to(edges: Indices, vertices: Points, shape: tuple[int, int]) -> NDArray[np.float32]:
    """Distance of every pixel to the nearest straight edge, in px."""
    blank = np.ones(shape, np.uint8)
    segments = np.rint(vertices[edges] * (1 << _SHIFT)).astype(np.int32)
    cv2.polylines(blank, list(segments), False, 0, 1, cv2.LINE_8, _SHIFT)
    return np.asarray(cv2.distanceTransform(blank, cv2.DIST_L2, cv2.DIST_MASK_5), np.float32)


def _longest_run(flags: NDArray[np.bool_]) -> int:
    """Length of the longest stretch of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(np.int8), [0]])))
    return int((edges[1::2] - edges[::2]).max(initial=0))
