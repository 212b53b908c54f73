"""The axes and the pen of a simulated mill: moves executed in time, the path, the ink."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import replace

from firmware_protocol.emco.simulator.interpreter import Move
from firmware_protocol.emco.simulator.motion import Clock
from firmware_protocol.ink import Ink, PenRule, Vector

_NEVER = float("inf")


class Axes:
    """Executes moves one behind the other, each at the even speed that gives it its time.

    ahead: blocks with motion that are taken in at most, the one that is being executed included.
    """

    def __init__(self, *, ahead: int, acceleration_mm_s2: float, pen: PenRule) -> None:
        self._ahead, self._acceleration = ahead, acceleration_mm_s2
        self._clock = Clock(acceleration_mm_s2=acceleration_mm_s2)
        self._ink = Ink(pen)
        self._moves: deque[tuple[Move, float, bool]] = deque()
        self._blocks = 0
        self._began_s = 0.0
        self._position_mm: Vector = (0.0, 0.0, 0.0)
        self.path: list[tuple[float, Vector]] = []
        """Where each move ended, and when."""

    @property
    def has_room(self) -> bool:
        return self._blocks < self._ahead

    @property
    def moving(self) -> bool:
        return bool(self._moves)

    def add(self, moves: Sequence[Move], now: float) -> None:
        """Take in the moves of a block; moves without length are none. Axes that stand begin from rest."""
        if not self._moves:
            self._clock = Clock(acceleration_mm_s2=self._acceleration)
        timed = [(move, seconds) for move in moves if (seconds := self._clock.seconds(move)) > 0]
        if not timed:
            return
        if not self._moves:
            self._began_s = now
        self._moves += [(move, seconds, index == len(timed)) for index, (move, seconds) in enumerate(timed, 1)]
        self._blocks += 1

    def next_s(self) -> float:
        """When the running move ends."""
        return self._began_s + self._moves[0][1] if self._moves else _NEVER

    def advance(self, now: float) -> None:
        """Move on to `now`."""
        while self._moves and self.next_s() <= now:
            move, seconds, ends_block = self._moves.popleft()
            self._began_s += seconds
            self._blocks -= ends_block
            self._finish(move)

    def stop(self, now: float) -> None:
        """Stop dead and forget all moves."""
        self.advance(now)
        if self._moves:
            self._finish(self._part(now))
        self._ink.cut()
        self._moves.clear()
        self._blocks = 0

    def position_mm(self, now: float) -> Vector:
        return self._part(now).end if self._moves else self._position_mm

    def ink(self, now: float) -> Ink:
        """What is on the sheet, the running move included as far as it is."""
        if not self._moves:
            return self._ink
        ink = self._ink.copy()
        part = self._part(now)
        ink.travel(part.start, part.end)
        return ink

    def clear_sheet(self) -> None:
        self._ink.clear()

    def _finish(self, move: Move) -> None:
        self._ink.travel(move.start, move.end)
        self._position_mm = move.end
        self.path.append((self._began_s, move.end))

    def _part(self, now: float) -> Move:
        move, seconds, _ = self._moves[0]
        part = min(1.0, max(0.0, (now - self._began_s) / seconds))
        x, y, z = (a + (b - a) * part for a, b in zip(move.start, move.end, strict=True))
        return replace(move, end=(x, y, z))
