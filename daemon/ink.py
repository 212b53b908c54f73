"""The ink of a page: which pixels are inked, and the centre line of that ink."""

from __future__ import annotations

from typing import TypeAlias

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.bands import bands
from daemon.remembered import remembered
from daemon.shapes import Grey

Mask: TypeAlias = NDArray[np.bool_]
"""(H, W) bool, True = ink."""

LEAST_CONTRAST = 24.0
"""Grey levels by which ink is darker than paper; less is dirt, grain or a shadow."""
_NOISES = 5.0
"""Ink is also darker than paper by this many standard deviations of the paper's grain."""

_INK, _TOLD = 1, 3
_LOOK_PX = 1 << 20

# The eight neighbours of a pixel, clockwise from north, as (dy, dx); neighbour i is bit i of a neighbourhood code.
_AROUND = ((-1, 0), (-1, 1), (0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1))


def ink_mask(grey: Grey) -> Mask:
    """Which pixels are ink: darker than half way between the paper and the ink of this page.

    grey: uint8 (H, W), dark ink on light paper. Returns bool (H, W); nowhere True when the page is one tone, however
    dark, or holds nothing but grain. Otsu's threshold (1979) only finds the paper, because it cuts through the grain
    of a page that is nearly empty; the ink is the darkest quarter of what is clearly no paper, because the rest may be
    the pale rims of thin lines.
    """
    threshold = ink_threshold(grey)
    return np.zeros(grey.shape, bool) if threshold is None else grey <= threshold


@remembered
def ink_threshold(grey: Grey) -> float | None:
    """Grey level at and below which a pixel is ink, None where the page holds none. See `ink_mask`."""
    if grey.size == 0:
        return None
    histogram = np.zeros(256)
    # A band at a time: OpenCV counts in float32, which is exact up to 2 ** 24.
    for band in bands(len(grey)):
        histogram += cv2.calcHist([grey[band.own]], [0], None, [256], [0, 256]).ravel()
    paper, grain = _paper(histogram, _otsu(histogram))
    darkness = np.where(np.arange(256) < paper - max(LEAST_CONTRAST, _NOISES * grain), histogram, 0.0).cumsum()
    if not darkness[-1]:
        return None
    return (paper + float(np.searchsorted(darkness, darkness[-1] / 4))) / 2


def thin(mask: Mask) -> Mask:
    """The centre line of ink, one pixel wide and connected as the ink was (Guo and Hall 1989, algorithm A1).

    mask: bool (H, W). Returns bool (H, W), a subset of it: an 8-connected line for a line, one pixel for a dot, a
    ring for a ring. Parallel in two alternating passes; only pixels whose surroundings changed are looked at again.
    """
    ink = np.pad(mask.view(np.uint8), 1)
    flat, codes = ink.reshape(-1), _codes(ink).reshape(-1)
    steps = [dy * ink.shape[1] + dx for dy, dx in _AROUND]
    now = later = _rim(flat, codes)
    even = 0
    while now.size or later.size:
        removed = now[_REMOVABLE[even][codes[now]]]
        changed = _remove(removed, flat, codes, steps)
        now, later = np.concatenate([later[flat[later] == _INK], changed]), changed
        flat[changed] = _INK
        even = 1 - even
    del codes
    return np.ascontiguousarray(ink[1:-1, 1:-1]).view(np.bool_)


def _otsu(histogram: NDArray[np.float64]) -> int:
    """The level that splits a histogram into two classes with the greatest variance between them."""
    levels = np.arange(256.0)
    below, mass = np.cumsum(histogram), np.cumsum(histogram * levels)
    above = below[-1] - below
    with np.errstate(divide="ignore", invalid="ignore"):
        between = (mass[-1] * below - mass * below[-1]) ** 2 / (below * above)
    return int(np.nanargmax(np.where(above > 0, between, -1.0)))


def _paper(histogram: NDArray[np.float64], split: int) -> tuple[float, float]:
    """Grey level of the paper and the standard deviation of its grain, from the class above the split."""
    light = np.cumsum(np.where(np.arange(256) > split, histogram, 0.0))
    if light[-1] == 0:
        light = np.cumsum(histogram)
    middle, bright = np.searchsorted(light, [0.5 * light[-1], 0.95 * light[-1]])
    # 95 % of a normal distribution lie below 1.64 deviations; 1.3 allows for a split in the middle of the grain.
    return float(middle), float(bright - middle) / 1.3


def _codes(ink: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """For each pixel which of its eight neighbours are ink, one bit each."""
    weights = np.zeros((3, 3), np.float32)
    for bit, (dy, dx) in enumerate(_AROUND):
        weights[1 + dy, 1 + dx] = 1 << bit
    return np.asarray(cv2.filter2D(ink, cv2.CV_8U, weights, borderType=cv2.BORDER_CONSTANT), np.uint8)


def _rim(flat: NDArray[np.uint8], codes: NDArray[np.uint8]) -> NDArray[np.intp]:
    """The places of the ink that does not lie in the midst of ink."""
    starts = range(0, flat.size, _LOOK_PX)
    parts = [np.flatnonzero(flat[s : s + _LOOK_PX] & (codes[s : s + _LOOK_PX] != 255)) + s for s in starts]
    return np.concatenate([np.empty(0, np.intp), *parts])


def _remove(
    pixels: NDArray[np.intp], flat: NDArray[np.uint8], codes: NDArray[np.uint8], steps: list[int]
) -> NDArray[np.intp]:
    """Take pixels off the ink, tell their neighbours, and return the inked neighbours, each once and marked as told."""
    flat[pixels] = 0
    told = []
    for bit, step in enumerate(steps):
        neighbours = pixels + step
        codes[neighbours] &= np.uint8(255 ^ (1 << (bit + 4) % 8))
        fresh = neighbours[flat[neighbours] == _INK]
        flat[fresh] = _TOLD
        told.append(fresh)
    return np.concatenate(told)


def _removable() -> NDArray[np.bool_]:
    """(2, 256): may a pixel with this neighbourhood code go in the odd (0), in the even (1) pass."""
    n, ne, e, se, s, sw, w, nw = ((np.arange(256) >> bit & 1).astype(bool) for bit in range(8))
    runs = (~n & (ne | e)).astype(int) + (~e & (se | s)) + (~s & (sw | w)) + (~w & (nw | n))
    pairs = (nw | n).astype(int) + (ne | e) + (se | s) + (sw | w)
    other_pairs = (n | ne).astype(int) + (e | se) + (s | sw) + (w | nw)
    neighbours = np.minimum(pairs, other_pairs)
    border = (runs == 1) & (neighbours >= 2) & (neighbours <= 3)
    return np.stack([border & ~((n | ne | ~se) & e), border & ~((s | sw | ~nw) & w)])


_REMOVABLE = _removable()
