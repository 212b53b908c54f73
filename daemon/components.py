"""The connected pieces of a mask of any size: large masks are labelled in bands, whose labels never exist at once."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, TypeVar

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.ink import Mask

Indices = NDArray[np.intp]
Value = TypeVar("Value", bound=np.generic)

_AT_ONCE_PX = 1 << 22


@dataclass(frozen=True, slots=True, eq=False)
class Components:
    """Row i of `stats` (N, 5: left, top, width, height, area) and of `centres` (N, 2) is of the piece labelled i.

    Row 0 is of what is no piece, and means nothing. Labels are those of OpenCV.
    """

    stats: Indices
    centres: NDArray[np.float64]
    _mask: Mask
    _names: list[Indices]
    _labels: NDArray[np.int32] | None

    def mapped(self, values: NDArray[Value]) -> NDArray[Value]:
        """(H, W): at each pixel the value of its piece. values: (N,)."""
        found = np.empty(self._mask.shape, values.dtype)
        for rows, labels in self._bands():
            found[rows] = values[labels]
        return found

    def at(self, y: Indices, x: Indices) -> Indices:
        """The labels of pixels."""
        found = np.zeros(len(y), np.intp)
        for rows, labels in self._bands():
            here = np.flatnonzero((y >= rows.start) & (y < rows.stop))
            found[here] = labels[y[here] - rows.start, x[here]]
        return found

    def piece(self, label: int) -> Mask:
        """The piece alone, in its box."""
        left, top, width, height = self.stats[label, :4].tolist()
        inside = np.ascontiguousarray(self._mask[top : top + height, left : left + width])
        _, labels, stats, _ = cv2.connectedComponentsWithStats(inside.view(np.uint8), connectivity=8)
        # Two pieces that both reach all four sides of one box would meet.
        (own,) = np.flatnonzero((stats[1:, 2:4] == (width, height)).all(axis=1)) + 1
        return np.asarray(labels == own)

    def _bands(self) -> Iterator[tuple[slice, NDArray[Any]]]:
        if self._labels is not None:
            yield slice(0, len(self._mask)), self._labels
            return
        for rows, names in zip(_bands_of(self._mask), self._names, strict=True):
            yield rows, names[cv2.connectedComponents(self._mask[rows].view(np.uint8), connectivity=8)[1]]


def components(mask: Mask) -> Components:
    """The pieces of a mask, pixels that touch by a corner taken together. mask: bool (H, W)."""
    if mask.size <= _AT_ONCE_PX:
        _, labels, stats, centres = cv2.connectedComponentsWithStats(mask.view(np.uint8), connectivity=8)
        middles, names = np.asarray(centres, np.float64), np.asarray(labels, np.int32)
        return Components(stats.astype(np.intp), middles, mask, [], names)
    return _in_bands(mask)


def _bands_of(mask: Mask) -> list[slice]:
    """An even number of rows each: OpenCV names pieces by their first block of two by two pixels."""
    height, width = mask.shape
    rows = max(2, _AT_ONCE_PX // width // 2 * 2)
    return [slice(top, min(height, top + rows)) for top in range(0, height, rows)]


def _in_bands(mask: Mask) -> Components:
    starts, parts, pairs = [0], [], [np.empty((0, 2), np.intp)]
    above = np.zeros(mask.shape[1], np.intp)
    for rows in _bands_of(mask):
        count, labels, stats, centres = cv2.connectedComponentsWithStats(mask[rows].view(np.uint8), connectivity=8)
        sums = np.rint(centres * stats[:, 4:]) + stats[:, 4:] * np.array([0, rows.start])
        parts.append(np.hstack([stats + np.array([0, rows.start, 0, 0, 0]), sums])[1:])
        first, last = (np.where(labels[row] > 0, labels[row] + starts[-1], 0).astype(np.intp) for row in (0, -1))
        pairs.append(_touching(above, first))
        above = last
        starts.append(starts[-1] + count - 1)
    roots = _roots(starts[-1] + 1, np.unique(np.concatenate(pairs), axis=0))
    first_of, names = np.unique(roots, return_inverse=True)
    stats, middles = _merged(np.concatenate(parts), names.reshape(-1)[1:], len(first_of))
    of_band = [np.append(0, names[start + 1 : end + 1]) for start, end in pairwise(starts)]
    return Components(stats, middles, mask, of_band, None)


def _touching(above: Indices, below: Indices) -> Indices:
    """The pairs of labels of two rows that touch, (P, 2)."""
    beside = [np.stack([above[max(0, -d) : len(above) - max(0, d)], below[max(0, d) : len(below) + min(0, d)]], axis=1)
              for d in (-1, 0, 1)]  # fmt: skip
    pairs = np.concatenate(beside)
    return np.unique(pairs[(pairs > 0).all(axis=1)], axis=0)


def _roots(count: int, pairs: Indices) -> Indices:
    """For each label the least of those that it is one piece with."""
    parent = list(range(count))

    def root(label: int) -> int:
        while parent[label] != label:
            parent[label] = parent[parent[label]]
            label = parent[label]
        return label

    for a, b in pairs.tolist():
        one, other = sorted((root(a), root(b)))
        parent[other] = one
    return np.array([root(label) for label in range(count)], np.intp)


def _merged(parts: NDArray[np.float64], names: Indices, count: int) -> tuple[Indices, NDArray[np.float64]]:
    """Stats and centres of the pieces. parts: (P, 7), of each band's pieces left, top, width, height, area, sums."""
    low, high = np.full((count, 2), np.inf), np.zeros((count, 2))
    sums = np.zeros((count, 3))
    np.minimum.at(low, names, parts[:, :2])
    np.maximum.at(high, names, parts[:, :2] + parts[:, 2:4])
    np.add.at(sums, names, parts[:, 4:])
    low[0], sums[0, 0] = 0, 1
    return np.hstack([low, high - low, sums[:, :1]]).astype(np.intp), sums[:, 1:] / sums[:, :1]
