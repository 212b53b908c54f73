"""Pages that lie skew in their pictures."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from daemon.homography import through
from daemon.page.skew import level
from daemon.shapes import Grey, Homography, Points
from tests.daemon.page.pages import drawn, grain, page
from tests.drawings.hand import by_hand

_WIDE, _HIGH = 800, 600
_MIDDLE = np.array([_WIDE / 2, _HIGH / 2])

PLAN = [
    np.array(line, float)
    for line in (
        [(100, 100), (700, 100)],
        [(100, 500), (700, 500)],
        [(100, 100), (100, 500)],
        [(700, 100), (700, 500)],
        [(400, 100), (400, 500)],
        [(100, 300), (400, 300)],
        [(400, 220), (700, 220)],
        [(150, 150), (350, 260)],
    )
]


def inked(lines: list[Points], *, ink: int = 30) -> Grey:
    grey = np.full((_HIGH, _WIDE), 255, np.uint8)
    for line in lines:
        cv2.polylines(grey, [np.rint(line * 16).astype(np.int32)], False, ink, 3, cv2.LINE_AA, 4)
    return grey


def turned(lines: list[Points], degrees: float) -> list[Points]:
    angle = np.radians(degrees)
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    return [(line - _MIDDLE) @ turn + _MIDDLE for line in lines]


@pytest.mark.parametrize("degrees", [-4.5, -1.0, 0.5, 3.0])
def test_a_skew_plan_is_made_level_and_its_way_back_is_known(degrees: float) -> None:
    lines = turned(PLAN, degrees)
    found = level(page(grain(inked(lines), 3)))
    assert [step.words for step in found.steps] == [f"turned by {-degrees:.1f} degrees"]
    back: Homography = np.asarray(np.linalg.inv(found.to_given), np.float64)
    ends = through(back, lines[0])
    assert ends[0, 1] == pytest.approx(ends[1, 1], abs=1.0)
    x, y = np.rint(ends.mean(axis=0)).astype(int)
    assert found.grey[y - 1 : y + 2, x].min() < 100


def test_faint_printed_lines_tell_how_a_page_lies() -> None:
    printed = [np.array([[-50.0, y], [850.0, y]]) for y in range(20, 600, 40)]
    grey = np.minimum(
        inked(turned(printed, 2.0), ink=200),
        inked([by_hand(np.array([[200.0, 200.0], [500.0, 330.0]]), np.random.default_rng(0), wobble_px=3.0)]),
    )
    assert [step.words for step in level(page(grey)).steps] == ["turned by -2.0 degrees"]


def by_a_hand() -> Grey:
    random = np.random.default_rng(1)
    return inked([by_hand(line, random, wobble_px=6.0) for line in turned(PLAN, 2.0)])


FRAME = [np.array(line, float) for line in ([(100, 60), (700, 60)], [(100, 540), (700, 540)], [(0, 580), (800, 580)])]
HATCH = turned([np.array([[150.0, y], [650.0, y]]) for y in range(120, 500, 20)], 3)


def test_the_edges_of_a_scanner_are_level_on_every_page() -> None:
    edges = [np.array(line, float) for line in ([(0, 3), (800, 3)], [(0, 596), (800, 596)], [(3, 0), (3, 600)])]
    assert level(page(inked(HATCH + edges))).steps


@pytest.mark.parametrize(
    "grey",
    [
        pytest.param(inked(HATCH + FRAME), id="a slanting hatch in a level frame"),
        pytest.param(inked(PLAN), id="a level plan"),
        pytest.param(inked(turned(PLAN, 0.1)), id="hardly skew"),
        pytest.param(inked(turned(PLAN, 45)), id="at 45 degrees"),
        pytest.param(inked(turned(PLAN, 12)), id="meant to be skew"),
        pytest.param(inked(turned(PLAN[:4], 3)), id="four lines"),
        pytest.param(inked(turned(PLAN[:4], 3) + PLAN[4:]), id="lines that lean otherwise"),
        pytest.param(by_a_hand(), id="a hand's lines"),
        pytest.param(drawn(side_px=600), id="rings"),
        pytest.param(np.full((300, 300), 255, np.uint8), id="white"),
    ],
)
def test_other_pages_come_back_as_they_are(grey: Grey) -> None:
    given = page(grey)
    assert level(given) is given
