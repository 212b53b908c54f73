"""Which line goes on in which at a crossing, chosen anew where that makes the way with the pen up shorter."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from daemon.shapes import Points, Stroke
from daemon.toolpath.doors import Near
from daemon.toolpath.order import Place, travel_mm, turn_closed
from daemon.toolpath.simplify import shared_points
from daemon.toolpath.tour import Tour

_LIFT_MM = 1e5
"""More than any travel: no lift of the pen is ever added to save some."""
_BEND_MM = 1.0
"""Travel that must be saved for a right angle where a line could go straight on."""
_TANGENT_MM = 2.0
_NEIGHBOURS = 12
_TRIES_A_CROSSING, _MOST_TRIES = 5, 150
_MOST_TURNS = 4
_LONGEST_RUN, _LONGEST_WALK = 10, 300
_LEAST_GAIN = 1e-6


def rejoined(strokes: Sequence[Stroke], *, start_mm: Place, end_mm: Place | None) -> tuple[Stroke, ...]:
    """The lines of a tour of strokes in no more strokes, joined otherwise at the points they share: less travel.

    strokes: in drawing order. Where lines cross or fork, the strokes that pass there can exchange what comes after, a
    loop can be walked the other way round, and a closed stroke can begin. Cut at all such points, the pieces of one pen
    are the segments of a tour (rural postman problem, Orloff 1974): a link between two pieces at one point costs no
    travel but its bend, any other one a lift. Moved as in `tour`, then by random turns at crossings and exchanges of
    runs of strokes; their number is bounded, and the same strokes always give the same. Travel grows only where a
    lift is saved, and a line that went straight on turns off only where that saves more than a millimetre. Dots stay.
    """
    pieces = [piece for stroke in _cut(strokes) for piece in stroke]
    nodes = _nodes(pieces)
    if len(set(nodes)) == len(nodes):
        return tuple(strokes)
    tour = _Pieces(pieces, nodes, start_mm, end_mm)
    tour.shorten()
    joined = turn_closed(_joined(pieces, nodes, tour.opened()), start_mm, end_mm)
    # The tour may have paid a little travel for straighter lines; those of the given strokes are straight enough.
    more_mm = travel_mm(joined, start_mm, end_mm) - travel_mm(strokes, start_mm, end_mm)
    return tuple(strokes if more_mm > _LEAST_GAIN and len(joined) == len(strokes) else joined)


class _Pieces(Tour):
    """A tour through pieces of strokes; a door's node is the point that it shares with other pieces' doors."""

    __slots__ = ("_along", "_at_node", "_bend_mm", "_bent", "_free", "_nodes", "_unbent")

    def __init__(self, pieces: list[Stroke], nodes: list[int], start: Place, end: Place | None) -> None:
        ends = np.array([[piece.points[0], piece.points[-1]] for piece in pieces]).reshape(-1, 2)
        doors = np.concatenate([ends, np.array([end or start, start], float)])
        super().__init__(doors, neighbours=_NEIGHBOURS)
        self._nodes = [*nodes, len(nodes), len(nodes) + 1]
        self._free = len(nodes) if end is None else -1
        self._along = [*_directions(pieces), (0.0, 0.0), (0.0, 0.0)]
        self._at_node: dict[int, list[int]] = {}
        for door, node in enumerate(nodes):
            self._at_node.setdefault(node, []).append(door)
        self._bend_mm = 0.0
        self._unbent = self._costs(self.near)
        self._bend_mm = _BEND_MM
        self._bent = self._costs(self.near)

    def shorten(self) -> None:
        """Settle, then try turns at crossings and keep those that save travel."""
        self._mind_bends(True)
        self.settle(list(range(len(self.places))))
        crossings = [node for node, doors in self._at_node.items() if len(doors) > 2]
        chance, cost = random.Random(0), self._cost()
        for number in range(min(_MOST_TRIES, _TRIES_A_CROSSING * len(crossings))):
            cost = self._tried(chance, chance.choice(crossings), 1 + number % _MOST_TURNS, cost)

    def far(self, a: int, b: int) -> float:
        if self._nodes[a] == self._nodes[b]:
            (ax, ay), (bx, by) = self._along[a], self._along[b]
            return self._bend_mm * (1.0 + ax * bx + ay * by)
        free = self._free
        return 0.0 if free in (a, b) else _LIFT_MM + math.dist(self.places[a], self.places[b])

    def _costs(self, near: list[Near]) -> list[Near]:
        """The neighbours of each door by what a link to them costs."""
        found = ([(other, self.far(door, other)) for other, _ in row] for door, row in enumerate(near))
        return [sorted(row, key=lambda link: link[1]) for row in found]

    def _mind_bends(self, mind: bool) -> None:
        self._bend_mm, self.near = (_BEND_MM, self._bent) if mind else (0.0, self._unbent)

    def _cost(self) -> float:
        return sum(self.far(self.ring[i - 1] ^ 1, code) for i, code in enumerate(self.ring))

    def _tried(self, chance: random.Random, crossing: int, turns: int, cost: float) -> float:
        """What the tour costs after some turns about a crossing: less, or all is as it was."""
        self.mark()
        self._mind_bends(False)
        saved = 0.0
        for _ in range(turns):
            saved += self._turn_at(crossing, chance)
            if saved > _LEAST_GAIN:
                break
            crossing = self._beside(crossing, chance)
        if saved <= _LEAST_GAIN:
            saved += self._exchange(chance)
        self._mind_bends(True)
        if saved > _LEAST_GAIN:
            self.settle([door for move in self.moves for door in move])
            if (now := self._cost()) < cost - _LEAST_GAIN:
                return now
        self.go_back()
        return cost

    def _turn_at(self, crossing: int, chance: random.Random) -> float:
        """Exchange what two links at a crossing lead to, which costs no travel, and settle: what that saves."""
        doors = self._at_node[crossing]
        one = chance.choice(doors)
        others = [door for door in doors if door not in (one, self.mate(one))]
        if not others:
            return 0.0
        other = chance.choice(others)
        if self.entered(one) != self.entered(other):
            other = self.mate(other)
        a, b, c, d = one, self.mate(one), other, self.mate(other)
        if not self.short(a, c):
            return 0.0
        before = self.far(a, b) + self.far(c, d)
        self.flip(a, b, c, d)
        return before - self.far(a, c) - self.far(b, d) + self.settle([a, b, c, d])

    def _exchange(self, chance: random.Random) -> float:
        """Exchange two neighbouring runs of strokes and settle: the travel saved by that, often less than none."""
        one, other = (chance.randint(1, _LONGEST_RUN) for _ in range(2))
        lifts = self._lifts_from(chance.randrange(len(self.ring)), 1 + one + other)
        if len(lifts) < 3:
            return 0.0
        middle = min(one, len(lifts) - 2)
        i, j, k = lifts[0], lifts[middle], lifts[-1]
        gain, moved = self.carry(self.ring[i], self.ring[j - 1] ^ 1, self.ring[k - 1] ^ 1)
        return gain + self.settle(moved)

    def _lifts_from(self, place: int, most: int) -> list[int]:
        """The next places in the ring, not all the way round, where the pen comes down."""
        ring, nodes, found = self.ring, self._nodes, []
        for step in range(min(len(ring) - 1, _LONGEST_WALK)):
            at = (place + step) % len(ring)
            if nodes[ring[at - 1] ^ 1] != nodes[ring[at]]:
                found.append(at)
                if len(found) == most:
                    break
        return found

    def _beside(self, crossing: int, chance: random.Random) -> int:
        """The same crossing, or the one that a piece leads to from it."""
        node = self._nodes[chance.choice(self._at_node[crossing]) ^ 1]
        return node if chance.random() < 0.5 and len(self._at_node[node]) > 2 else crossing


def _cut(strokes: Sequence[Stroke]) -> list[list[Stroke]]:
    """Each stroke as the pieces between the points that strokes hold more than once."""
    return [
        [replace(stroke, points=stroke.points[a : b + 1]) for a, b in pairwise(_stops(shared))]
        if len(stroke.points) > 1
        else [stroke]
        for stroke, shared in zip(strokes, shared_points([stroke.points for stroke in strokes]), strict=True)
    ]


def _stops(shared: NDArray[np.bool_]) -> list[int]:
    inner = np.flatnonzero(shared[1:-1]) + 1
    return [0, *inner.tolist(), len(shared) - 1]


def _nodes(pieces: list[Stroke]) -> list[int]:
    """For both doors of each piece the number of its point; a dot's are its own, another pen's are others."""
    numbers: dict[object, int] = {}
    keys: list[object] = []
    for index, piece in enumerate(pieces):
        dot = len(piece.points) == 1
        keys += [("dot", index, side) if dot else (piece.pen, *piece.points[-side].tolist()) for side in (0, 1)]
    return [numbers.setdefault(key, len(numbers)) for key in keys]


def _directions(pieces: list[Stroke]) -> list[tuple[float, float]]:
    """The unit direction in which each piece leaves its doors."""
    return [_direction(points) for piece in pieces for points in (piece.points, piece.points[::-1])]


def _direction(points: Points) -> tuple[float, float]:
    away = np.hypot(*(points - points[0]).T)
    far = int(np.argmax(away >= _TANGENT_MM)) or len(points) // 2
    x, y = (points[far] - points[0]).tolist()
    length = math.hypot(x, y) or 1.0
    return x / length, y / length


def _joined(pieces: list[Stroke], nodes: list[int], codes: list[int]) -> list[Stroke]:
    """The strokes of a tour: pieces that follow each other at one node are one stroke."""
    runs: list[list[int]] = []
    for code in codes:
        if runs and nodes[runs[-1][-1] ^ 1] == nodes[code]:
            runs[-1].append(code)
        else:
            runs.append([code])
    return [replace(pieces[run[0] >> 1], points=_line(pieces, run)) for run in runs]


def _line(pieces: list[Stroke], run: list[int]) -> Points:
    parts = [pieces[code >> 1].points[:: -1 if code & 1 else 1] for code in run]
    return np.concatenate([parts[0], *(part[1:] for part in parts[1:])])
