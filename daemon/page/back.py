"""The way back from a page to the given picture, and what is noted of each step that led away from it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from daemon.homography import through
from daemon.page.tones import reduced
from daemon.shapes import Grey, Homography, PageImage, Step

_SMALL_PX = 480


def given_px(page: PageImage) -> float:
    """How many px of the given picture a px in the middle of the page is long."""
    height_px, width_px = page.grey.shape
    middle = np.array([(width_px - 1) / 2, (height_px - 1) / 2])
    around = through(page.to_given, middle + np.array([[0, 0], [1, 0], [0, 1]]))
    across, down = around[1:] - around[0]
    return float(np.sqrt(abs(across[0] * down[1] - across[1] * down[0])))


def noted(page: PageImage, words: str, grey: Grey, to_given: Homography | None = None) -> PageImage:
    """The page after a step: its new pixels, where they lie if they have moved, and what was done in a few words."""
    moved = page.to_given if to_given is None else to_given
    return replace(page, grey=grey, to_given=moved, steps=(*page.steps, Step(words, reduced(page.grey, _SMALL_PX))))
