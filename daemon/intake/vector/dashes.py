"""A dashed line is drawn as dashes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from daemon.polyline import lengths_along, places_at
from daemon.shapes import Points

_MOST = 20_000
_SHORTEST_MM = 0.05


def dashed(line: Points, pattern_mm: Sequence[float]) -> list[Points]:
    """The dashes of a line, in mm; the line itself where the pattern is empty, too fine or too long to be followed.

    pattern_mm: dash, gap, dash, gap ... as long as the line lasts; an even number of them, none negative. The first
    dash begins where the line does.
    """
    if len(line) < 2 or len(pattern_mm) < 2 or max(pattern_mm[1::2]) < _SHORTEST_MM:
        return [line]
    at = lengths_along(line)
    if at[-1] / sum(pattern_mm) * len(pattern_mm) > _MOST:
        return [line]
    found: list[Points] = []
    start = 0.0
    while start < at[-1]:
        for dash, gap in zip(pattern_mm[::2], pattern_mm[1::2], strict=True):
            end = min(start + dash, at[-1])
            if start <= at[-1]:
                found.append(_part(line, at, start, end))
            start += dash + gap
    return found


def _part(line: Points, at: Points, start: float, end: float) -> Points:
    stops = np.r_[start, at[(at > start) & (at < end)], end] if end > start else np.array([start])
    return places_at(stops, line, at)
