"""The way back from a page to the given picture, and what is noted of each step that led away from it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from daemon.page.tones import reduced
from daemon.shapes import Grey, Homography, PageImage, Points, Step

_SMALL_PX = 480


def on_given(points: Points, to_given: Homography) -> Points:
    """points: (N, 2) in px of a page. Returns (N, 2) in px of the given picture; equal points stay equal."""
    x, y = points.T
    u, v, w = (row[0] * x + row[1] * y + row[2] for row in to_given)
    return np.stack([u / w, v / w], axis=1)


def given_px(page: PageImage) -> float:
    """How many px of the given picture a px in the middle of the page is long."""
    height_px, width_px = page.grey.shape
    middle = np.array([(width_px - 1) / 2, (height_px - 1) / 2])
    around = on_given(middle + np.array([[0, 0], [1, 0], [0, 1]]), page.to_given)
    across, down = around[1:] - around[0]
    return float(np.sqrt(abs(across[0] * down[1] - across[1] * down[0])))


def noted(page: PageImage, words: str, grey: Grey, to_given: Homography | None = None) -> PageImage:
    """The page after a step: its new pixels, where they lie if they have moved, and what was done in a few words."""
    moved = page.to_given if to_given is None else to_given
    return replace(page, grey=grey, to_given=moved, steps=(*page.steps, Step(words, reduced(page.grey, _SMALL_PX))))
