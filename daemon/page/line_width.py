"""How wide the pen's line is, and the page brought to the scale at which the network reads it best."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.page.tones import Tones, tones
from daemon.remembered import remembered
from daemon.shapes import Grey, Homography, PageImage

BEST_PX = 2.5
NARROWEST_PX, WIDEST_PX = 1.8, 3.5
_SMALL_PX, _WIDEST_OF_SMALL_PX = 512, 4.0
"""A small picture has no resolution to spare: blur makes its lines look wide, and reduced they would run together."""
MOST_SIDE_PX = 4096

_CELL_PX = 32
_WIDTHS_A_CELL = 6
_MELTED, _LEAST_CELLS = 1.5, 12
_LEAST_INK = 0.1
"""Less than this share of full ink is grain."""
_LEAST_DARKEST = 0.35
"""A cell without any darker ink holds a stain, or what is left of a printed line."""


def fit_line_width(page: PageImage) -> PageImage:
    """The page with its line width known, and scaled so that lines come to about 2.5 px unless they are 1.8 to 3.5.

    A page without ink comes back as it is. Reduced by area averaging, enlarged by cubic interpolation; `to_given`
    follows, pixel centres at whole numbers. No side is enlarged beyond 4096 px; a page larger than that is reduced
    towards it as far as its lines stay 1.8 px wide.
    """
    width_px = line_width_px(page.grey)
    if width_px is None:
        return page
    scale = _scale(width_px, max(page.grey.shape))
    if scale == 1.0:
        return replace(page, line_width_px=width_px)
    return replace(_scaled(page, scale), line_width_px=width_px * scale)


@remembered
def line_width_px(grey: Grey) -> float | None:
    """Full width of the pen's line in px, None where the page holds no ink.

    grey: uint8 (H, W), dark ink on light paper. The ink of a line is its length times its width, its outline twice
    its length; and the outline is the integral of the gradient (coarea formula), which needs no threshold and holds
    for lines thinner than a pixel. Median over cells of the page, each counted by its outline, so that filled areas
    do not outvote the lines; where cells differ much the thinnest say how wide the pen is.
    """
    found = tones(grey)
    if found is None:
        return None
    median_px, usual_px = _cell_widths(grey, found, _CELL_PX)
    if _WIDTHS_A_CELL * median_px > _CELL_PX:
        _, usual_px = _cell_widths(grey, found, round(_WIDTHS_A_CELL * median_px))
    return usual_px


def _cell_widths(grey: Grey, found: Tones, cell_px: int) -> tuple[float, float]:
    """The median and the usual width of all cells; band by band, so that memory does not grow with the page."""
    padded = np.pad(grey, 1, mode="constant", constant_values=255)
    bands = [_band(padded[top : top + cell_px + 1], found, cell_px) for top in range(0, len(padded) - 1, cell_px)]
    area, outline, above, darkest = np.stack(bands, axis=1)
    outline[:-1] += above[1:]
    held = (outline > 0) & (area > 0) & (darkest >= _LEAST_DARKEST)
    return _usual(2 * area[held] / outline[held], outline[held])


def _band(rows: Grey, found: Tones, cell_px: int) -> NDArray[np.float64]:
    """Ink and outline of each cell of a band, outline of the cells above, and the darkest of its ink, (4, N).

    rows: of the band, and one row and one column above and left of them. A piece of outline belongs to the darkest of
    its pixels: along the rim between two cells all of a line may lie in one of them.
    """
    ink = np.clip((found.paper - rows.astype(np.float32)) / (found.paper - found.full_ink), 0.0, 1.0)
    ink[ink < _LEAST_INK] = 0.0
    outline = np.hypot(np.diff(ink, axis=1)[1:], np.diff(ink, axis=0)[:, 1:])
    here, left, over = ink[1:, 1:], ink[1:, :-1], ink[:-1, 1:]
    to_left, to_above = (left > here) & (left >= over), (over > here) & (over > left)
    own = np.zeros_like(ink)
    own[1:, 1:] = np.where(to_left | to_above, 0.0, outline)
    own[1:, :-1] += np.where(to_left, outline, 0.0)
    own[:-1, 1:] += np.where(to_above, outline, 0.0)
    starts = np.arange(0, here.shape[1], cell_px)
    sums = (here.sum(axis=0), own[1:, 1:].sum(axis=0), own[0, 1:])
    darkest = np.maximum.reduceat(here.max(axis=0), starts)
    return np.stack([*(np.add.reduceat(each, starts) for each in sums), darkest]).astype(float)


def _usual(widths: NDArray[np.float64], weights: NDArray[np.float64]) -> tuple[float, float]:
    """The median and, where widths are far apart, the thinnest tenth instead: melted lines are no wide lines."""
    order = np.argsort(widths)
    below = np.cumsum(weights[order])
    thin, fifth, median, wide = widths[order][np.searchsorted(below, below[-1] * np.array([0.1, 0.2, 0.5, 0.7]))]
    melted = wide > _MELTED * fifth and len(widths) >= _LEAST_CELLS
    return float(median), float(thin if melted else median)


def _scale(width_px: float, side_px: int) -> float:
    widest_px = WIDEST_PX if side_px > _SMALL_PX else _WIDEST_OF_SMALL_PX
    scale = 1.0 if NARROWEST_PX <= width_px <= widest_px else BEST_PX / width_px
    if side_px * scale > MOST_SIDE_PX:
        narrowest = min(1.0, NARROWEST_PX / width_px)
        scale = max(MOST_SIDE_PX / side_px, min(scale, narrowest))
    return scale


def _scaled(page: PageImage, scale: float) -> PageImage:
    height_px, width_px = page.grey.shape
    wide, high = max(1, round(width_px * scale)), max(1, round(height_px * scale))
    how = cv2.INTER_AREA if scale < 1 else cv2.INTER_CUBIC
    grey = np.asarray(cv2.resize(page.grey, (wide, high), interpolation=how), np.uint8)
    return replace(page, grey=grey, to_given=page.to_given @ _back(width_px / wide, height_px / high))


def _back(across: float, down: float) -> Homography:
    """From the scaled page back to the page, whose pixel edges lie at -0.5."""
    return np.array([[across, 0.0, (across - 1) / 2], [0.0, down, (down - 1) / 2], [0.0, 0.0, 1.0]])
