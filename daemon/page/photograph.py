"""A picture that is no drawing at all: mostly grey tones, as a photograph is."""

from __future__ import annotations

import cv2
import numpy as np

from daemon.page.tones import reduced
from daemon.page.working_range import warned
from daemon.shapes import PageImage

_LOOK_PX, _LEAST_PX = 640, 128
_MARK_PX = 31
"""On the page made small the median over so many px holds no lines any more, only what is paper or toned area."""
_DARKEST, _LIGHTEST = 0.2, 0.82
"""Shares of the paper's light: what is darker is filled with ink, what is lighter is paper."""
_MOST = 0.16


def warned_of_photograph(page: PageImage) -> PageImage:
    """The page, with a warning where more than a sixth of it is neither paper nor ink. page: evenly lit."""
    if min(page.grey.shape) < _LEAST_PX:
        return page
    small = cv2.medianBlur(reduced(page.grey, _LOOK_PX), _MARK_PX)
    paper = np.percentile(small, 95)
    grey = float(np.mean((small > _DARKEST * paper) & (small < _LIGHTEST * paper)))
    if grey <= _MOST:
        return page
    return warned(
        page,
        f"this looks like a photograph: {100 * grey:.0f} % of it is grey, neither paper nor ink; lines are drawn where "
        "its tones meet: give a line drawing, or trace it by hand first",
    )
