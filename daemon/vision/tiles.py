"""Pages of any size through a network of one size: tiles that overlap, blank ones skipped."""

from __future__ import annotations

import itertools
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Tile:
    """A window of a page. It sees `size` px from (left, top), which may lie outside; it answers for the core alone."""

    left: int
    top: int
    core_left: int
    core_top: int
    core_right: int
    core_bottom: int


def spans(length_px: int, size_px: int, margin_px: int) -> list[tuple[int, int, int]]:
    """(first px seen, first px answered for, end of the px answered for) of the windows along one side.

    One window, centred, where the side fits; otherwise as few as possible, evenly spread, each with margin_px of
    sight beyond what it answers for (a network of valid convolutions sees its border badly).
    """
    if length_px <= size_px:
        return [((length_px - size_px) // 2, 0, length_px)]
    core_px = size_px - 2 * margin_px
    count = -(-length_px // core_px)
    bounds = [round(k * length_px / count) for k in range(count + 1)]
    return [((a + b - size_px) // 2, a, b) for a, b in itertools.pairwise(bounds)]


def tiles(width_px: int, height_px: int, *, size_px: int, margin_px: int) -> list[Tile]:
    """Windows whose cores cover a page exactly once."""
    across, down = spans(width_px, size_px, margin_px), spans(height_px, size_px, margin_px)
    return [Tile(x, y, x0, y0, x1, y1) for y, y0, y1 in down for x, x0, x1 in across]
