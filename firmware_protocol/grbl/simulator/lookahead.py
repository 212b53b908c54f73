"""Speeds at which GRBL 1.1 passes from one planned block to the next."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import sqrt
from typing import TypeAlias

from firmware_protocol.grbl.simulator.settings import Settings

Vector: TypeAlias = tuple[float, float, float]
Steps: TypeAlias = tuple[int, int, int]

BLOCKS = 15
"""Blocks that the planner of a 328P holds (`[OPT:V,15,128]`)."""

_ANY_SPEED = 1e38
_SLOWEST_MM_S = 1.0 / 60


@dataclass(frozen=True, slots=True)
class Move:
    """A straight line to `target_mm` (machine coordinates).

    feed: mm/min, or 1/min when `inverse_time`; a rapid move ignores it. jog: feed override does not apply.
    """

    target_mm: Vector
    feed: float
    rapid: bool = False
    inverse_time: bool = False
    jog: bool = False


@dataclass(slots=True)
class Block:
    """A planned move: geometry that stays and speeds that are raised while more blocks arrive. Squares are mm2/s2."""

    start_mm: Vector
    end_mm: Vector
    length_mm: float
    acceleration_mm_s2: float
    fastest_mm_s: float
    wanted_mm_s: float
    rapid: bool
    jog: bool
    junction_sqr: float
    tag: int
    max_entry_sqr: float = 0.0
    entry_sqr: float = 0.0
    done_mm: float = 0.0

    @property
    def remaining_mm(self) -> float:
        return self.length_mm - self.done_mm

    def at(self, done_mm: float) -> Vector:
        """The place `done_mm` behind the start."""
        part = min(1.0, done_mm / self.length_mm)
        (x0, y0, z0), (x1, y1, z1) = self.start_mm, self.end_mm
        return x0 + (x1 - x0) * part, y0 + (y1 - y0) * part, z0 + (z1 - z0) * part


class Lookahead:
    """The planner's queue: `planner.c` of GRBL 1.1h, junction deviation and the two passes over the blocks.

    `settle` is called before the speeds of the block that is being executed are looked at: it writes that block's
    `done_mm` and `entry_sqr` as they are now.
    """

    def __init__(self, settings: Settings, settle: Callable[[], None] = lambda: None) -> None:
        self.settings = settings
        self.settle = settle
        self.blocks: deque[Block] = deque()
        self.feed_override = 1.0
        self.rapid_override = 1.0
        self.load_settings()
        self.reset((0.0, 0.0, 0.0))

    def load_settings(self) -> None:
        """Take over what `$x=` has written."""
        self._steps_per_mm = self.settings.axes(100)
        self._rates_mm_s = tuple(rate / 60 for rate in self.settings.axes(110))
        self._accelerations = self.settings.axes(120)
        self._deviation_mm = self.settings[11]

    def reset(self, position_mm: Vector) -> None:
        """Forget all blocks; the next one begins at `position_mm`."""
        self.blocks.clear()
        self._planned = 0
        self._steps: Steps = self.steps(position_mm)
        self._unit: Vector = (0.0, 0.0, 0.0)
        self._nominal_mm_s = 0.0

    @property
    def full(self) -> bool:
        return len(self.blocks) >= BLOCKS

    @property
    def exit_sqr(self) -> float:
        """The square of the speed at which the first block is left."""
        return self.blocks[1].entry_sqr if len(self.blocks) > 1 else 0.0

    def steps(self, position_mm: Sequence[float]) -> Steps:
        """The nearest whole steps."""
        x, y, z = (round(p * s) for p, s in zip(position_mm, self._steps_per_mm, strict=True))
        return x, y, z

    def millimetres(self, steps: Sequence[int]) -> Vector:
        x, y, z = (n / s for n, s in zip(steps, self._steps_per_mm, strict=True))
        return x, y, z

    def add(self, move: Move, tag: int = 0) -> bool:
        """Plan one more block. Returns False for a move shorter than a step, which makes no block."""
        steps = self.steps(move.target_mm)
        if steps == self._steps:
            return False
        start, end = self.millimetres(self._steps), self.millimetres(steps)
        dx, dy, dz = end[0] - start[0], end[1] - start[1], end[2] - start[2]
        length = sqrt(dx * dx + dy * dy + dz * dz)
        unit = (dx / length, dy / length, dz / length)
        fastest = _axis_limit(self._rates_mm_s, unit)
        wanted = move.feed / 60 * (length if move.inverse_time else 1.0)
        block = Block(
            start, end, length, _axis_limit(self._accelerations, unit), fastest, fastest if move.rapid else wanted,
            move.rapid, move.jog, self._junction_sqr(unit) if self.blocks else 0.0, tag,
        )  # fmt: skip
        self._append(block, steps, unit)
        return True

    def drop_first(self) -> None:
        """The first block has been executed."""
        self.blocks.popleft()
        self._planned = max(0, self._planned - 1)

    def nominal_mm_s(self, block: Block) -> float:
        """The speed at which a block is executed where nothing else limits it."""
        if block.rapid:
            speed = block.fastest_mm_s * self.rapid_override
        else:
            speed = block.wanted_mm_s * (1.0 if block.jog else self.feed_override)
        return max(_SLOWEST_MM_S, min(speed, block.fastest_mm_s))

    def override(self, *, feed: float, rapid: float) -> None:
        """Execute at these parts of the programmed feed and of the rapid rate."""
        self.feed_override, self.rapid_override = feed, rapid
        previous = _ANY_SPEED
        for block in self.blocks:
            nominal = self.nominal_mm_s(block)
            block.max_entry_sqr = min(nominal * nominal, previous * previous, block.junction_sqr)
            previous = nominal
        self._nominal_mm_s = previous
        self.replan()

    def replan(self) -> None:
        """Plan all blocks anew, from the present speed of the first."""
        self._planned = 0
        self.settle()
        self._recalculate()

    def _append(self, block: Block, steps: Steps, unit: Vector) -> None:
        nominal = self.nominal_mm_s(block)
        previous = self._nominal_mm_s
        block.max_entry_sqr = min(nominal * nominal, previous * previous, block.junction_sqr)
        self._nominal_mm_s, self._unit, self._steps = nominal, unit, steps
        self.blocks.append(block)
        if self._planned < len(self.blocks) - 1:
            if self._planned == 0:
                self.settle()
            self._recalculate()

    def _junction_sqr(self, unit: Vector) -> float:
        (px, py, pz), (ux, uy, uz) = self._unit, unit
        cosine = -(px * ux + py * uy + pz * uz)
        if cosine > 0.999999:
            return 0.0
        if cosine < -0.999999:
            return _ANY_SPEED
        jx, jy, jz = ux - px, uy - py, uz - pz
        length = sqrt(jx * jx + jy * jy + jz * jz)
        acceleration = _axis_limit(self._accelerations, (jx / length, jy / length, jz / length))
        half_sine = sqrt(0.5 * (1.0 - cosine))
        return acceleration * self._deviation_mm * half_sine / (1.0 - half_sine)

    def _recalculate(self) -> None:
        blocks = list(self.blocks)
        _slow_down(blocks, self._planned)
        self._planned = _speed_up(blocks, self._planned)


def _slow_down(blocks: list[Block], planned: int) -> None:
    """From the last block, which ends at rest, back to the last one that cannot be improved."""
    exit_sqr = 0.0
    for index in range(len(blocks) - 1, planned, -1):
        block = blocks[index]
        reachable = exit_sqr + 2 * block.acceleration_mm_s2 * block.remaining_mm
        block.entry_sqr = exit_sqr = min(block.max_entry_sqr, reachable)


def _speed_up(blocks: list[Block], planned: int) -> int:
    """Forward: no block is entered faster than acceleration allows. Returns the first block that may still improve."""
    start = planned
    for index in range(start + 1, len(blocks)):
        block, following = blocks[index - 1], blocks[index]
        if block.entry_sqr < following.entry_sqr:
            reachable = block.entry_sqr + 2 * block.acceleration_mm_s2 * block.remaining_mm
            if reachable < following.entry_sqr:
                following.entry_sqr = reachable
                planned = index
        if following.entry_sqr == following.max_entry_sqr:
            planned = index
    return planned


def _axis_limit(limits: Sequence[float], unit: Vector) -> float:
    """The largest value along `unit` at which no axis exceeds its limit (`limit_value_by_axis_maximum`)."""
    smallest = _ANY_SPEED
    for limit, part in zip(limits, unit, strict=True):
        if part:
            smallest = min(smallest, limit / abs(part))
    return smallest
