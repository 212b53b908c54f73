"""Paper tone and uneven light are taken off a page, and faint ink is made dark."""

from __future__ import annotations

import math

import cv2
import numpy as np

from daemon.page.back import noted
from daemon.page.tones import Tones, reduced, tones
from daemon.shapes import Grey, PageImage

_LOOK_PX = 384
"""Paper is looked at on the page reduced to this side, where grain is averaged away."""
_MARK_SHARE = 10
"""A dark place wider than the page's side (of a square as large) divided by this is paper in shadow, no line."""
_WHITE = 240
_BLACK = 96
_MOST_UNEVEN_SHARE = 0.02
_DARKEST_PAPER_SHARE = 0.35
"""What is darker than this share of the lit paper is filled with ink, no shadow."""
_GRAIN_SHARE = 0.05
_GRAIN_BLUR_PX = 0.8


def flatten_light(page: PageImage) -> PageImage:
    """White paper and black ink where the paper is toned or unevenly lit or the ink is faint; else the page itself.

    A page whose paper is white and whose ink is dark, and a page without ink, come back bit by bit.
    """
    return spread_tones(even_light(page))


def even_light(page: PageImage) -> PageImage:
    """Paper of one tone where it is toned or unevenly lit, shadows on it too; else the page itself.

    The light on the paper is the page with its ink closed away (grey-level closing, Serra 1982), smoothed; the page
    is divided by it.
    """
    bare = _bare_paper(page.grey)
    if _even(bare):
        return page
    flat = _divided(page.grey, bare)
    return page if tones(flat) is None else noted(page, "light evened out", flat)


def spread_tones(page: PageImage) -> PageImage:
    """Ink and paper spread over 0..255 where the ink is faint or something was done to the page; else the page itself.

    Grain that is strong beside the ink is smoothed.
    """
    found = tones(page.grey)
    if found is None or (not page.steps and found.full_ink <= _BLACK):
        return page
    return noted(page, "ink and paper spread", _spread(page.grey, found))


def _bare_paper(grey: Grey) -> Grey:
    """The page reduced to _LOOK_PX, with its lines closed away."""
    small = reduced(grey, _LOOK_PX)
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (_mark_px(small), _mark_px(small)))
    return np.asarray(cv2.morphologyEx(small, cv2.MORPH_CLOSE, kernel), np.uint8)


def _mark_px(small: Grey) -> int:
    return int(max(5, math.sqrt(small.size) / _MARK_SHARE)) | 1


def _even(bare: Grey) -> bool:
    return bool(np.mean((bare < _WHITE) & (bare > _darkest_paper(bare))) <= _MOST_UNEVEN_SHARE)


def _darkest_paper(bare: Grey) -> int:
    return max(1, int(_DARKEST_PAPER_SHARE * np.percentile(bare, 95)))


def _divided(grey: Grey, bare: Grey) -> Grey:
    light = cv2.GaussianBlur(np.maximum(bare, _darkest_paper(bare)), (0, 0), _mark_px(bare) / 6)
    full = cv2.resize(light, grey.shape[::-1], interpolation=cv2.INTER_LINEAR)
    return np.asarray(cv2.divide(grey, full, scale=255), np.uint8)


def _spread(grey: Grey, found: Tones) -> Grey:
    """Ink to 0 and paper, with most of its grain, to 255."""
    if found.grain > _GRAIN_SHARE * (found.paper - found.ink):
        grey = np.asarray(cv2.GaussianBlur(grey, (0, 0), _GRAIN_BLUR_PX), np.uint8)
        found = tones(grey) or found
    white = found.paper - min(1.5 * found.grain, (found.paper - found.ink) / 3)
    levels = np.clip((np.arange(256) - found.ink) * (255 / (white - found.ink)), 0, 255)
    return np.asarray(cv2.LUT(grey, np.rint(levels).astype(np.uint8)), np.uint8)
