"""An open tour through segments that may be walked either way, made shorter by 2-opt and Or-opt."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Codes: TypeAlias = NDArray[np.int64]
"""Segments in order: 2 i where segment i is walked forwards, 2 i + 1 where it is walked backwards."""
Place: TypeAlias = NDArray[np.float64]

_PAIRS = 200_000_000
"""Pairs of links looked at in all; it bounds the time whatever the number of segments."""
_SWEEPS = 30
_LONGEST_MOVED = 3
_LEAST_GAIN = 1e-9


def improve(ends: NDArray[np.float64], *, start: Place, end: Place) -> Codes:
    """The tour 0, 1, 2, ... made shorter until no move helps or the work is up.

    ends: (N, 2, 2) float64, both ends of each segment as (x, y). start, end: (2,) where the tour begins and ends.
    Returns (N,) int64 codes. Never longer than the given tour, and the same for the same input. Cost O(N^2) a sweep,
    bounded by a window of links for large N.
    """
    tour = _Tour(ends, start, end)
    window = max(64, _PAIRS // (len(ends) * 4 * (_LONGEST_MOVED + 1) + 1))
    sweeps = min(_SWEEPS, max(1, _PAIRS // (len(ends) * min(window, len(ends)) * 8 + 1)))
    for _ in range(sweeps):
        reversed_some = _two_opt(tour, window)
        if not _or_opt(tour, window) and not reversed_some:
            break
    return tour.codes


class _Tour:
    """Link k leads from `leave[k]` to `arrive[k]`: from the start, or segment k - 1, to segment k, or the end."""

    __slots__ = ("_doors", "_end", "_start", "arrive", "codes", "leave", "links")

    def __init__(self, ends: NDArray[np.float64], start: Place, end: Place) -> None:
        self._doors = ends.reshape(-1, 2)
        self._start, self._end = start[None], end[None]
        self.set(2 * np.arange(len(ends), dtype=np.int64))

    def set(self, codes: Codes) -> None:
        self.codes = codes
        self.leave = np.concatenate([self._start, self._doors[codes ^ 1]])
        self.arrive = np.concatenate([self._doors[codes], self._end])
        self.links = _far(self.leave, self.arrive)


def _far(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    off = a - b
    distance: NDArray[np.float64] = np.sqrt((off * off).sum(axis=-1))
    return distance


def _two_opt(tour: _Tour, window: int) -> bool:
    """Walk a run of segments backwards where that is shorter: links i and k are replaced."""
    improved = False
    for i in range(len(tour.codes)):
        to = slice(i + 1, i + 1 + window)
        new = _far(tour.leave[to], tour.leave[i]) + _far(tour.arrive[to], tour.arrive[i])
        gain = tour.links[i] + tour.links[to] - new
        best = int(np.argmax(gain))
        if gain[best] > _LEAST_GAIN:
            k = i + 1 + best
            codes = tour.codes.copy()
            codes[i:k] = codes[i:k][::-1] ^ 1
            tour.set(codes)
            improved = True
    return improved


def _or_opt(tour: _Tour, window: int) -> bool:
    """Move one to three segments into another link, either way round."""
    improved = False
    for count in range(1, _LONGEST_MOVED + 1):
        for i in range(len(tour.codes) - count + 1):
            improved |= _move(tour, i, i + count, window)
    return improved


def _move(tour: _Tour, i: int, j: int, window: int) -> bool:
    """Move segments i to j - 1 into the best link within the window, if that is shorter."""
    saved = tour.links[i] + tour.links[j] - _far(tour.leave[i], tour.arrive[j])
    if saved <= _LEAST_GAIN:
        return False
    low, high = max(0, i - window), min(len(tour.links), j + window)
    first, last = tour.arrive[i], tour.leave[j]
    leave, arrive = tour.leave[low:high], tour.arrive[low:high]
    detour = np.stack([_far(leave, first) + _far(arrive, last), _far(leave, last) + _far(arrive, first)])
    detour -= tour.links[low:high]
    detour[:, i - low : j - low + 1] = np.inf
    best = int(np.argmin(detour))
    backwards, k = best // (high - low) == 1, best % (high - low) + low
    if saved - detour.flat[best] <= _LEAST_GAIN:
        return False
    moved = tour.codes[i:j][::-1] ^ 1 if backwards else tour.codes[i:j]
    rest = np.delete(tour.codes, np.s_[i:j])
    at = k if k < i else k - (j - i)
    tour.set(np.concatenate([rest[:at], moved, rest[at:]]))
    return True
