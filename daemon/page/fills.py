"""Filled areas: ink so wide that no pen stroke has left it. Their rim is kept, hatched or not, or nothing of them."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal, TypeAlias

import cv2
import numpy as np

from daemon.bands import bands
from daemon.ink import Mask, ink_mask
from daemon.page.back import noted
from daemon.page.hatch import Hatch
from daemon.shapes import Grey, PageImage

Fill: TypeAlias = Literal["outline", "skip"] | Hatch

LEAST_WIDTHS = 12.0
"""Ink is no line where it is more than so many line widths across."""
LONGEST = 10.0
"""A stroke of a wider pen is longer than so many of its own widths."""
_RIM_PX = 2.0
_WORDS = {"outline": "drawn as outlines", "skip": "left out"}


def hollow(page: PageImage, *, fill: Fill = "outline") -> PageImage:
    """The page without the inside of its filled areas; with "skip" without their rims, too; with a hatch as lines.

    page: its line width known. A filled area is more than twelve line widths across and less than ten times as long as
    it is wide: a longer one is the stroke of a wider pen. The rim that is left is one line width wide. A page without
    filled areas comes back as it is.
    """
    if page.line_width_px is None:
        return page
    inside, count = _insides(ink_mask(page.grey), page.line_width_px)
    if not count:
        return page
    bare = inside if fill != "skip" else grown(inside, page.line_width_px + _RIM_PX)
    done = "hatched" if isinstance(fill, Hatch) else _WORDS[fill]
    words = f"{count} filled {'area is' if count == 1 else 'areas are'} {done}"
    lines = fill.lines(inside, grown(inside, page.line_width_px / 2)) if isinstance(fill, Hatch) else ()
    return replace(noted(page, words, _blank(page.grey, bare)), hatching=lines)


def _insides(ink: Mask, width_px: float) -> tuple[Mask, int]:
    """The ink of filled areas farther than a line width from paper, and how many areas there are."""
    core_px = LEAST_WIDTHS / 2 * width_px
    depth = np.zeros(ink.shape, np.float16)
    for band in bands(len(ink), halo_px=2 * core_px + 2):
        away = cv2.distanceTransform(ink[band.seen].view(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_5)
        depth[band.own] = np.minimum(away[band.own_of_seen], np.float32(6e4))
    if not (depth > core_px).any():
        return np.zeros((0, 0), bool), 0
    inner = depth > width_px
    _, labels, stats, _ = cv2.connectedComponentsWithStats(inner.view(np.uint8), connectivity=4)
    deepest = np.zeros(len(stats), np.float32)
    core = depth > core_px
    np.maximum.at(deepest, np.asarray(labels[core], np.intp), depth[core].astype(np.float32))
    across = 2 * np.maximum(deepest - width_px, 1e-9)
    filled = (deepest > core_px) & (stats[:, cv2.CC_STAT_AREA] <= LONGEST * across**2)
    filled[0] = False
    return np.asarray(filled[labels]), int(filled.sum())


def grown(mask: Mask, by_px: float) -> Mask:
    """The mask and what lies no farther from it."""
    side = 2 * int(np.ceil(by_px)) + 1
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (side, side))
    return np.asarray(cv2.dilate(mask.view(np.uint8), disc)).view(np.bool_)


def _blank(grey: Grey, where: Mask) -> Grey:
    """Paper there."""
    ink = ink_mask(grey)
    paper = np.median(grey[~ink]) if not ink.all() else 255
    return np.where(where, np.uint8(paper), grey)
