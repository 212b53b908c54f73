"""Ink that no edge covers yet, and the lines that fill it."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.bands import bands
from daemon.components import components
from daemon.graph.anchors import anchored
from daemon.graph.skeleton import Indices, chain_points, chains, thinned
from daemon.ink import Mask
from daemon.shapes import Points

_BESIDE_PX = 1.0
"""Ink so near to the drawn line's own is its rim: a pen is never exactly as wide as stated."""
_LEAST_WIDTHS = 1.5
"""What is left and no longer than this many line widths is the rounding of a corner."""
_ROUNDS = 3
_SHIFT = 4
_SMOOTHED = np.array([0.25, 0.5, 0.25])


def fillings(ink: Mask, polylines: Sequence[Points], *, width_px: float) -> tuple[list[Points], Indices, Points]:
    """Lines through the ink that the given ones leave bare, where lines have melted into an area.

    ink: bool (H, W). polylines: (N, 2) each. width_px: of the pen. The middle of what is bare is drawn, and once more
    what is bare still, three rounds at most: a filled area is hatched as far as that goes. Returns the new polylines,
    their ends (E, 2) and vertices (V, 2).
    """
    new: list[Points] = []
    ends, vertices = [np.empty((0, 2), np.intp)], [np.empty((0, 2))]
    for _ in range(_ROUNDS):
        bare = uncovered(ink, [*polylines, *new], width_px=width_px)
        if not bare.any():
            break
        skeleton = thinned(bare, shortest_spur_px=width_px / 2)
        nodes = anchored(skeleton, np.empty((0, 2)), (ink.shape[0], ink.shape[1]), width_px=1.0)
        found = [chain for chain in chains(skeleton, nodes.owners) if chain.path]
        first = sum(map(len, vertices))
        ends.append(first + np.array([(chain.start, chain.end) for chain in found], np.intp).reshape(-1, 2))
        new += [_smoothed(chain_points(skeleton, chain, nodes.vertices)) for chain in found]
        vertices.append(nodes.vertices)
    return new, np.concatenate(ends), np.concatenate(vertices)


def tied(
    polylines: list[Points], ends: Indices, others: Indices, vertices: Points, *, within_px: float
) -> tuple[list[Points], Indices]:
    """The polylines led on to vertices near their loose ends.

    ends, others: (E, 2) vertices of the polylines and of all other edges. Of the vertices in which an odd number of
    other edges end the nearest takes a loose end, each one, for that saves a lift of the pen. A polyline that would
    hang on nothing is led to any vertex.
    """
    degrees = np.bincount(others.ravel(), minlength=len(vertices))
    free, used = degrees % 2 == 1, degrees > 0
    loose = np.bincount(ends.ravel(), minlength=len(vertices))[ends] == 1
    longer, tied_ends = list(polylines), ends.copy()

    def tie(index: int, side: int, to: NDArray[np.bool_]) -> bool:
        away = np.where(to, np.hypot(*(vertices - vertices[ends[index, side]]).T), np.inf)
        away[tied_ends[index, 1 - side]] = np.inf
        vertex = int(away.argmin())
        if away[vertex] > within_px:
            return False
        free[vertex] = False
        tied_ends[index, side] = vertex
        longer[index] = np.insert(longer[index], side * len(longer[index]), vertices[vertex], axis=0)
        return True

    hanging = set(np.flatnonzero(loose.all(axis=1)).tolist())
    hanging -= {index for index, side in np.argwhere(loose).tolist() if tie(index, side, free)}
    for index in sorted(hanging):
        tie(index, 0, used)
    return longer, tied_ends


def uncovered(ink: Mask, polylines: Sequence[Points], *, width_px: float) -> Mask:
    """Ink beside all lines and their rims, small remains left out. Returns bool (H, W)."""
    blank = np.ones(ink.shape, np.uint8)
    segments = [np.rint(polyline * (1 << _SHIFT)).astype(np.int32) for polyline in polylines]
    cv2.polylines(blank, segments, False, 0, 1, cv2.LINE_8, _SHIFT)
    beside_px = width_px / 2 + _BESIDE_PX
    bare = ink.copy()
    for band in bands(len(ink), halo_px=beside_px + 1):
        away = cv2.distanceTransform(blank[band.seen], cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
        bare[band.own] &= away[band.own_of_seen] > beside_px
    pieces = components(bare)
    large = pieces.stats[:, 2:4].max(axis=1) > _LEAST_WIDTHS * width_px
    large[0] = False
    return pieces.mapped(large)


def _smoothed(polyline: Points) -> Points:
    """The steps of the pixel raster taken out; ends stay."""
    smooth = polyline.copy()
    for _ in range(2):
        for axis in (0, 1):
            smooth[1:-1, axis] = np.convolve(smooth[:, axis], _SMOOTHED, "valid")
    return smooth
