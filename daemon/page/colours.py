"""Which pen drew which line: by the colours of the given picture along it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.colours import BLACK, Pens, Rgb
from daemon.homography import through
from daemon.page.back import given_px
from daemon.polyline import lengths_along, places_at
from daemon.shapes import Colours, Drawing, PageImage, Points, Stroke

_STEP_PX, _DISC_SHARE = 1.5, 0.3
"""Along a line it is looked so often, in a disc of this share of its width."""
_LEAST_REACH_PX = 1.0
"""Of the colours, which a JPEG keeps half as finely as its greys."""
_LOOK_PX, _MARK_SHARE = 384, 10
"""Paper is looked at on the picture made so small; a mark wider than this share of its side is paper."""
_DARK = 128
_SURE_LAB = 40.0
"""A line that is so far from the colour of a pen is as little its as any."""
_TOWARDS_FULL = 0.05
"""Where two pens have colours of one tone, the one whose full colour is nearer has it."""
_CHANGE_WIDTHS = 1.5
"""What a change of pen costs: so much of a line, in its widths, of surely another colour; twice that for a crossing."""
_SNAP_WIDTHS = 2.0
"""A change so near to a place where lines meet lies there."""


def by_pen(drawing: Drawing, page: PageImage, corners: Points, pens: Pens) -> Drawing:
    """The same lines, each with its pen, cut where the pen changes; without those of pens that are left out.

    drawing: in px of the page. corners: (V, 2), where lines meet. A page without `colour` is all black.

    Ink and paper mix along a straight way from the colour of the paper, the picture's own light taken off, to that of
    the pen (CIELAB): the pen to whose way a line's colour is nearest has drawn it. Along a stroke the pens are those
    that fit best altogether (Viterbi 1967), where a change costs more than a line that crosses the stroke hides of it.
    """
    if page.colour is None:
        only = pens.nearest(BLACK)
        return replace(drawing, strokes=tuple(replace(stroke, pen=only) for stroke in drawing.strokes))
    look, meet = _Look(page, page.colour, pens.colours), {corner.tobytes() for corner in corners}
    parts = (part for stroke in drawing.strokes for part in _parts(stroke, look, meet))
    return replace(drawing, strokes=tuple(part for part in parts if part.pen not in pens.skip))


class _Look:
    """The colours of a picture along lines of its page. width_px: of these lines, on the page."""

    def __init__(self, page: PageImage, colour: Colours, pens: Sequence[Rgb]) -> None:
        self.width_px = page.line_width_px or 1.0
        self._page, self._colour, self._shrunk = page, colour, colour.shape[1] / page.given_width_px
        reach = max(_LEAST_REACH_PX, _DISC_SHARE * self.width_px * given_px(page) * self._shrunk)
        self._disc = reach * np.array([(x, y) for x in (-1, 0, 1) for y in (-1, 0, 1)])
        self._light = _light(colour)
        dark = float(np.median(self._light)) * 255 < _DARK
        paper = np.median(self._light, axis=(0, 1)) if dark else np.ones(3)
        if dark:
            self._light = np.ones((1, 1, 3), np.float32)
        self._paper = _lab(np.asarray(paper, np.float32)[None])[0]
        self._pens = _lab(np.array(pens)[:, ::-1] / 255) - self._paper

    def costs(self, points: Points) -> NDArray[np.float64]:
        """By how much each point is unlike each pen, 0 to 1. points: (N, 2) in px of the page. Returns (N, pens)."""
        ink = self._ink(points)[:, None]
        share = np.clip((ink * self._pens).sum(axis=2) / (self._pens**2).sum(axis=1), 0.0, 1.0)
        aside = np.linalg.norm(ink - share[..., None] * self._pens, axis=2)
        from_full = np.linalg.norm(ink - self._pens, axis=2)
        return np.asarray(np.minimum(1.0, (aside + _TOWARDS_FULL * from_full) / _SURE_LAB), float)

    def _ink(self, points: Points) -> NDArray[np.float32]:
        """How the ink differs from the paper, (N, 3); of the disc round a point the strongest counts most."""
        middle = (through(self._page.to_given, points) + 0.5) * self._shrunk - 0.5
        height, width = self._colour.shape[:2]
        x, y = np.rint(middle[:, None] + self._disc).astype(int).transpose(2, 0, 1)
        x, y = x.clip(0, width - 1), y.clip(0, height - 1)
        light = self._light[y * self._light.shape[0] // height, x * self._light.shape[1] // width]
        seen = np.minimum(self._colour[y, x].astype(np.float32) / 255 / light, 1.0)
        ink = (_lab(seen.reshape(-1, 3)) - self._paper).reshape(seen.shape)
        weight = (ink**2).sum(axis=2, keepdims=True) + 1e-6
        return np.asarray((ink * weight).sum(axis=1) / weight.sum(axis=1), np.float32)


def _light(colour: Colours) -> NDArray[np.float32]:
    """The picture made small, its lines closed away in each colour: the light on its paper, 0 to 1."""
    scale = min(1.0, _LOOK_PX / max(colour.shape))
    small = cv2.resize(colour, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA) if scale < 1 else colour
    side = max(5, max(small.shape) // _MARK_SHARE) | 1
    bare = cv2.morphologyEx(small, cv2.MORPH_CLOSE, cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (side, side)))
    smooth = cv2.GaussianBlur(bare, (0, 0), side / 6)
    return np.maximum(np.asarray(smooth, np.float32) / 255, 0.02)


def _lab(colours: NDArray[np.floating]) -> NDArray[np.float32]:
    """(N, 3) of blue, green, red from 0 to 1 to CIE L*a*b*."""
    rows = np.asarray(colours, np.float32).reshape(-1, 1, 3)
    return np.asarray(cv2.cvtColor(rows, cv2.COLOR_BGR2LAB), np.float32).reshape(-1, 3)


def _parts(stroke: Stroke, look: _Look, meet: set[bytes]) -> Iterator[Stroke]:
    """The stroke, in parts of one pen each; where it changes both parts hold the point."""
    along = lengths_along(stroke.points)
    looks = np.linspace(0.0, along[-1], max(1, round(along[-1] / _STEP_PX)) + 1)
    costs = look.costs(places_at(looks, stroke.points, along))
    pens = _cheapest(costs, _CHANGE_WIDTHS * look.width_px * len(looks) / max(float(along[-1]), 1.0))
    changes = np.flatnonzero(np.diff(pens))
    cuts = [_snapped((looks[at] + looks[at + 1]) / 2, stroke, along, look.width_px, meet) for at in changes]
    ends = sorted({0.0, *cuts, float(along[-1])})
    for start, end in pairwise(ends if len(ends) > 1 else [0.0, 0.0]):
        pen = int(pens[np.searchsorted(looks, (start + end) / 2).clip(0, len(pens) - 1)])
        yield Stroke(_between(stroke.points, along, start, end), pen) if cuts else replace(stroke, pen=pen)


def _cheapest(costs: NDArray[np.float64], change: float) -> NDArray[np.int64]:
    """Which pen each point has so that all costs and those of the changes are least. costs: (N, pens)."""
    pens = np.asarray(costs.argmin(axis=1), np.int64)
    if (pens == pens[0]).all():
        return pens
    total, came = costs[0], []
    for cost in costs[1:]:
        best = int(total.argmin())
        changed = total[best] + change < total
        came.append(np.where(changed, best, np.arange(len(total))))
        total = np.where(changed, total[best] + change, total) + cost
    pens[-1] = total.argmin()
    for at in range(len(came) - 1, -1, -1):
        pens[at] = came[at][pens[at + 1]]
    return pens


def _snapped(at: float, stroke: Stroke, along: NDArray[np.float64], width_px: float, meet: set[bytes]) -> float:
    near = np.flatnonzero(abs(along - at) <= _SNAP_WIDTHS * width_px)
    found = [float(along[index]) for index in near if stroke.points[index].tobytes() in meet]
    return min(found, key=lambda each: abs(each - at), default=float(at))


def _between(points: Points, along: NDArray[np.float64], start: float, end: float) -> Points:
    """The part of a polyline between two lengths along it; its own points stay as they are."""
    inside = points[(along > start) & (along < end)]
    first, last = places_at(np.array([start, end]), points, along)
    return np.concatenate([first[None], inside, last[None]])
