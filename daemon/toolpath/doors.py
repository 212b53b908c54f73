"""The nearest of many places for each of them, found cell by cell."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

_A_CELL = 24


Near: TypeAlias = list[tuple[int, float]]
"""Doors and how far they are, nearest first."""


def nearest_doors(doors: NDArray[np.float64], count: int) -> list[Near]:
    """For each door up to `count` doors of other segments, nearest first.

    doors: (2 N, 2); doors 2 i and 2 i + 1 are the ends of one segment. Looked for in a door's own cell and the eight
    around it, about 24 doors a cell: time grows with N, and where doors lie unevenly a few neighbours may be missed.
    """
    cells, side = _cells(doors)
    order = np.argsort(cells, kind="stable")
    bounds = np.searchsorted(cells[order], np.arange(side * side + 1))
    near: list[Near] = [[] for _ in doors]
    for cell in np.unique(cells).tolist():
        around = _around(cell, side)
        others = np.concatenate([order[bounds[c] : bounds[c + 1]] for c in around])
        mine = order[bounds[cell] : bounds[cell + 1]]
        for door, some in zip(mine.tolist(), _ranked(doors, mine, others, count), strict=True):
            near[door] = some
    return near


def _cells(doors: NDArray[np.float64]) -> tuple[NDArray[np.int64], int]:
    """The cell of each door and how many cells a side has."""
    side = max(1, int(np.sqrt(len(doors) / _A_CELL)))
    low, high = doors.min(axis=0), doors.max(axis=0)
    place = ((doors - low) / np.maximum(high - low, 1e-9) * side).astype(np.int64)
    column, row = np.minimum(place, side - 1).T
    return row * side + column, side


def _around(cell: int, side: int) -> list[int]:
    row, column = divmod(cell, side)
    rows, columns = range(max(0, row - 1), min(side, row + 2)), range(max(0, column - 1), min(side, column + 2))
    return [r * side + c for r in rows for c in columns]


def _ranked(doors: NDArray[np.float64], mine: NDArray[np.intp], others: NDArray[np.intp], count: int) -> list[Near]:
    """For each of my doors the nearest of the others, those of its own segment left out."""
    off = doors[mine][:, None] - doors[others]
    squared = np.where((mine[:, None] >> 1) == (others >> 1), np.inf, (off * off).sum(axis=2))
    ranks = np.argsort(squared, axis=1, kind="stable")[:, :count]
    away = np.sqrt(np.take_along_axis(squared, ranks, axis=1))
    known = np.isfinite(away)
    return [
        list(zip(others[rank[some]].tolist(), far[some].tolist(), strict=True))
        for rank, far, some in zip(ranks, away, known, strict=True)
    ]
