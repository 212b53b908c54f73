"""Warnings."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from daemon.page.prepare import prepare
from daemon.shapes import Grey
from tests.daemon.page.pages import drawn, grain, page


def marker(width_px: int) -> Grey:
    grey = np.full((1600, 1600), 255, np.uint8)
    return np.asarray(cv2.circle(grey, (800, 800), 600, 0, width_px, cv2.LINE_AA), np.uint8)


@pytest.mark.parametrize(
    ("grey", "words"),
    [
        pytest.param(marker(70), "the lines are about", id="very wide"),
        pytest.param(drawn(side_px=48, width_px=1), "the picture is 48 x 48 px", id="very small"),
        pytest.param(grain(drawn(ink=190, paper=217, width_px=4), 0.4), "the ink is only", id="very faint"),
    ],
)
def test_what_is_outside_the_working_range_is_said_with_a_remedy(grey: Grey, words: str) -> None:
    (warning,) = prepare(page(grey)).warnings
    assert warning.startswith(words)
    assert "wanted" in warning


@pytest.mark.parametrize("grey", [drawn(), marker(36), drawn(side_px=1024, width_px=1), drawn(ink=180, paper=240)])
def test_of_an_ordinary_page_there_is_nothing_to_say(grey: Grey) -> None:
    assert prepare(page(grey)).warnings == ()
