"""Filled areas become parallel lines, connected to and fro where the way stays inside."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from daemon.ink import Mask
from daemon.shapes import Points

_STEP_PX = 0.5
_GAP_PX = 2.0
_LEAST_PX = 0.5
"""Spacing: below it the area is full long since."""
_MOST_APART = 4.0
"""So many spacings a way may be long that leads from one line into the next: a longer one would show."""


@dataclass(frozen=True, slots=True)
class Hatch:
    """Lines `spacing_px` apart that rise by `angle_deg` to the right, and with `cross` others at a right angle."""

    spacing_px: float
    angle_deg: float = 45.0
    cross: bool = False

    def lines(self, inside: Mask, around: Mask, *, apart_px: float | None = None) -> tuple[Points, ...]:
        """What fills the areas, each (N, 2) in px.

        inside: bool (H, W), the areas. around: the same and their rims, within which one line goes on into the next.
        apart_px: so long a way may be that leads from one line into the next; four spacings unless it is said.
        """
        angles = [self.angle_deg, self.angle_deg + 90][: 2 if self.cross else 1]
        spacing_px = max(self.spacing_px, _LEAST_PX)
        most_px = _MOST_APART * spacing_px if apart_px is None else apart_px
        rows = [_rows(inside, angle, spacing_px) for angle in angles]
        return tuple(line for each in rows for line in _connected(each, around, most_px))


def _rows(inside: Mask, angle_deg: float, spacing_px: float) -> list[list[Points]]:
    """For each hatch line its pieces inside, (2, 2) each, in order along it."""
    angle = np.radians(angle_deg)
    along, across = np.array([np.cos(angle), -np.sin(angle)]), np.array([np.sin(angle), np.cos(angle)])
    y, x = np.nonzero(inside)
    if not len(x):
        return []
    ways, asides = x * along[0] + y * along[1], x * across[0] + y * across[1]
    steps = np.arange(ways.min() - 1, ways.max() + 1 + _STEP_PX, _STEP_PX)
    # One line through the middle of what is inked: a small area gets one, too.
    middle = (asides.min() + asides.max()) / 2
    count = int((asides.max() - middle) / spacing_px)
    offsets = middle + spacing_px * np.arange(-count, count + 1)
    return [_pieces(inside, steps[:, None] * along + offset * across) for offset in offsets]


def _pieces(inside: Mask, points: Points) -> list[Points]:
    """The runs of points that lie inside, as (first, last); along a slanted edge pixels leave gaps that are none."""
    held = np.concatenate([[False], _within(inside, points), [False]])
    edges = np.flatnonzero(np.diff(held.astype(np.int8)))
    apart = np.diff(edges)[1::2] * _STEP_PX > _GAP_PX
    edges = edges[np.concatenate([[True], np.repeat(apart, 2), [True]])] if len(edges) else edges
    return [points[[first, end - 1]] for first, end in zip(edges[::2], edges[1::2], strict=True) if end - first > 1]


def _within(mask: Mask, points: Points) -> Mask:
    x, y = np.rint(points).astype(np.intp).T
    on = (x >= 0) & (y >= 0) & (x < mask.shape[1]) & (y < mask.shape[0])
    return np.asarray(on & mask[np.where(on, y, 0), np.where(on, x, 0)])


def _connected(rows: list[list[Points]], around: Mask, most_px: float) -> list[Points]:
    """The pieces as few lines: each goes on into a piece of the next row whose nearer end is reached inside."""
    lines = []
    for number, row in enumerate(rows):
        while row:
            line = [row.pop(0)]
            for below in rows[number + 1 :]:
                onward = _onward(line[-1][1], below, around, most_px)
                if onward is None:
                    break
                line.append(onward)
            lines.append(np.concatenate(line))
    return lines


def _onward(here: Points, below: list[Points], around: Mask, most_px: float) -> Points | None:
    """The piece of the next row to go on with, taken out of it, from the end where it is reached."""
    turned = [(float(np.hypot(*(each[end] - here))), i, end) for i, each in enumerate(below) for end in (0, 1)]
    for far, index, end in sorted(turned):
        if far > most_px:
            break
        way = here + (below[index][end] - here) * np.linspace(0, 1, int(far / _STEP_PX) + 2)[:, None]
        if _within(around, way).all():
            piece = below.pop(index)
            return piece if end == 0 else piece[::-1]
    return None
