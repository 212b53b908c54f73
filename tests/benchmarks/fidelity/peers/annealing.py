"""A short tour through strokes by simulated annealing: JSON list of sets of ends in, their best pen-up lengths out.

Runs in the peers' virtual environment. A set is [[[x, y], [x, y]], ...], begin and end of each stroke; the tour starts
and ends at (0, 0). 2-opt and Or-opt moves, geometric cooling, the best of six runs (Kirkpatrick et al. 1983).
"""

from __future__ import annotations

import json
import math
import sys

import numpy as np
from numba import njit

MOVES = 20_000_000
RUNS = 6


@njit(cache=True)
def far(ends: np.ndarray, a: int, a_end: int, b: int, b_end: int) -> float:
    return math.hypot(ends[a, a_end, 0] - ends[b, b_end, 0], ends[a, a_end, 1] - ends[b, b_end, 1])


@njit(cache=True)
def length(ends: np.ndarray, tour: np.ndarray) -> float:
    total = 0.0
    for i in range(len(tour) - 1):
        total += far(ends, tour[i] >> 1, 1 - (tour[i] & 1), tour[i + 1] >> 1, tour[i + 1] & 1)
    return total


@njit(cache=True)
def turned(tour: np.ndarray, first: int, last: int) -> None:
    """That part of the tour backwards, every stroke from its other end."""
    while first < last:
        tour[first], tour[last] = tour[last] ^ 1, tour[first] ^ 1
        first += 1
        last -= 1
    if first == last:
        tour[first] ^= 1


@njit(cache=True)
def shifted(tour: np.ndarray, first: int, last: int, to: int) -> None:
    """That part of the tour taken out and put in again behind what is at `to`, outside of it."""
    part = tour[first : last + 1].copy()
    if to > last:
        tour[first : first + to - last] = tour[last + 1 : to + 1].copy()
        tour[to - len(part) + 1 : to + 1] = part
    else:
        tour[to + 1 + len(part) : last + 1] = tour[to + 1 : first].copy()
        tour[to + 1 : to + 1 + len(part)] = part


@njit(cache=True)
def joint(ends: np.ndarray, a: int, b: int) -> float:
    """The way from the end of one code's stroke to the begin of another's."""
    return far(ends, a >> 1, 1 - (a & 1), b >> 1, b & 1)


@njit(cache=True)
def taken(old: float, new: float, heat: float) -> bool:
    return new <= old or np.random.random() < math.exp((old - new) / heat)


@njit(cache=True)
def turn(ends: np.ndarray, tour: np.ndarray, p: int, q: int, heat: float) -> float:
    """2-opt: what lies between the places p and q backwards; how much longer the tour became, 0 where it stayed."""
    first, last = (p + 1, q) if q > p else (q + 1, p)
    old = joint(ends, tour[first - 1], tour[first]) + joint(ends, tour[last], tour[last + 1])
    new = joint(ends, tour[first - 1], tour[last] ^ 1) + joint(ends, tour[first] ^ 1, tour[last + 1])
    if not taken(old, new, heat):
        return 0.0
    turned(tour, first, last)
    return new - old


@njit(cache=True)
def shift(ends: np.ndarray, tour: np.ndarray, p: int, q: int, backwards: bool, heat: float) -> float:
    """Or-opt: up to four strokes from the place q on behind the place p; how much longer the tour became."""
    more = np.random.randint(0, 4)
    first, last = (q - more, q) if backwards else (q, q + more)
    if first < 1 or last > len(tour) - 2 or first - 1 <= p <= last:
        return 0.0
    head, tail = (tour[last] ^ 1, tour[first] ^ 1) if backwards else (tour[first], tour[last])
    old = joint(ends, tour[first - 1], tour[first]) + joint(ends, tour[last], tour[last + 1])
    old += joint(ends, tour[p], tour[p + 1])
    new = joint(ends, tour[first - 1], tour[last + 1]) + joint(ends, tour[p], head) + joint(ends, tail, tour[p + 1])
    if not taken(old, new, heat):
        return 0.0
    if backwards:
        turned(tour, first, last)
    shifted(tour, first, last, p)
    return new - old


@njit(cache=True)
def annealed(ends: np.ndarray, near: np.ndarray, tour: np.ndarray, moves: int, hot: float, cold: float) -> float:
    """Shorten a tour of codes, 2 i for stroke i forwards, 2 i + 1 backwards; its first and last code stay.

    near: for each code the codes that begin near its end. Each move lets one of them follow it.
    """
    place = np.empty(len(ends), np.int64)
    here = best = length(ends, tour)
    longer = np.inf
    for move in range(moves):
        if longer != 0.0:
            place[tour[:-1] >> 1] = np.arange(len(tour) - 1)
        longer = 0.0
        heat = hot * (cold / hot) ** (move / moves)
        p = np.random.randint(0, len(tour) - 1)
        code = near[tour[p], np.random.randint(0, near.shape[1])]
        q = place[code >> 1]
        if q in (0, p, p + 1):
            continue
        backwards = tour[q] != code
        if backwards and np.random.random() < 0.7:
            longer = turn(ends, tour, p, q, heat)
        else:
            longer = shift(ends, tour, p, q, backwards, heat)
        here += longer
        best = min(best, here)
    return best


def nearest(ends: np.ndarray, count: int) -> np.ndarray:
    begins = ends.reshape(-1, 2)
    # The end of code 2 i is the begin of code 2 i + 1.
    leaves = begins.reshape(-1, 2, 2)[:, ::-1].reshape(-1, 2)
    away = np.hypot(*(leaves[:, None] - begins[None]).transpose(2, 0, 1))
    codes = np.arange(len(begins))
    away[codes, codes] = away[codes, codes ^ 1] = np.inf
    return np.argsort(away, axis=1)[:, :count]


@njit(cache=True)
def seeded(seed: int) -> None:
    np.random.seed(seed)


def main() -> None:
    found = []
    for given in json.load(sys.stdin):
        ends = np.array([[[0.0, 0.0], [0.0, 0.0]], *given])
        near, start = nearest(ends, 12), np.array([0, *(2 * i for i in range(1, len(ends))), 0], np.int64)
        runs = []
        for seed in range(RUNS):
            seeded(seed)
            runs.append(annealed(ends, near, start.copy(), MOVES, 10.0, 0.05))
        found.append(min(runs))
    json.dump(found, sys.stdout)


if __name__ == "__main__":
    main()
