"""Lines get the pen that drew them, on clean pictures and on photographs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import cv2
import numpy as np
import pytest

from daemon.colours import Pens, rgb_of
from daemon.intake.decode import coloured, page_of
from daemon.page.colours import by_pen
from daemon.page.prepare import prepare
from daemon.shapes import Colours, Drawing, PageImage, Points, Stroke
from tests.drawings.colours import PENS, WIDTH_PX, photographed, picture, strokes

ALL = Pens(tuple(PENS), tuple(rgb_of(colour) or (0, 0, 0) for colour in PENS.values()))
NOWHERE = np.empty((0, 2))


def page_with(seen: Colours, width_px: float = WIDTH_PX) -> PageImage:
    grey = cv2.cvtColor(seen, cv2.COLOR_BGR2GRAY)
    return replace(coloured(page_of(np.asarray(grey, np.uint8), sha256=""), seen), line_width_px=width_px)


def drawing(*lines: Points, side_px: int = 600) -> Drawing:
    return Drawing(tuple(map(Stroke, lines)), side_px, side_px)


def length(points: Points) -> float:
    return float(np.hypot(*np.diff(points, axis=0).T).sum())


def right_share(found: Drawing, truth: list[tuple[str, Points]], within_px: float = WIDTH_PX) -> float:
    """Of the length of all lines, what lies near a true line of the same pen."""
    right = total = 0.0
    for stroke in found.strokes:
        count = max(2, round(length(stroke.points)))
        at = np.linspace(0, len(stroke.points) - 1, count)
        places = np.stack([np.interp(at, range(len(stroke.points)), side) for side in stroke.points.T], axis=1)
        mine = np.concatenate([points for pen, points in truth if pen == ALL.names[stroke.pen]])
        near = np.hypot(*(places[:, None] - mine[None]).transpose(2, 0, 1)).min(axis=1) <= within_px
        right, total = right + near.mean() * length(stroke.points), total + length(stroke.points)
    return right / total


@pytest.mark.parametrize(
    ("side_px", "worn", "least"),
    [
        (300, False, 0.99),
        (600, False, 0.99),
        (1200, False, 0.99),
        (300, True, 0.95),
        (400, True, 0.97),
        (1200, True, 0.97),
    ],
)
def test_nearly_all_of_a_drawing_has_its_right_pen(side_px: int, worn: bool, least: float) -> None:
    width_px = WIDTH_PX * side_px / 600
    truth = strokes(side_px)
    clean = picture(side_px, width_px)
    page = page_with(photographed(clean) if worn else clean, width_px)
    found = by_pen(drawing(*(points for _, points in truth), side_px=side_px), page, NOWHERE, ALL)
    assert right_share(found, truth, width_px) >= least
    assert len(found.strokes) == len(truth) or side_px < 400


def bar(*lines: tuple[str, tuple[float, float], tuple[float, float]], width_px: int = 5) -> Colours:
    seen = np.full((200, 200, 3), 255, np.uint8)
    for colour, start, end in lines:
        red, green, blue = rgb_of(colour) or (0, 0, 0)
        (x, y), (end_x, end_y) = start, end
        places = (round(x), round(y)), (round(end_x), round(end_y))
        cv2.line(seen, *places, (blue, green, red), width_px, cv2.LINE_AA)
    return seen


def line(start: tuple[float, float], end: tuple[float, float], count: int = 50) -> Points:
    return np.linspace(start, end, count)


def test_a_line_that_changes_its_colour_is_cut_there_and_both_parts_hold_the_place() -> None:
    page = page_with(bar(("black", (20, 50), (100, 50)), (PENS["red"], (100, 50), (180, 50))), 5.0)
    found = by_pen(drawing(line((20, 50), (180, 50))), page, NOWHERE, ALL)
    assert [stroke.pen for stroke in found.strokes] == [0, 1]
    assert (found.strokes[0].points[-1] == found.strokes[1].points[0]).all()
    assert found.strokes[0].points[-1] == pytest.approx([100, 50], abs=3.0)


def test_a_cut_lies_where_lines_meet_if_they_do_nearby() -> None:
    whole, corner = line((20, 50), (180, 50), 17), np.array([[100.0, 50.0]])
    page = page_with(bar(("black", (20, 50), (96, 50)), (PENS["red"], (97, 50), (180, 50))), 5.0)
    found = by_pen(drawing(whole), page, corner, ALL)
    assert found.strokes[0].points[-1].tolist() == [100.0, 50.0]


@pytest.mark.parametrize("aside", [0.0, 40.0, 60.0])
def test_a_line_that_another_covers_at_a_crossing_goes_on_behind_it(aside: float) -> None:
    over = (PENS["blue"], (100 - aside, 20), (100 + aside, 180))
    page = page_with(bar((PENS["red"], (20, 100), (180, 100)), over), 5.0)
    found = by_pen(drawing(line((20, 100), (180, 100))), page, NOWHERE, ALL)
    assert [stroke.pen for stroke in found.strokes] == [1]


def test_what_pens_that_are_left_out_have_drawn_is_not_drawn() -> None:
    page = page_with(bar(("black", (20, 50), (100, 50)), (PENS["red"], (100, 50), (180, 50))), 5.0)
    (kept,) = by_pen(drawing(line((20, 50), (180, 50))), page, NOWHERE, replace(ALL, skip=frozenset({0}))).strokes
    assert kept.pen == 1
    assert kept.points[:, 0].min() > 96


@pytest.mark.parametrize("black_first", [True, False])
def test_pens_of_one_tone_are_told_apart_by_how_dark_they_are(black_first: bool) -> None:
    shades = ((20, 20, 20), (150, 150, 150))
    pens = Pens(("a", "b"), shades if black_first else shades[::-1])
    page = page_with(bar(("#969696", (20, 50), (180, 50)), ("#141414", (20, 100), (180, 100))), 5.0)
    found = by_pen(drawing(line((20, 50), (180, 50)), line((20, 100), (180, 100))), page, NOWHERE, pens)
    assert [stroke.pen for stroke in found.strokes] == ([1, 0] if black_first else [0, 1])


def test_chalk_of_two_colours_on_a_dark_board() -> None:
    board = 255 - bar(("#141414", (20, 50), (180, 50)), ("#1414b0", (20, 100), (180, 100)))
    pens = Pens(("white", "yellow"), ((235, 235, 235), (235, 235, 80)))
    found = by_pen(
        drawing(line((20, 50), (180, 50)), line((20, 100), (180, 100))), page_with(board, 5.0), NOWHERE, pens
    )
    assert [stroke.pen for stroke in found.strokes] == [0, 1]


def test_a_dot_has_a_pen_and_a_page_without_colours_is_black() -> None:
    page = page_with(bar((PENS["blue"], (100, 100), (100, 100)), width_px=9), 9.0)
    dot = drawing(np.array([[100.0, 100.0]]))
    assert [stroke.pen for stroke in by_pen(dot, page, NOWHERE, ALL).strokes] == [2]
    other = Pens(ALL.names[::-1], ALL.colours[::-1])
    assert [stroke.pen for stroke in by_pen(dot, replace(page, colour=None), NOWHERE, other).strokes] == [2]
    assert [stroke.pen for stroke in by_pen(dot, replace(page, colour=None), NOWHERE, Pens()).strokes] == [0]


@pytest.mark.parametrize("turn", [lambda seen: seen, lambda seen: 255 - seen], ids=["yellow on white", "on black"])
def test_a_light_colour_counts_as_ink(turn: Callable[[Colours], Colours]) -> None:
    ink = "#ffe000" if turn(np.uint8(0)) == 0 else "#808000"  # type: ignore[arg-type]
    page = prepare(page_with(turn(bar((ink, (20, 100), (180, 100))))))
    middle = page.grey[page.grey.shape[0] // 2]
    assert middle.min() < 100
    assert np.median(page.grey) > 200
