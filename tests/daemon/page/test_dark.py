"""Dark paper."""

from __future__ import annotations

import numpy as np
import pytest

from daemon.page.dark import turn_dark
from daemon.shapes import Grey
from tests.daemon.page.pages import drawn, grain, in_shadow, page


@pytest.mark.parametrize(("side_px", "width_px"), [(200, 2.5), (1500, 2.5), (300, 12)])
def test_chalk_on_a_dark_board_becomes_ink_on_paper(side_px: int, width_px: float) -> None:
    board = grain(drawn(ink=230, paper=40, side_px=side_px, width_px=width_px), 5)
    assert np.array_equal(turn_dark(page(board)).grey, 255 - board)


@pytest.mark.parametrize(
    "grey",
    [
        pytest.param(drawn(), id="clean"),
        pytest.param(in_shadow(drawn(paper=180, ink=20), 0.4), id="in-shadow"),
        pytest.param(grain(drawn(paper=100, ink=30), 5), id="dark-paper-darker-lines"),
        pytest.param(drawn(width_px=30), id="thick-marker"),
        pytest.param(in_shadow(drawn(width_px=8), 0.2), id="wide-lines-in-deep-shadow"),
    ],
)
def test_dark_lines_stay_as_they_are(grey: Grey) -> None:
    given = page(grey)
    assert turn_dark(given) is given


def test_a_page_that_is_black_all_over_is_empty_paper() -> None:
    assert turn_dark(page(np.zeros((50, 60), np.uint8))).grey.min() == 255


def test_a_page_that_is_white_all_over_stays() -> None:
    assert turn_dark(page(np.full((50, 60), 255, np.uint8))).grey.min() == 255
