"""Motion of planned blocks in time: trapezoids computed whole, no ticks."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from math import sqrt
from typing import NamedTuple

from firmware_protocol.grbl.simulator.lookahead import Block, Lookahead, Vector

PREPARED_S = 0.045
"""How far ahead of the motors GRBL has cut the motion into segments: a hold or a new block acts only behind them."""
PREPARED_BLOCKS = 5
"""Segments that the ring of GRBL holds; each belongs to one block, so of very short blocks no more are prepared."""

_NEVER = float("inf")
_TINY_MM = 1e-9


class _Piece(NamedTuple):
    """Constant acceleration from `start_s` to `end_s`, along `block` from `from_mm` to `to_mm`."""

    start_s: float
    end_s: float
    speed_mm_s: float
    acceleration_mm_s2: float
    from_mm: float
    to_mm: float
    block: Block

    def speed(self, at_s: float) -> float:
        return max(0.0, self.speed_mm_s + self.acceleration_mm_s2 * (at_s - self.start_s))

    def done_mm(self, at_s: float) -> float:
        elapsed = at_s - self.start_s
        return min(self.to_mm, self.from_mm + (self.speed_mm_s + 0.5 * self.acceleration_mm_s2 * elapsed) * elapsed)


class Stepper:
    """Executes the blocks of a `Lookahead`: `st_prep_buffer` of GRBL 1.1h without its 10 ms segments.

    The clock is handed in with each call and never goes back. `finished(time, block)` is called for each block whose
    end the pen has reached, `cut(block, done_mm)` where motion is cut within one.
    """

    def __init__(
        self, lookahead: Lookahead, finished: Callable[[float, Block], None], cut: Callable[[Block, float], None]
    ) -> None:
        self.lookahead = lookahead
        lookahead.settle = self._settle
        self._finished, self._cut = finished, cut
        self._pieces: deque[_Piece] = deque()
        self._now = 0.0
        self._end_s = 0.0
        self._prepared = self._held = False
        self._dropped_ends_s: deque[float] = deque(maxlen=PREPARED_BLOCKS)
        self.position_mm: Vector = (0.0, 0.0, 0.0)
        self.moving = False

    @property
    def speed_mm_s(self) -> float:
        """The speed of the segment that is being prepared, which is what `FS:` reports."""
        at_s = self._now + PREPARED_S
        speed = 0.0
        for piece in self._pieces:
            speed = piece.speed(min(at_s, piece.end_s))
            if piece.end_s > at_s:
                break
        return speed

    def next_s(self) -> float:
        """When the next place in the planner becomes free or the motion ends."""
        if not self.moving:
            return _NEVER
        return self._drop_s if self._prepared else self._end_s

    @property
    def _drop_s(self) -> float:
        """When the last segment of the first block is cut, so that its place in the planner becomes free."""
        ends_s = self._dropped_ends_s
        return max(self._end_s - PREPARED_S, ends_s[0] if len(ends_s) == PREPARED_BLOCKS else 0.0)

    def start(self, now: float) -> None:
        """Set the motors going, when there is something to do."""
        self._now, self._held = now, False
        if self.lookahead.blocks and not self.moving:
            self.moving = True
            self._end_s = now
            self._prepare()

    def planned(self) -> None:
        """A block has been added: while moving it follows on, unless a hold has been asked for."""
        if self.moving and not self._held and not self._prepared and self.lookahead.blocks:
            self._prepare()

    def advance(self, now: float) -> bool:
        """Move on to `now`. Returns True when a place in the planner became free or the motion ended."""
        self._now = now
        changed = False
        while self._prepared and self._drop_s <= now:
            self.lookahead.drop_first()
            self._dropped_ends_s.append(self._end_s)
            self._prepared = False
            changed = True
            if self.lookahead.blocks:
                self._prepare()
        self._pass_pieces(now)
        if self.moving and not self._prepared and self._end_s <= now:
            self.moving = False
            changed = True
        return changed

    def hold(self, now: float) -> None:
        """Slow down to a stop as fast as the acceleration allows, across blocks; the rest waits for `start`."""
        self.advance(now)
        self._held = True
        if not self._prepared:
            return
        self._settle()
        blocks = self.lookahead.blocks
        while blocks:
            block = blocks[0]
            speed_sqr, slowing = block.entry_sqr, block.acceleration_mm_s2
            stop_mm = min(block.remaining_mm, speed_sqr / (2 * slowing))
            left_sqr = max(0.0, speed_sqr - 2 * slowing * stop_mm)
            whole = stop_mm > block.remaining_mm - _TINY_MM
            self._piece(block, sqrt(speed_sqr), sqrt(left_sqr), stop_mm)
            block.done_mm += stop_mm
            block.entry_sqr = 0.0
            if not whole:
                break
            self.lookahead.drop_first()
            if blocks:
                blocks[0].entry_sqr = left_sqr

    def stop(self, now: float) -> None:
        """Stop dead where the pen is and forget all blocks."""
        self.advance(now)
        if self._pieces:
            piece = self._pieces[0]
            done = piece.done_mm(now)
            self._cut(piece.block, done)
            self.position_mm = piece.block.at(done)
        elif self.lookahead.blocks and self.lookahead.blocks[0].done_mm:
            self._cut(self.lookahead.blocks[0], self.lookahead.blocks[0].done_mm)
        self._forget()

    def place(self, position_mm: Vector) -> None:
        """Say where the machine is, at rest."""
        self.position_mm = position_mm
        self._forget()

    def now_at(self) -> tuple[Vector, tuple[Block, float] | None]:
        """Where the pen is, and the block that is half done with its millimetres done, if any."""
        if self._pieces:
            piece = self._pieces[0]
            done = piece.done_mm(self._now)
            return piece.block.at(done), (piece.block, done)
        blocks = self.lookahead.blocks
        return self.position_mm, (blocks[0], blocks[0].done_mm) if blocks and blocks[0].done_mm else None

    def _forget(self) -> None:
        self._pieces.clear()
        self._dropped_ends_s.clear()
        self._prepared = self._held = self.moving = False
        self.lookahead.reset(self.position_mm)
        self.position_mm = self.lookahead.millimetres(self.lookahead.steps(self.position_mm))

    def _pass_pieces(self, now: float) -> None:
        while self._pieces and self._pieces[0].end_s <= now:
            piece = self._pieces.popleft()
            if piece.to_mm >= piece.block.length_mm - _TINY_MM:
                self.position_mm = piece.block.end_mm
                self._finished(piece.end_s, piece.block)
            else:
                self.position_mm = piece.block.at(piece.to_mm)

    def _settle(self) -> None:
        """Take the first block back as far as its segments have not been cut, for planning it anew."""
        if not self._prepared:
            return
        block = self.lookahead.blocks[0]
        at_s = self._now + PREPARED_S
        while self._pieces and self._pieces[-1].block is block and self._pieces[-1].start_s >= at_s:
            self._end_s = self._take_back(self._pieces.pop(), at_s)
        if self._pieces and self._pieces[-1].block is block and self._pieces[-1].end_s > at_s:
            piece = self._pieces.pop()
            self._take_back(piece, at_s)
            self._pieces.append(piece._replace(end_s=at_s, to_mm=block.done_mm))
            self._end_s = at_s
        self._prepared = False

    @staticmethod
    def _take_back(piece: _Piece, at_s: float) -> float:
        at_s = max(at_s, piece.start_s)
        piece.block.done_mm = piece.done_mm(at_s)
        piece.block.entry_sqr = piece.speed(at_s) ** 2
        return at_s

    def _prepare(self) -> None:
        """Lay the rest of the first block out in time, behind what is laid out already."""
        block = self.lookahead.blocks[0]
        entry, top, leave = _speeds(block, self.lookahead.nominal_mm_s(block) ** 2, self.lookahead.exit_sqr)
        change = 2 * block.acceleration_mm_s2
        first_mm = min(block.remaining_mm, abs(top - entry) / change)
        last_mm = min(block.remaining_mm - first_mm, (top - leave) / change)
        even_mm = block.remaining_mm - first_mm - last_mm
        done = block.done_mm
        for from_sqr, to_sqr, length_mm in ((entry, top, first_mm), (top, top, even_mm), (top, leave, last_mm)):
            if length_mm > _TINY_MM:
                self._piece(block, sqrt(from_sqr), sqrt(to_sqr), length_mm)
                block.done_mm += length_mm
        block.done_mm = done
        self._prepared = True

    def _piece(self, block: Block, from_mm_s: float, to_mm_s: float, length_mm: float) -> None:
        lasts_s = 2 * length_mm / max(from_mm_s + to_mm_s, 1e-9)
        if lasts_s <= 0:
            return
        start_s, done = self._end_s, block.done_mm
        self._end_s = start_s + lasts_s
        rate = (to_mm_s - from_mm_s) / lasts_s
        self._pieces.append(_Piece(start_s, self._end_s, from_mm_s, rate, done, done + length_mm, block))


def _speeds(block: Block, nominal_sqr: float, exit_sqr: float) -> tuple[float, float, float]:
    """Squares of the speeds at which the rest of a block begins, goes on and ends (trapezoid, triangle or one ramp)."""
    entry, change = block.entry_sqr, 2 * block.acceleration_mm_s2 * block.remaining_mm
    exit_sqr = min(exit_sqr, nominal_sqr)
    if entry > nominal_sqr:  # the feed was overridden downwards: slow to the new one
        top = max(nominal_sqr, entry - change)
        return entry, top, min(top, max(exit_sqr, top - (change - (entry - top))))
    peak = min(nominal_sqr, 0.5 * (entry + exit_sqr + change))
    return entry, max(peak, entry, exit_sqr), max(exit_sqr, entry - change)
