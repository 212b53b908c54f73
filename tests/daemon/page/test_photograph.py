"""Pictures that are no drawings."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from daemon.page.prepare import put_right
from daemon.shapes import Grey
from tests.daemon.page.pages import drawn, grain, in_shadow, page


def toned(seed: int) -> Grey:
    """Smooth areas of many greys, soft where they meet, with a finer texture upon them: as fur in front of a room."""
    random = np.random.default_rng(seed)
    rough, fine = (cv2.GaussianBlur(random.normal(0, 1, (480, 640)), (0, 0), sigma) for sigma in (40, 3))
    ranks = np.argsort(np.argsort(rough, axis=None)).reshape(rough.shape) / rough.size
    areas = cv2.GaussianBlur(np.floor(ranks * 6) / 6 * 200 + 30, (0, 0), 2)
    return np.asarray(np.clip(areas + 10 * fine / fine.std(), 0, 255), np.uint8)


def text() -> Grey:
    grey = np.full((600, 500), 245, np.uint8)
    for row in range(30, 590, 14):
        cv2.putText(grey, "a page of text is no photograph", (20, row), cv2.FONT_HERSHEY_SIMPLEX, 0.5, 20)
    return grey


@pytest.mark.parametrize("seed", range(3))
def test_a_photograph_is_warned_of(seed: int) -> None:
    (warning,) = [words for words in put_right(page(toned(seed))).warnings if "photograph" in words]
    assert "give a line drawing" in warning


@pytest.mark.parametrize("grey", [drawn(), text(), in_shadow(grain(drawn(ink=90, paper=220), 4), 0.5), 255 - drawn()])
def test_a_drawing_or_a_page_of_text_is_no_photograph(grey: Grey) -> None:
    assert put_right(page(grey)).warnings == ()
