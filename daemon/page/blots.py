"""Blots: small filled areas, such as a note's head. Each becomes its rim and a line to and fro that inks it full."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import replace

import cv2
import numpy as np

from daemon.bands import bands
from daemon.components import components
from daemon.ink import Mask, ink_mask
from daemon.page.back import noted
from daemon.page.fills import LEAST_WIDTHS, grown
from daemon.page.hatch import Hatch
from daemon.shapes import Map, PageImage, Points

_THINNEST = 3.5
"""Ink is no line where it is more than so many line widths across, and round."""
_ROUND = 2.5
"""What lies within the rim is no larger than so many squares as wide as it is across: longer ink is a thick stroke."""
_FREE = 0.6
"""So much of its outline lies beside paper: where many lines meet their ink is wide, too."""
_SPACING = 0.85
"""Of the lines to and fro, in line widths: the pen leaves no paper between them."""
_MOST = 1000
"""A page of more is a screen of dots, not a drawing, and left as it is."""


def rimmed(page: PageImage) -> PageImage:
    """The page with the rims of its blots alone, one line width wide, and in `fills` the lines that ink their insides.

    page: its line width known, larger areas taken off. A page without blots, or with more
    than a thousand, comes back as it is.
    """
    if page.line_width_px is None:
        return page
    ink = ink_mask(page.grey)
    found = list(itertools.islice(_blots(ink, page.line_width_px), _MOST + 1))
    if not found or len(found) > _MOST:
        return page
    grey, lines, count = page.grey.copy(), list[Points](), len(found)
    paper = np.median(grey[~ink])
    for box, blot, around in found:
        bare = _bare(ink[box], around, page.line_width_px)
        grey[box] = np.rint(grey[box] + (paper - grey[box]) * bare)
        corner = np.array([box[1].start, box[0].start], float)
        lines += [line + corner for line in Hatch(_SPACING * page.line_width_px).lines(blot, around, apart_px=np.inf)]
    words = f"{count} small filled {'area is' if count == 1 else 'areas are'} inked to and fro"
    return replace(noted(page, words, grey), fills=tuple(lines))


def _blots(ink: Mask, width_px: float) -> Iterator[tuple[tuple[slice, slice], Mask, Mask]]:
    """Of each blot a box, the ink in it farther than a line width from paper, and the same up to the rim's middle."""
    inner, deep = np.zeros(ink.shape, bool), np.zeros(ink.shape, bool)
    for band in bands(len(ink), halo_px=_THINNEST * width_px + 2):
        away = cv2.distanceTransform(ink[band.seen].view(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_5)[band.own_of_seen]
        inner[band.own], deep[band.own] = away > width_px, away > _THINNEST / 2 * width_px
    if not deep.any():
        return
    pieces, margin = components(inner), int(np.ceil(width_px)) + 2
    for label in np.unique(pieces.at(*np.nonzero(deep))).tolist():
        left, top, wide, high, area = pieces.stats[label].tolist()
        if max(wide, high) > _ROUND * LEAST_WIDTHS * width_px:
            continue
        rows = slice(max(0, top - margin), top + high + margin)
        box = rows, slice(max(0, left - margin), left + wide + margin)
        blot = np.zeros(ink[box].shape, bool)
        blot[top - box[0].start :, left - box[1].start :][:high, :wide] = pieces.piece(label)
        deepest = float(cv2.distanceTransform(np.pad(blot, 1).view(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_5).max())
        if area <= _ROUND * (2 * deepest) ** 2 and _free(blot, ink[box], width_px):
            yield box, blot, grown(blot, width_px / 2) & ink[box]


def _bare(ink: Mask, around: Mask, width_px: float) -> Map:
    """How much of each pixel lies within the rim, 0 to 1: a hard edge would make the middle of the rim rough."""
    away = cv2.distanceTransform(ink.view(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    return np.asarray(np.where(around, (away - width_px).clip(0, 1), 0), np.float32)


def _free(blot: Mask, ink: Mask, width_px: float) -> bool:
    """Whether most of what surrounds it and its rim is paper."""
    beside = grown(blot, width_px + 1) & ~grown(blot, width_px)
    return bool((beside & ~ink).sum() >= _FREE * beside.sum())
