"""Dirt, holes and what shines through from the back of the sheet are taken off the paper."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from daemon.ink import ink_threshold
from daemon.page.back import noted
from daemon.page.line_width import line_width_px
from daemon.shapes import Grey, PageImage

_SPECK_WIDTHS = 0.6
"""What is narrower and shorter than this many line widths no pen has drawn: a pen's dot is as wide as its line."""
_PALE = 0.6
"""Dots are as dark as lines; what reaches only this share of the ink's darkness within its own ink is a stain."""
_STAIN_WIDTHS = 2.0
_HOLE_WIDTHS, _HOLE_SHARE = 4.0, 0.06
_RIM_SHARE = 0.1
_ROUND, _LONGEST = 0.72, 1.3
_WHITE = 255


def clean_paper(page: PageImage) -> PageImage:
    """The page without specks, pale stains and the holes of a punch; else the page itself.

    page: ink and paper spread, as a page is that something was done to; another page is clean already. Dirt lies by
    itself, a line's width from everything else that is darker than paper. Specks are smaller than the line is wide;
    stains are no larger than two line widths and paler than the ink; holes are round, filled, wider than four lines,
    and lie near the page's rim. A dot that the pen has drawn is none of these, nor is a piece of a faint line.
    """
    threshold = ink_threshold(page.grey) if page.steps else None
    width_px = None if threshold is None else line_width_px(page.grey)
    if threshold is None or width_px is None:
        return page
    pale = (page.grey <= (threshold + _WHITE) / 2).view(np.uint8)
    apart_px = max(1, round(width_px))
    grown = cv2.dilate(pale, np.ones((2 * apart_px + 1, 2 * apart_px + 1), np.uint8))
    outlines, kinds = cv2.findContours(grown, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_SIMPLE)
    outer = [] if kinds is None else [line for line, kind in zip(outlines, kinds[0], strict=True) if kind[3] < 0]
    boxes = [cv2.boundingRect(outline) for outline in outer]
    pieces = [_Piece(left, top, wide, high, apart_px) for left, top, wide, high in boxes]
    dirt = [piece for piece in pieces if piece.is_dirt(page.grey, threshold, width_px)]
    return noted(page, f"dirt taken off: {_counted(len(dirt))}", _without(page.grey, dirt)) if dirt else page


@dataclass(frozen=True, slots=True)
class _Piece:
    """A piece of what is darker than paper, with a rim of paper of `apart` px around it: its box in px."""

    left: int
    top: int
    wide: int
    high: int
    apart: int

    def of(self, grey: Grey) -> Grey:
        """What lies in the box."""
        return grey[self.top : self.top + self.high, self.left : self.left + self.wide]

    def is_dirt(self, grey: Grey, threshold: float, width_px: float) -> bool:
        """Whether no pen has drawn it. Large pieces are not looked at."""
        side = min(grey.shape)
        across = max(self.wide, self.high) - 2 * self.apart
        if across > max(_STAIN_WIDTHS * width_px, _HOLE_SHARE * side):
            return False
        inked = self.of(grey) <= threshold
        rims = (inked[0], inked[-1], inked[:, 0], inked[:, -1])
        if not inked.any() or (min(inked.shape) > 2 and any(rim.any() for rim in rims) and not self._at_border(grey)):
            return False
        wide, high = int(inked.any(axis=0).sum()), int(inked.any(axis=1).sum())
        if max(wide, high) <= max(1.0, _SPECK_WIDTHS * width_px):
            return True
        if across <= _STAIN_WIDTHS * width_px and self.of(grey).min() > _WHITE * (1 - _PALE):
            return True
        filled = inked.sum() >= _ROUND * wide * high and max(wide, high) <= _LONGEST * min(wide, high)
        far = [self.left, self.top, grey.shape[1] - self.left - self.wide, grey.shape[0] - self.top - self.high]
        return bool(filled and min(wide, high) >= _HOLE_WIDTHS * width_px and min(far) <= _RIM_SHARE * side)

    def _at_border(self, grey: Grey) -> bool:
        high, wide = grey.shape
        return self.left == 0 or self.top == 0 or self.left + self.wide == wide or self.top + self.high == high


def _without(grey: Grey, dirt: list[_Piece]) -> Grey:
    clean = grey.copy()
    for piece in dirt:
        piece.of(clean)[:] = _WHITE
    return clean


def _counted(number: int) -> str:
    return "1 piece" if number == 1 else f"{number} pieces"
