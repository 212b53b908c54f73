"""A page taken in bands of rows: what is large for each pixel exists for one band at a time."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

BAND_PX = 512


@dataclass(frozen=True, slots=True)
class Band:
    """seen: the rows that are looked at; own: those of them that this band answers for, of the page and of `seen`."""

    seen: slice
    own: slice
    own_of_seen: slice


def bands(height_px: int, *, halo_px: float = 0.0) -> Iterator[Band]:
    """Bands whose own rows are all rows of a page once; each sees halo_px more above and below, where there are any."""
    halo = math.ceil(halo_px)
    for top in range(0, height_px, BAND_PX):
        first, end = max(0, top - halo), min(height_px, top + BAND_PX)
        yield Band(slice(first, min(height_px, end + halo)), slice(top, end), slice(top - first, end - first))
