"""An open tour through segments that may be walked either way, made shorter by iterated 2-opt and Or-opt."""

from __future__ import annotations

import math
import random
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from daemon.toolpath.doors import nearest_doors

Codes: TypeAlias = NDArray[np.int64]
"""Segments in order: 2 i where segment i is walked forwards, 2 i + 1 where it is walked backwards."""
Place: TypeAlias = NDArray[np.float64]

_NEIGHBOURS = 8
_LONGEST_MOVED = 3
_LONGEST_KICKED = 50
_LONGEST_FLIP = 1000
"""Longer stretches are not turned round: it bounds the work on pages of thousands of strokes."""
_KICKS_A_SEGMENT, _MOST_KICKS = 5, 500
_LEAST_GAIN = 1e-9


def improve(ends: NDArray[np.float64], *, start: Place, end: Place | None) -> Codes:
    """The tour 0, 1, 2, ... made shorter: 2-opt (Croes 1958) and Or-opt (Or 1976), kicked on by double bridges.

    ends: (N, 2, 2) float64, both ends of each segment as (x, y). start, end: (2,) where the tour begins and ends; with
    no end it ends where its last segment does.
    Returns (N,) int64 codes. Never longer than the given tour, and the same for the same input: the work is bounded by
    the number of segments, never by a clock. Iterated local search after Martin, Otto and Felten (1991), the kicks
    local, so that a round costs the same on a large page.
    """
    # A last segment leads from the end back to the start: the tour is a ring, and every move may turn either side.
    doors = np.concatenate([ends.reshape(-1, 2), [start if end is None else end, start]])
    tour = Tour(doors) if end is not None else _OpenTour(doors)
    tour.settle(list(range(len(tour.places))))
    chance = random.Random(0)
    for _ in range(min(_MOST_KICKS, _KICKS_A_SEGMENT * len(ends)) if len(ends) > 2 else 0):
        tour.kick(chance)
    return np.array(tour.opened(), np.int64)


class Tour:
    """A ring of segments. A door is an end of a segment, 2 i or 2 i + 1; a link joins two doors of two segments.

    `ring` holds the door by which each segment is entered, `at` the place of each segment in it.
    """

    __slots__ = ("at", "moves", "near", "places", "ring")

    def __init__(self, doors: NDArray[np.float64], *, neighbours: int = _NEIGHBOURS) -> None:
        self.places: list[tuple[float, ...]] = [*map(tuple, doors.tolist())]
        self.near = nearest_doors(doors, neighbours)
        self.ring = list(range(0, len(doors), 2))
        self.at = list(range(len(self.ring)))
        self.moves: list[tuple[int, int, int, int]] = []

    def opened(self) -> list[int]:
        """The codes from the start to the end: the ring cut at its last segment."""
        last = len(self.ring) - 1
        cut = self.at[last]
        codes = self.ring[cut + 1 :] + self.ring[:cut]
        return codes if self.ring[cut] == 2 * last else [code ^ 1 for code in reversed(codes)]

    def settle(self, doors: list[int]) -> float:
        """Move until no move at these doors, or at doors moved meanwhile, helps. Returns by how much it is shorter."""
        gained = 0.0
        while doors:
            gain = self._improve(doors[-1], doors)
            gained += gain
            if not gain:
                doors.pop()
        return gained

    def kick(self, chance: random.Random) -> None:
        """Exchange two neighbouring stretches, settle, and take all of it back where the tour has become longer."""
        size = len(self.ring)
        one, other = (chance.randint(1, min(_LONGEST_KICKED, (size - 1) // 2)) for _ in range(2))
        first = chance.randrange(size)
        near, far = self.ring[first], self.ring[(first + one - 1) % size] ^ 1
        leave = self.ring[(first + one + other - 1) % size] ^ 1
        self.mark()
        gain, moved = self.carry(near, far, leave)
        if gain + self.settle(moved) < -_LEAST_GAIN:
            self.go_back()

    def mark(self) -> None:
        """What is moved from now on can be taken back."""
        self.moves.clear()

    def go_back(self) -> None:
        """To how the tour was at the last mark."""
        for a, b, c, d in reversed(self.moves):
            self.flip(a, c, b, d)

    def far(self, a: int, b: int) -> float:
        """What a link between two doors costs."""
        return math.dist(self.places[a], self.places[b])

    def entered(self, door: int) -> bool:
        """Whether the segment is entered by this door; else it is left by it."""
        return self.ring[self.at[door >> 1]] == door

    def mate(self, door: int) -> int:
        """The door at the other end of this door's link."""
        at = self.at[door >> 1]
        if self.ring[at] == door:
            return self.ring[at - 1] ^ 1
        return self.ring[at + 1 - len(self.ring)]

    def _improve(self, door: int, moved: list[int]) -> float:
        """The first move that brings a neighbour of this door next to it and makes the tour shorter; 0 for none."""
        ring, at, far = self.ring, self.at, self.far
        mate, entered = self.mate(door), ring[at[door >> 1]] == door
        link = far(door, mate)
        for other, new in self.near[door]:
            if new >= link:
                break
            if other == mate:
                continue
            beyond = self.mate(other)
            saved = link - new + far(other, beyond)
            if (ring[at[other >> 1]] == other) == entered:
                gain = saved - far(mate, beyond)
                if gain > _LEAST_GAIN and self.short(door, other):
                    self.flip(door, mate, other, beyond)
                    moved += (door, mate, other, beyond)
                    return gain
            gain = self._or_opt((door, mate, other, beyond), saved, moved)
            if gain:
                return gain
        return 0.0

    def _or_opt(self, doors: tuple[int, int, int, int], saved: float, moved: list[int]) -> float:
        """Carry the one to three segments that begin at a door into the link of another, the two doors linked."""
        near, before, target, beyond = doors
        ring, far_of, place = self.ring, self.far, self.at[near >> 1]
        size, one, other = len(ring), target >> 1, beyond >> 1
        step = 1 if ring[place] == near else -1
        for _ in range(min(_LONGEST_MOVED, size - 2)):
            code = ring[place]
            if code >> 1 == one or code >> 1 == other:
                return 0.0
            place = (place + step) % size
            far, after = (code ^ 1, ring[place]) if step > 0 else (code, ring[place] ^ 1)
            # No way is shorter than none: what cannot gain even so is not looked at further.
            gain = saved + far_of(far, after)
            if gain > _LEAST_GAIN:
                gain -= far_of(before, after)
            if gain > _LEAST_GAIN:
                gain -= far_of(far, beyond)
            if gain > _LEAST_GAIN and self.short(near, target):
                moved += self.carry(near, far, target)[1]
                return gain
        return 0.0

    def short(self, a: int, b: int) -> bool:
        """Whether the stretch between the segments of two doors may be turned round."""
        away = abs(self.at[a >> 1] - self.at[b >> 1])
        return min(away, len(self.ring) - away) <= _LONGEST_FLIP

    def carry(self, near: int, far: int, target: int) -> tuple[float, list[int]]:
        """Carry the run from door `near` to door `far` into the link of `target`, `near` next to it.

        Returns by how much the tour is shorter and the six doors whose links are new.
        """
        before, after, beyond = self.mate(near), self.mate(far), self.mate(target)
        gain = self.far(before, near) + self.far(far, after) + self.far(target, beyond)
        gain -= self.far(before, after) + self.far(near, target) + self.far(far, beyond)
        if self.entered(near) == self.entered(target):
            self.flip(before, near, beyond, target)
            self.flip(before, beyond, after, far)
        else:
            self.flip(before, near, far, after)
            self.flip(before, far, target, beyond)
            self.flip(before, target, after, near)
        return gain, [before, near, far, after, target, beyond]

    def flip(self, a: int, b: int, c: int, d: int) -> None:
        """Links a-b and c-d become a-c and b-d, a and c entered both or both left; one stretch is turned round."""
        if a == d or b == c:
            return
        self.moves.append((a, b, c, d))
        size = len(self.ring)
        first, last = (a, d) if self.entered(a) else (b, c)
        low, high = self.at[first >> 1], self.at[last >> 1]
        count = (high - low) % size + 1
        if 2 * count > size:
            low, count = high + 1, size - count
        self._turn(low % size, count)

    def _turn(self, low: int, count: int) -> None:
        """Walk `count` segments from place `low` on backwards."""
        ring, at, size = self.ring, self.at, len(self.ring)
        places = range(low, low + count) if low + count <= size else [k % size for k in range(low, low + count)]
        turned = [ring[place] ^ 1 for place in reversed(places)]
        for place, code in zip(places, turned, strict=True):
            ring[place] = code
            at[code >> 1] = place


class _OpenTour(Tour):
    """A tour that may end anywhere: the link to the end of its last segment costs nothing."""

    __slots__ = ()

    def far(self, a: int, b: int) -> float:
        end = len(self.places) - 2
        return 0.0 if end in (a, b) else math.dist(self.places[a], self.places[b])
