"""Dirt, holes and what shines through from the back of the sheet are taken off the paper."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.ink import Mask, ink_threshold
from daemon.page.back import noted
from daemon.page.line_width import line_width_px
from daemon.page.tones import tones
from daemon.shapes import Grey, PageImage

_SPECK_WIDTHS = 0.6
"""What is narrower and shorter than this many line widths no pen has drawn: a pen's dot is as wide as its line."""
_PALE = 0.6
"""Dots are as dark as lines; what reaches only this share of the ink's darkness within its own ink is a stain."""
_STAIN_WIDTHS = 2.0
_HOLE_WIDTHS, _HOLE_SHARE = 4.0, 0.06
_RIM_SHARE = 0.1
_ROUND = 0.72
_WHITE = 255


def clean_paper(page: PageImage) -> PageImage:
    """The page without specks, pale stains and the holes of a punch; else the page itself.

    page: ink and paper spread, as a page is that something was done to; another page is clean already.
    Specks are smaller than the line is wide; stains are no larger than two line widths and paler than the ink; holes
    are round, filled, wider than four lines, and lie near the page's rim by themselves. A dot that the pen has drawn
    is none of these.
    """
    found, threshold = tones(page.grey), ink_threshold(page.grey)
    if not page.steps or found is None or threshold is None:
        return page
    width_px = line_width_px(page.grey)
    if width_px is None:
        return page
    ink = page.grey <= threshold
    count, found_labels, found_stats, _ = cv2.connectedComponentsWithStats(ink.view(np.uint8), connectivity=8)
    labels, stats = np.asarray(found_labels, np.int32), np.asarray(found_stats, np.int32)
    darkest = _darkest(page.grey, labels, count)
    dirty = _specks(stats, width_px) | _stains(stats, darkest, width_px) | _holes(stats, width_px, ink.shape)
    dirty[0] = False
    if not dirty.any():
        return page
    return noted(page, f"dirt taken off: {_counted(int(dirty.sum()))}", _painted_over(page.grey, dirty[labels]))


def _darkest(grey: Grey, labels: NDArray[np.int32], count: int) -> NDArray[np.uint8]:
    """The darkest level of each piece of ink."""
    inked = labels > 0
    darkest = np.full(count, 255, np.uint8)
    np.minimum.at(darkest, labels[inked], grey[inked])
    return darkest


def _specks(stats: NDArray[np.int32], width_px: float) -> NDArray[np.bool_]:
    longest = stats[:, 2:4].max(axis=1)
    return np.asarray(longest <= max(1.0, _SPECK_WIDTHS * width_px))


def _stains(stats: NDArray[np.int32], darkest: NDArray[np.uint8], width_px: float) -> NDArray[np.bool_]:
    small = stats[:, 2:4].max(axis=1) <= _STAIN_WIDTHS * width_px
    return np.asarray(small & (darkest > _WHITE * (1 - _PALE)))


def _holes(stats: NDArray[np.int32], width_px: float, shape: tuple[int, ...]) -> NDArray[np.bool_]:
    left, top, wide, high, area = stats[:, :5].T.astype(float)
    side = min(shape)
    large = (np.minimum(wide, high) >= _HOLE_WIDTHS * width_px) & (np.maximum(wide, high) <= _HOLE_SHARE * side)
    filled = (area >= _ROUND * wide * high) & (np.maximum(wide, high) <= 1.3 * np.minimum(wide, high))
    rim = np.minimum.reduce([left, top, shape[1] - left - wide, shape[0] - top - high])
    return np.asarray(large & filled & (rim <= _RIM_SHARE * side))


def _painted_over(grey: Grey, dirty: Mask) -> Grey:
    """With its pale rim, which belongs to no other ink."""
    around = cv2.dilate(dirty.view(np.uint8), np.ones((5, 5), np.uint8)).view(np.bool_)
    clean = grey.copy()
    clean[around & (dirty | (grey > _WHITE // 2))] = _WHITE
    return clean


def _counted(number: int) -> str:
    return "1 piece" if number == 1 else f"{number} pieces"
