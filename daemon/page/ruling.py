"""Lines printed on the paper, ruled or squared, are taken off where they are fainter than the drawing."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.page.back import noted
from daemon.page.slant import Slant, slant
from daemon.page.tones import Tones, reduced, tones
from daemon.shapes import Grey, PageImage, Points

_LOOK_PX = 1600
_LEAST_SIDE_PX = 100
_PAINTED = 0.6
_STRIPS = 48
_SPANNING = 0.6
"""A printed line is seen in so many of the strips across the page."""
_FAINTEST, _DARKEST = 14.0, 0.6
"""Grey levels below paper; and the share of the ink's darkness from which on a line belongs to the drawing."""
_DRAWN = 0.2
"""Percentile: so little of a page is drawn, at least, as far as print is concerned."""
_FEWEST = 5
_UNEVEN = 0.12
_MOST_MISSING = 3
_LEAST_PITCH_PX = 7.0
_BESIDE_PX = 3.0
_BESIDE_SHARE = 0.25


@dataclass(frozen=True, slots=True, eq=False)
class _Ruling:
    """Where printed lines cross the middle column, in px of the page made small, and how they slant."""

    middles: Points
    slant: Slant
    scale: float

    def rows(self, middle: float, width: int) -> Points:
        """The line's row in px of the page for each of its columns."""
        small = self.slant.rows(middle, np.asarray((np.arange(width) + 0.5) / self.scale - 0.5))
        return np.asarray((small + 0.5) * self.scale - 0.5)


def take_off_ruling(page: PageImage) -> PageImage:
    """The page without its printed lines: parallel, evenly spaced, across the page and fainter than the ink.

    page: evenly lit. Paper and print are layers that each take a share of the light: the print's share is measured
    beside the drawing and given back, so that ink on a printed line stays ink. A page painted by a program, whose paper
    is of one tone, comes back as it is.
    """
    found = tones(page.grey)
    if found is None or min(page.grey.shape) < _LEAST_SIDE_PX or _painted(page.grey, found):
        return page
    most = _DARKEST * _darkness(page.grey, found)
    across = _without(page.grey, found, most)
    down = _without(np.ascontiguousarray((page.grey if across is None else across).T), found, most)
    if down is not None:
        return noted(page, "printed lines taken off", np.ascontiguousarray(down.T))
    return page if across is None else noted(page, "printed lines taken off", across)


def _painted(grey: Grey, found: Tones) -> bool:
    """Whether most of the paper is of one level exactly, as no camera or scanner sees it."""
    return float(np.mean(grey[::3, ::3] == round(found.paper))) >= _PAINTED


def _darkness(grey: Grey, found: Tones) -> float:
    """Grey levels from the paper to the darkest of the drawing, which print may cover with far more of its own."""
    return float(found.paper - np.percentile(reduced(grey, _LOOK_PX), _DRAWN))


def _without(grey: Grey, found: Tones, most: float) -> Grey | None:
    """The page without printed lines that run across it; None where there are none."""
    ruling = _ruling(grey, found, most)
    if ruling is None:
        return None
    bare = grey.copy()
    for middle in ruling.middles:
        _lift(bare, ruling.rows(middle, grey.shape[1]), (found.paper, most), round(ruling.scale * _BESIDE_PX) + 1)
    return bare


def _ruling(grey: Grey, found: Tones, most: float) -> _Ruling | None:
    small = reduced(grey, _LOOK_PX)
    least = max(_FAINTEST, 2.0 * found.grain) if grey.shape == small.shape else _FAINTEST
    dark = np.asarray(np.clip(found.paper - small.astype(np.int16), 0, 255), np.uint8)
    leaning = slant((dark > least) & (dark < most))
    if leaning is None:
        return None
    seen = _in_strips(leaning.level(dark))
    strength = np.median(seen, axis=1)
    share = (seen > least).mean(axis=1)
    peaks = _peaks(np.where((share >= _SPANNING) & (strength < most), strength, 0.0))
    middles = _evenly_spaced(peaks)
    if middles is None:
        return None
    return _Ruling(middles, leaning, grey.shape[1] / small.shape[1])


def _in_strips(level: Grey) -> Points:
    """How dark each row is in each strip across the page, (H, strips): the median, narrow lines only."""
    dark = _medians(level)
    broad = cv2.morphologyEx(dark, cv2.MORPH_OPEN, np.ones((9, 1), np.uint8))
    thin = dark - broad
    # A line may wander by a pixel from strip to strip.
    return np.asarray(cv2.dilate(thin, np.ones((3, 1), np.uint8)), np.float64)


def _medians(rows: NDArray[np.uint8] | NDArray[np.float32]) -> NDArray[np.float32]:
    """(H, strips) of (H, W): the median of each of the strips; the last few columns are left out."""
    wide = max(4, rows.shape[1] // _STRIPS)
    strips = rows.shape[1] // wide
    return np.asarray(np.median(rows[:, : strips * wide].reshape(len(rows), strips, wide), axis=2), np.float32)


def _peaks(strength: Points) -> Points:
    """The middles of the runs that stand out, in px."""
    held = np.concatenate([[0], (strength > 0).astype(np.int8), [0]])
    edges = np.flatnonzero(np.diff(held))
    return (edges[::2] + edges[1::2] - 1) / 2.0


def _evenly_spaced(peaks: Points) -> Points | None:
    """The lines, and those that the drawing hides between them; None where they are too few or not evenly spaced."""
    if len(peaks) < _FEWEST:
        return None
    gaps = np.diff(peaks)
    pitch = float(np.median(gaps))
    steps = np.rint(gaps / pitch)
    even = (np.abs(gaps / pitch - steps) <= _UNEVEN * np.maximum(steps, 1)) & (steps >= 1) & (steps <= _MOST_MISSING)
    if pitch < _LEAST_PITCH_PX or even.mean() < 0.8:
        return None
    between = [
        np.linspace(a, b, int(count), endpoint=False)[1:]
        for a, b, count, is_even in zip(peaks, peaks[1:], steps, even, strict=False)
        if is_even
    ]
    return np.sort(np.concatenate([peaks, *between, *_beyond(peaks, pitch)]))


def _beyond(peaks: Points, pitch: float) -> list[Points]:
    """One more line on either side: where the sheet ends it may not span the page."""
    return [peaks[:1] - pitch, peaks[-1:] + pitch]


def _lift(bare: Grey, rows: Points, levels: tuple[float, float], reach: int) -> None:
    """Give back along one line the light that the print takes, in place. levels: of paper; the most that it takes."""
    paper, most = levels
    height, width = bare.shape
    columns = np.arange(width)
    nearest = np.rint(rows).astype(np.intp)
    rows_at = nearest[None] + np.arange(-reach, reach + 1)[:, None]
    on = (rows_at >= 0) & (rows_at < height)
    if not on.any():
        return
    at = rows_at.clip(0, height - 1)
    seen = bare[at, columns[None]].astype(np.float32)
    taken = _taken(seen, paper, most)
    # What is darker than print is the drawing, which is dark whatever lies below it.
    on &= paper - seen <= most
    lifted = np.minimum(seen * paper / np.maximum(paper - taken, 1.0), 255.0)
    bare[at[on], np.broadcast_to(columns, at.shape)[on]] = np.rint(lifted[on]).astype(np.uint8)


def _taken(seen: NDArray[np.float32], paper: float, most: float) -> NDArray[np.float32]:
    """Grey levels that the print takes, beside each column of its line: of the strips around, without the drawing."""
    dark = paper - _medians(seen)
    around = np.pad(dark, ((0, 0), (2, 2)), mode="edge")
    steady = np.median(np.stack([around[:, i : i + dark.shape[1]] for i in range(5)]), axis=0)
    # Where it is much darker than around the drawing runs along the line.
    held = np.clip(np.where(dark > steady + _BESIDE_SHARE * most, steady, dark), 0, most)
    strip = np.minimum(np.arange(seen.shape[1]) // max(4, seen.shape[1] // _STRIPS), held.shape[1] - 1)
    return np.asarray(held[:, strip], np.float32)
