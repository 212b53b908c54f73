"""Light lines on dark paper are turned into dark lines on light paper."""

from __future__ import annotations

import cv2
import numpy as np

from daemon.page.back import noted
from daemon.page.tones import reduced
from daemon.shapes import Grey, PageImage

_LOOK_PX = 512
"""The decision is made on the page reduced to this side."""
_MIDDLE = 128
_WINDOW_SHARE, _RIM_SHARE = 8, 32


def turn_dark(page: PageImage) -> PageImage:
    """The page's negative when its paper is dark and its lines are light; otherwise the page itself.

    Paper that is dark in the middle and along the rim is not enough: a page in deep shadow is dark, too, and its
    lines are darker still. What stands out from the median around it tells (third moment: grain, which goes both
    ways, has no say). A page that is black all over becomes white: an empty page, not a page full of ink.
    """
    small = reduced(page.grey, _LOOK_PX)
    if np.median(small) >= _MIDDLE or np.median(_rim(small)) >= _MIDDLE:
        return page
    window_px = max(3, min(255, min(small.shape) // _WINDOW_SHARE)) | 1
    standing_out = small.astype(np.float64) - cv2.medianBlur(small, window_px)
    return noted(page, "light on dark turned", 255 - page.grey) if (standing_out**3).sum() >= 0 else page


def _rim(small: Grey) -> Grey:
    wide = max(1, min(small.shape) // _RIM_SHARE)
    bands = (small[:wide], small[-wide:], small[:, :wide], small[:, -wide:])
    return np.concatenate([band.ravel() for band in bands])
