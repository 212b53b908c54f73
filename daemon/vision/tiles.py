"""Pages of any size through a network of one size: windows that overlap and follow the ink, blank paper left out."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Inked = NDArray[np.bool_]
"""(H, W): where the page is not blank."""

HALO_PX = 4
"""An answer reaches this far beyond the ink."""


@dataclass(frozen=True, slots=True)
class Tile:
    """A window of a page. It sees `size` px from (left, top), which may lie outside; it answers for the core alone."""

    left: int
    top: int
    core_left: int
    core_top: int
    core_right: int
    core_bottom: int


def spans(first_px: int, end_px: int, *, size_px: int, margin_px: int) -> list[tuple[int, int, int]]:
    """(first px seen, first px answered for, end of the px answered for) of the windows along one side.

    As few as possible, evenly spread, each with margin_px of sight beyond what it answers for (a network of valid
    convolutions sees its border badly).
    """
    count = -(-(end_px - first_px) // (size_px - 2 * margin_px))
    bounds = [first_px + round(k * (end_px - first_px) / count) for k in range(count + 1)]
    return [((a + b - size_px) // 2, a, b) for a, b in itertools.pairwise(bounds)]


def tiles(inked: Inked, *, size_px: int, margin_px: int) -> Iterator[Tile]:
    """Windows whose cores cover every inked pixel exactly once: bands of rows, each as wide as its own ink.

    A page that fits into one window is one.
    """
    height, width = inked.shape
    if max(height, width) <= size_px:
        if inked.any():
            yield Tile((width - size_px) // 2, (height - size_px) // 2, 0, 0, width, height)
        return
    for top, core_top, core_bottom in _spans_of(np.asarray(np.any(inked, axis=1)), size_px, margin_px):
        band = np.asarray(np.any(inked[core_top:core_bottom], axis=0))
        for left, core_left, core_right in _spans_of(band, size_px, margin_px):
            if band[core_left:core_right].any():
                yield Tile(left, top, core_left, core_top, core_right, core_bottom)


def _spans_of(inked: NDArray[np.bool_], size_px: int, margin_px: int) -> list[tuple[int, int, int]]:
    """The windows along one side, from its first inked pixel to its last."""
    at = np.flatnonzero(inked)
    if not len(at):
        return []
    first, end = max(0, int(at[0]) - HALO_PX), min(len(inked), int(at[-1]) + 1 + HALO_PX)
    return spans(first, end, size_px=size_px, margin_px=margin_px)
