"""Where on a picture something is missing or too much."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from daemon.bands import bands
from daemon.ink import Mask

MOST = 100
"""A report names no more places than this, the largest."""

Whole = NDArray[np.intp]


@dataclass(frozen=True, slots=True)
class Place:
    """A connected component: its box in px of the picture, and how many pixels it has."""

    left_px: int
    top_px: int
    width_px: int
    height_px: int
    area_px: int


def places(mask: Mask, *, longer_than_px: float) -> tuple[Place, ...]:
    """The components of a mask that are longer than that in one direction, largest first, at most a hundred.

    mask: bool (H, W). A component holds pixels that touch by a side or a corner. Found on the runs of its rows: what
    is missing is little, and the labels of a whole page are large.
    """
    rows, starts, ends = _runs(mask)
    if not len(rows):
        return ()
    names = _named(rows, starts, ends, mask.shape[1] + 1)
    order = np.argsort(names, kind="stable")
    first = np.flatnonzero(np.diff(names[order], prepend=-1))
    low_x, low_y = (np.minimum.reduceat(values[order], first) for values in (starts, rows))
    high_x, high_y = (np.maximum.reduceat(values[order], first) for values in (ends, rows + 1))
    areas = np.add.reduceat((ends - starts)[order], first)
    boxes = np.stack([low_x, low_y, high_x - low_x, high_y - low_y, areas], axis=1)
    long = boxes[boxes[:, 2:4].max(axis=1) > longer_than_px]
    largest: Sequence[Sequence[int]] = long[np.argsort(-long[:, 4], kind="stable")][:MOST].tolist()
    return tuple(Place(*row) for row in largest)


def _runs(mask: Mask) -> tuple[Whole, Whole, Whole]:
    """The runs of True in each row, top to bottom: their row, first column and the column behind the last."""
    found = [np.empty((3, 0), np.intp)]
    for band in bands(len(mask)):
        framed = np.pad(mask[band.own], ((0, 0), (1, 1)))
        rows, columns = np.nonzero(framed[:, 1:] != framed[:, :-1])
        found.append(np.stack([rows[::2] + band.own.start, columns[::2], columns[1::2]]))
    rows, starts, ends = np.concatenate(found, axis=1)
    return rows, starts, ends


def _named(rows: Whole, starts: Whole, ends: Whole, stride: int) -> Whole:
    """For each run the number of the first run of its component: the least number spreads over runs that touch."""
    places, stops = rows * stride + starts, rows * stride + ends
    low, high = np.searchsorted(stops, places + stride), np.searchsorted(places, stops + stride, side="right")
    counts = high - low
    above = np.repeat(np.arange(len(rows)), counts)
    below = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts) + np.repeat(low, counts)
    names = np.arange(len(rows))
    while True:
        least = np.minimum(names[above], names[below])
        spread = names.copy()
        for runs in (names[above], names[below]):
            np.minimum.at(spread, runs, least)
        spread = spread[spread]
        if np.array_equal(spread, names):
            return names
        names = spread
