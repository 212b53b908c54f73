"""Four straight edges that may be the sides of a sheet, found wherever tone changes along a line."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import cv2
import numpy as np

from daemon.page.sides import Side, around
from daemon.shapes import Grey, Points

_MOST_LINES = 14
_ALIKE_DEGREES, _ALIKE_PX = 5.0, 7.0
_LEAST_VOTES = 0.15
_PARALLEL_DEGREES, _ACROSS_DEGREES = 35.0, 50.0
_MARGIN = 0.06
"""So far outside the picture, as a share of its side, a corner may lie."""


def quads(bare: Grey, *, least_px: float) -> Iterator[list[Side]]:
    """Quadrangles of edges (Hough 1962), the largest first, each as four sides clockwise.

    bare: the picture made small, its lines closed away. least_px: area of the smallest.
    """
    lines = _lines(bare)
    pairs = [pair for pair in combinations(range(len(lines)), 2) if _turned(lines, *pair) <= _PARALLEL_DEGREES]
    found = []
    for (a, b), (c, d) in combinations(pairs, 2):
        if len({a, b, c, d}) < 4 or min(_turned(lines, p, q) for p in (a, b) for q in (c, d)) < _ACROSS_DEGREES:
            continue
        corners = np.array([_crossing(lines[p], lines[q]) for p, q in ((a, c), (c, b), (b, d), (d, a))])
        area = abs(cv2.contourArea(corners.astype(np.float32)))
        if area >= least_px and _within(corners, bare.shape) and cv2.isContourConvex(corners.astype(np.float32)):
            found.append((area, corners))
    for _, corners in sorted(found, key=lambda each: -each[0]):
        yield around(corners)


def _lines(bare: Grey) -> Points:
    """(N, 2): angle and distance of the lines with the most votes, each once."""
    # A step is seen in proportion to the light that falls on it.
    shade = np.asarray(np.clip(46.0 * np.log(np.arange(256) + 1.0), 0, 255), np.uint8)[bare]
    edges = cv2.Canny(shade, 18, 40, L2gradient=True)
    votes = int(_LEAST_VOTES * min(bare.shape))
    lines = cv2.HoughLines(edges, 1, np.pi / 180, votes)
    kept: list[tuple[float, float]] = []
    for rho, theta in () if lines is None else lines[:200, 0].tolist():
        if not any(_alike((rho, theta), other) for other in kept):
            kept.append((rho, theta))
        if len(kept) == _MOST_LINES:
            break
    return np.array(kept, float).reshape(-1, 2)


def _alike(one: tuple[float, float], other: tuple[float, float]) -> bool:
    (rho, theta), (rho_2, theta_2) = one, other
    if abs(theta - theta_2) > np.pi / 2:  # The same line, seen from its other side.
        rho_2, theta_2 = -rho_2, theta_2 + (np.pi if theta_2 < theta else -np.pi)
    return abs(theta - theta_2) < np.radians(_ALIKE_DEGREES) and abs(rho - rho_2) < _ALIKE_PX


def _turned(lines: Points, one: int, other: int) -> float:
    turned = abs(lines[one, 1] - lines[other, 1]) % np.pi
    return float(np.degrees(min(turned, np.pi - turned)))


def _crossing(one: Points, other: Points) -> Points:
    normals = np.array([[np.cos(one[1]), np.sin(one[1])], [np.cos(other[1]), np.sin(other[1])]])
    return np.asarray(np.linalg.solve(normals, [one[0], other[0]]))


def _within(corners: Points, shape: tuple[int, ...]) -> bool:
    size = np.array(shape[1::-1])
    return bool(np.all((corners > -_MARGIN * size) & (corners < (1 + _MARGIN) * size)))
