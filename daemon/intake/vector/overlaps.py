"""Lines that lie on each other are drawn once."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from daemon.intake.vector.common import kept_parts
from daemon.shapes import Points

WITHIN_MM = 0.02
_SLANT = 0.05
"""Sine of the angle up to which two segments may lie on each other."""
_SHORT_MM = 3 * WITHIN_MM
"""What an overlap leaves of a line and is shorter than this goes with it."""
_CELL_MM = 2.0
_MOST_CELLS = 250_000
_MOST_IN_A_CELL = 600
_PAIRS_AT_ONCE = 1_000_000


def drawn_once(lines: Sequence[Points]) -> list[Points]:
    """The lines without those parts that an earlier one covers, in mm; dots that repeat go, too.

    Two segments cover each other where they run side by side, within WITHIN_MM and nearly parallel. A place so crowded
    that more than some hundred segments pass one square of a few mm is left as it is.
    """
    longer = [line for line in lines if len(line) > 1]
    dots = {tuple(np.round(line[0], 2).tolist()): line for line in lines if len(line) == 1}
    ends = np.concatenate([np.empty((0, 4)), *(np.hstack([line[:-1], line[1:]]) for line in longer)])
    covered = _covered(ends)
    found: list[Points] = []
    first = 0
    for line in longer:
        count = len(line) - 1
        if any(index in covered for index in range(first, first + count)):
            lengths = np.hypot(*np.diff(line, axis=0).T)
            left = kept_parts(line, [_left(covered.get(first + k, []), lengths[k]) for k in range(count)])
            found += [part for part in left if float(np.hypot(*np.diff(part, axis=0).T).sum()) > _SHORT_MM]
        else:
            found.append(line)
        first += count
    return found + list(dots.values())


def _left(covered: list[tuple[float, float]], length_mm: float) -> list[tuple[float, float]]:
    """The shares of a segment that nothing covers."""
    if not covered:
        return [(0.0, 1.0)]
    found, at = [], 0.0
    for a, b in [*sorted(covered), (1.0, 1.0)]:
        if (a - at) * length_mm > _SHORT_MM:
            found.append((at, a))
        at = max(at, b)
    return found


def _covered(ends: NDArray[np.float64]) -> dict[int, list[tuple[float, float]]]:
    """By segment, the shares of it that lie on an earlier one. ends: (S, 4), two points a row."""
    covered: dict[int, list[tuple[float, float]]] = defaultdict(list)
    done: set[int] = set()
    for earlier, later in _neighbours(ends):
        low, high = _on(ends[earlier], ends[later])
        length = np.hypot(ends[later, 2] - ends[later, 0], ends[later, 3] - ends[later, 1])
        hit = (high - low) * length > np.minimum(WITHIN_MM, length / 2)
        for i, j, a, b in zip(earlier[hit].tolist(), later[hit].tolist(), low[hit], high[hit], strict=True):
            if (key := i * len(ends) + j) not in done:
                done.add(key)
                covered[j].append((float(a), float(b)))
    return covered


def _on(a: NDArray[np.float64], b: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """From which share to which each segment of b runs along that of a; the second is smaller where it does not."""
    along, own = a[:, 2:] - a[:, :2], b[:, 2:] - b[:, :2]
    length, own_length = np.hypot(*along.T), np.hypot(*own.T)
    unit = along / np.maximum(length, 1e-12)[:, None]
    from_a = b[:, :2] - a[:, :2]
    beside, beside_step = _cross(unit, from_a), _cross(unit, own)
    ahead, ahead_step = (unit * from_a).sum(axis=1), (unit * own).sum(axis=1)
    low_1, high_1 = _between(beside, beside_step, -WITHIN_MM, np.full_like(length, WITHIN_MM))
    low_2, high_2 = _between(ahead, ahead_step, 0.0, length)
    low, high = np.maximum(0.0, np.maximum(low_1, low_2)), np.minimum(1.0, np.minimum(high_1, high_2))
    slanted = (np.abs(beside_step) > _SLANT * own_length) | (length == 0) | (own_length == 0)
    return np.where(slanted, 1.0, low), np.where(slanted, 0.0, high)


def _cross(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def _between(
    at: NDArray[np.float64], step: NDArray[np.float64], least: float, most: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The t from 0 to 1 for which at + t * step lies between two numbers."""
    level = np.abs(step) < 1e-12
    safe = np.where(level, 1.0, step)
    one, other = (least - at) / safe, (most - at) / safe
    inside = (at >= least) & (at <= most)
    low = np.where(level, np.where(inside, 0.0, 1.0), np.minimum(one, other))
    high = np.where(level, np.where(inside, 1.0, 0.0), np.maximum(one, other))
    return low, high


def _neighbours(ends: NDArray[np.float64]) -> Iterator[tuple[NDArray[np.intp], NDArray[np.intp]]]:
    """Pairs of segments that pass one square of a grid, the earlier first; some at a time, some more than once."""
    cells, segments = _cells(ends)
    order = np.lexsort((segments, cells))
    cells, segments = cells[order], segments[order]
    starts = np.flatnonzero(np.r_[True, cells[1:] != cells[:-1]]) if len(cells) else np.empty(0, np.intp)
    counts = np.diff(np.r_[starts, len(cells)])
    some: list[tuple[NDArray[np.intp], NDArray[np.intp]]] = []
    pairs = 0
    for start, count in zip(starts[counts > 1].tolist(), counts[counts > 1].tolist(), strict=True):
        if count > _MOST_IN_A_CELL:
            continue
        i, j = np.triu_indices(count, 1)
        here = segments[start : start + count]
        some.append((here[i], here[j]))
        pairs += len(i)
        if pairs > _PAIRS_AT_ONCE:
            yield _together(some)
            some, pairs = [], 0
    if some:
        yield _together(some)


def _together(some: list[tuple[NDArray[np.intp], NDArray[np.intp]]]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    return np.concatenate([i for i, _ in some]), np.concatenate([j for _, j in some])


def _cells(ends: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.intp]]:
    """The squares that each segment passes, with some room beside it: (M,) keys and (M,) segments, each pair once."""
    lengths = np.hypot(ends[:, 2] - ends[:, 0], ends[:, 3] - ends[:, 1])
    cell_mm = max(_CELL_MM, float(lengths.sum()) / _MOST_CELLS)
    counts = np.ceil(lengths / (cell_mm / 2)).astype(np.intp) + 1
    owner = np.repeat(np.arange(len(ends)), counts)
    share = (np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)) / np.maximum(1, counts[owner] - 1)
    points = ends[owner, :2] + share[:, None] * (ends[owner, 2:] - ends[owner, :2])
    keys = []
    for dx, dy in ((-1, -1), (-1, 1), (1, -1), (1, 1)):
        cell = np.floor((points + WITHIN_MM * np.array([dx, dy])) / cell_mm).astype(np.int64)
        keys.append((cell[:, 0] + 2**20) * 2**22 + cell[:, 1] + 2**20)
    both = np.unique(np.stack([np.concatenate(keys), np.tile(owner, 4)], axis=1), axis=0)
    return both[:, 0], both[:, 1].astype(np.intp)
