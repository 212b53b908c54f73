"""Specks, stains and holes."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from daemon.page.back import noted
from daemon.page.dirt import clean_paper
from daemon.shapes import Grey, PageImage
from tests.daemon.page.pages import drawn, page

SIDE_PX = 500
PLACE = (60, 60)


def touched(grey: Grey) -> PageImage:
    return noted(page(grey), "light evened out", grey)


def with_disc(radius_px: float, *, ink: int = 0, at: tuple[int, int] = PLACE) -> Grey:
    grey = drawn(width_px=6, side_px=SIDE_PX)
    fixed = (at[0] * 16, at[1] * 16)
    return np.asarray(cv2.circle(grey, fixed, round(radius_px * 16), ink, -1, cv2.LINE_AA, 4), np.uint8)


def around(grey: Grey, at: tuple[int, int] = PLACE, reach: int = 20) -> int:
    """The darkest level there."""
    x, y = at
    return int(grey[max(0, y - reach) : y + reach, max(0, x - reach) : x + reach].min())


@pytest.mark.parametrize(
    "grey",
    [
        pytest.param(with_disc(1.2), id="speck"),
        pytest.param(with_disc(4, ink=120), id="stain"),
        pytest.param(with_disc(13, at=(30, 60)), id="hole"),
    ],
)
def test_dirt_goes(grey: Grey) -> None:
    clean = clean_paper(touched(grey))
    assert around(clean.grey, (45, 60), 40) == 255
    assert clean.steps[-1].words == "dirt taken off: 1 piece"


@pytest.mark.parametrize(
    "grey",
    [
        pytest.param(with_disc(3), id="dot of the pen"),
        pytest.param(with_disc(2.2), id="dot of a light hand"),
        pytest.param(with_disc(13, at=(150, 130)), id="filled disc away from the rim"),
        pytest.param(drawn(width_px=6, side_px=SIDE_PX), id="nothing"),
    ],
)
def test_what_a_pen_has_drawn_stays(grey: Grey) -> None:
    given = touched(grey)
    assert clean_paper(given) is given


def test_a_page_that_nobody_touched_is_clean() -> None:
    given = page(with_disc(1.2))
    assert clean_paper(given) is given
