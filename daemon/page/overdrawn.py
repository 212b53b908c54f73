"""Lines drawn over themselves, as a sketching hand does, are made one: the paper between the passes is closed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.bands import bands
from daemon.ink import Mask, ink_threshold, thin
from daemon.page.back import noted
from daemon.page.line_width import line_width_px
from daemon.page.tones import Tones, tones
from daemon.shapes import Grey, PageImage

_MOST_WIDTHS, _LEAST_WIDTHS = 0.9, 2.5
"""A lens between two passes is at most so wide and at least so long, in line widths."""
_LEAST_SLIM = 8.0
"""And so many times as long as it is wide: what is shorter is the eye of a loop, or where three lines meet."""
_PARTS, _TAPERED, _BLUNT = 5, 0.72, 0.9
"""Of so many parts of its length the outer two are as narrow beside the widest: on the mean; each of them."""
_FEWEST = 3
"""A hand that draws over its lines leaves some; one or two are lines that have come close by chance."""
_BEYOND_WIDTHS, _LEAST_ALONE = (1.5, 3.0), 0.7
"""Beyond the passes, so many line widths from the paper between them, so much is paper; in a hatch there are lines."""
_AROUND_WIDTHS, _SEEN_WIDTHS = 4.0, 16.0
_SPUR_WIDTHS = 1.5


def merge_overdrawn(page: PageImage) -> PageImage:
    """The page with two passes of one line drawn as one in their middle; else the page itself.

    Two passes of one line part and meet again. Between them lies a lens of paper, narrower than the line, closed all
    round and pointed at both ends. Lines that stay apart, as those of a hatch, a double wall or a staff, hold none.
    Where others run beside the two it is a hatch whose lines touch or cross. A page with one or two lenses comes back
    as it is.
    """
    threshold, found = ink_threshold(page.grey), tones(page.grey)
    width_px = line_width_px(page.grey)
    if threshold is None or found is None or width_px is None:
        return page
    lenses = [each for each in _lenses(page.grey, threshold, width_px) if each.is_pointed(page.grey, found, width_px)]
    lenses = [each for each in lenses if each.is_alone(page.grey, threshold, width_px)]
    if len(lenses) < _FEWEST:
        return page
    ink = page.grey <= threshold
    for lens in lenses:
        lens.of(ink)[lens.paper] = True
    grey = page.grey.copy()
    for lens in lenses:
        lens.redraw(grey, ink, found, width_px)
    return noted(page, f"lines drawn over themselves merged in {len(lenses)} places", grey)


@dataclass(frozen=True, slots=True, eq=False)
class _Lens:
    """A closed piece of paper: where its box begins, and which pixels of the box it is, a rim of ink around them."""

    top: int
    left: int
    paper: Mask

    def of(self, page: Grey | Mask, around: int = 0) -> NDArray[np.generic]:
        """What of a page lies in the box, and so many px around it."""
        high, wide = self.paper.shape
        rows = slice(max(0, self.top - around), self.top + high + around)
        return page[rows, max(0, self.left - around) : self.left + wide + around]

    def is_pointed(self, grey: Grey, found: Tones, width_px: float) -> bool:
        """Whether it is slim, long enough, and pointed at both ends."""
        away = cv2.distanceTransform(self.paper.view(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_5)
        # The outermost pixel of paper lies a pixel from the ink, not half a one.
        wide_px = 2 * float(away.max()) - 1
        paper = cv2.dilate(self.paper.view(np.uint8), np.ones((3, 3), np.uint8)) > 0
        y, x = np.nonzero(paper)
        at = np.stack([x, y], axis=1).astype(float)
        at -= at.mean(axis=0)
        along = at @ np.linalg.eigh(at.T @ at)[1][:, 1]
        long_px = float(np.ptp(along)) - 2
        if wide_px > _MOST_WIDTHS * width_px or long_px < max(_LEAST_WIDTHS * width_px, _LEAST_SLIM * wide_px):
            return False
        # How much paper there is in each part, to fractions of a pixel.
        share = (self.of(grey)[y, x].astype(float) - found.full_ink) / (found.paper - found.full_ink)
        parts = np.minimum((_PARTS * (along - along.min()) / np.ptp(along)).astype(np.intp), _PARTS - 1)
        widths = np.bincount(parts, share.clip(0, 1), _PARTS)
        ends = widths[[0, -1]] / widths.max()
        return bool(ends.mean() <= _TAPERED and ends.max() <= _BLUNT)

    def is_alone(self, grey: Grey, threshold: float, width_px: float) -> bool:
        """Whether hardly any other ink lies beside its passes."""
        nearest_px, farthest_px = (widths * width_px for widths in _BEYOND_WIDTHS)
        around = int(np.ceil(farthest_px)) + 1
        here = np.asarray(self.of(grey, around), np.uint8)
        away = cv2.distanceTransform(1 - self._placed(here.shape, around), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
        beyond = here[(away > nearest_px + 0.5) & (away <= farthest_px)]
        return beyond.size == 0 or float((beyond > threshold).mean()) >= _LEAST_ALONE

    def _placed(self, shape: tuple[int, ...], around: int) -> NDArray[np.uint8]:
        """Its paper as 1 in what `of` gives."""
        place = np.zeros(shape, np.uint8)
        top, left = min(around, self.top), min(around, self.left)
        place[top : top + self.paper.shape[0], left : left + self.paper.shape[1]] = self.paper
        return place

    def redraw(self, grey: Grey, ink: Mask, found: Tones, width_px: float) -> None:
        """The ink's middle as wide as a line is, in and beside the lens, in place."""
        around = round(_AROUND_WIDTHS * width_px)
        here = self.of(grey, around)
        middle = _pruned(thin(np.ascontiguousarray(self.of(ink, around))), round(_SPUR_WIDTHS * width_px))
        away = cv2.distanceTransform((~middle).view(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
        cover = np.clip(width_px / 2 + 0.5 - away, 0.0, 1.0)
        drawn = np.rint(found.paper - cover * (found.paper - found.full_ink)).astype(np.uint8)
        side = 2 * round(width_px + 1) + 1
        near = (
            cv2.dilate(self._placed(here.shape, around), cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (side, side))) > 0
        )
        here[near] = drawn[near]


def _lenses(grey: Grey, threshold: float, width_px: float) -> Iterator[_Lens]:
    """Closed pieces of paper that are nowhere much wider than a line; band by band, each once."""
    side = int(np.ceil(_MOST_WIDTHS * width_px)) + 1
    square, cross = np.ones((side, side), np.uint8), cv2.getStructuringElement(cv2.MORPH_CROSS, (3, 3))
    for band in bands(len(grey), halo_px=_SEEN_WIDTHS * width_px):
        paper = np.pad((grey[band.seen] > threshold).view(np.uint8), 1, constant_values=1)
        wide = np.asarray(cv2.morphologyEx(paper, cv2.MORPH_OPEN, square), np.uint8)
        # Beyond the border there is paper, however narrow it is up to there.
        wide[[0, -1]] = wide[:, [0, -1]] = 1
        narrow = paper & (1 - wide)
        if not narrow.any():
            continue
        _, labels, stats, _ = cv2.connectedComponentsWithStats(narrow, connectivity=4)
        closed = np.ones(len(stats), bool)
        closed[labels[cv2.dilate(wide, cross) > 0]] = False
        long = stats[:, 2:4].max(axis=1) >= _LEAST_WIDTHS / np.sqrt(2) * width_px
        for label in np.flatnonzero(closed & long).tolist():
            left, top, across, down, _ = stats[label].tolist()
            if band.own_of_seen.start <= top - 1 < band.own_of_seen.stop:
                piece = labels[top - 1 : top + down + 1, left - 1 : left + across + 1] == label
                yield _Lens(band.seen.start + top - 2, left - 2, piece)


def _pruned(line: Mask, by_px: int) -> Mask:
    """A centre line without branches of up to so many px; its ends stay (conditional dilation, Gonzalez and Woods)."""
    whole, around = line.view(np.uint8), np.ones((3, 3), np.uint8)
    kept = whole.copy()
    for _ in range(by_px):
        kept &= (_neighbours(kept) > 1).view(np.uint8)
    ends = kept & (_neighbours(kept) <= 1).view(np.uint8)
    for _ in range(by_px):
        ends = np.asarray(cv2.dilate(ends, around), np.uint8) & whole & (1 - kept)
        kept |= ends
    return np.asarray(kept).view(np.bool_)


def _neighbours(line: NDArray[np.uint8]) -> NDArray[np.uint8]:
    kernel = np.array([[1, 1, 1], [1, 0, 1], [1, 1, 1]], np.float32)
    return np.asarray(cv2.filter2D(line, cv2.CV_8U, kernel, borderType=cv2.BORDER_CONSTANT), np.uint8)
