"""Lines drawn over themselves."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from daemon.page.overdrawn import merge_overdrawn
from daemon.shapes import Grey, Points
from tests.daemon.page.pages import drawn, page

_WIDTH_PX, _FINER = 4, 8
_ALONG = np.linspace(0, 1, 41)


def inked(*lines: Points) -> Grey:
    fine = np.full((200 * _FINER, 300 * _FINER), 255, np.uint8)
    for line in lines:
        cv2.polylines(fine, [np.rint(line * _FINER).astype(np.int32)], False, 0, _WIDTH_PX * _FINER)
    return np.asarray(cv2.resize(fine, (300, 200), interpolation=cv2.INTER_AREA), np.uint8)


def bow(by_px: float, *, y: float = 100.0) -> Points:
    """From left to right, in the middle so far above y."""
    return np.stack([30 + 240 * _ALONG, y - by_px * np.sin(np.pi * _ALONG)], axis=1)


def level(y: float, left: float = 30.0, right: float = 270.0) -> Points:
    return np.array([[left, y], [right, y]])


def test_two_passes_of_a_line_with_paper_between_become_one_line_in_their_middle() -> None:
    given = page(inked(*(bow(up, y=y) for y in (50, 100, 150) for up in (3.4, -3.4)), level(185)))
    found = merge_overdrawn(given)
    assert [step.words for step in found.steps] == ["lines drawn over themselves merged in 3 places"]
    for y in (50, 100, 150):
        rows = y - 15 + np.flatnonzero(found.grey[y - 15 : y + 15, 150] < 128)
        assert np.ptp(rows) <= _WIDTH_PX + 1
        assert rows.mean() == pytest.approx(y - 0.5, abs=1.0)
    assert np.array_equal(found.grey[170:], given.grey[170:])


def test_a_lens_or_two_are_lines_that_have_come_close() -> None:
    given = page(inked(*(bow(up, y=y) for y in (50, 100) for up in (3.4, -3.4))))
    assert merge_overdrawn(given) is given


DOUBLE_WALLS = tuple(
    np.array([[30.0, y], [270.0, y], [270.0, y + 7], [30.0, y + 7], [30.0, y]]) for y in (40.0, 70.0, 100.0, 130.0)
)
HATCH = tuple(level(y) for y in np.arange(40, 160, 6.5))
FRAMED = (*HATCH, np.array([[30.0, 30.0], [30.0, 170.0]]), np.array([[270.0, 30.0], [270.0, 170.0]]))
WEDGES = tuple(np.array([[270.0, y], [30.0, y], [270.0, y + 7]]) for y in (40.0, 70.0, 100.0, 130.0))
WEDGES += (np.array([[270.0, 20.0], [270.0, 180.0]]),)


CROSSING = tuple(level(y) for y in np.arange(25, 180, 10.0))
CROSSING += tuple(np.array([[30.0, y - 15], [270.0, y + 15]]) for y in np.arange(25, 180, 10.0))


@pytest.mark.parametrize(
    "lines",
    [
        pytest.param(CROSSING, id="two hatches that cross at a small angle"),
        pytest.param(DOUBLE_WALLS, id="double walls"),
        pytest.param(HATCH, id="a hatch"),
        pytest.param(FRAMED, id="a hatch in a frame"),
        pytest.param(WEDGES, id="two lines that part, cut off by a third"),
        pytest.param(tuple(bow(up, y=y) for y in (40, 100, 160) for up in (12, -12)), id="leaves"),
    ],
)
def test_lines_that_are_two_stay_as_they_are(lines: tuple[Points, ...]) -> None:
    given = page(inked(*lines))
    assert merge_overdrawn(given) is given


@pytest.mark.parametrize("grey", [drawn(), np.full((50, 50), 255, np.uint8)])
def test_a_page_without_overdrawn_lines_comes_back_as_it_is(grey: Grey) -> None:
    given = page(grey)
    assert merge_overdrawn(given) is given
