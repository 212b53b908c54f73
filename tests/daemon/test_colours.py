"""Colours as people write them, and the pen that is nearest to one."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from daemon.colours import ONE_PEN, Pens, Rgb, lab_of, rgb_of

PENS = Pens(("black", "red", "blue"), ((26, 26, 26), (208, 48, 48), (32, 64, 192)), frozenset({1}))


@pytest.mark.parametrize(
    ("text", "rgb"),
    [
        ("#D03030", (208, 48, 48)),
        ("#f00", (255, 0, 0)),
        (" Navy ", (0, 0, 128)),
        ("rebeccapurple", (102, 51, 153)),
        ("rgb(1, 2, 300)", (1, 2, 255)),
        ("rgb(100%, 0%, 20%)", (255, 0, 51)),
        ("rgb(1)", None),
        ("#12345", None),
        ("url(#a)", None),
    ],
)
def test_a_colour_is_read_as_css_writes_it(text: str, rgb: Rgb | None) -> None:
    assert rgb_of(text) == rgb


@settings(deadline=None)
@given(st.tuples(*[st.integers(0, 255)] * 3))
def test_lab_is_that_of_opencv(rgb: tuple[int, int, int]) -> None:
    theirs = cv2.cvtColor(np.array([[rgb]], np.float32) / 255, cv2.COLOR_RGB2LAB)[0, 0]
    assert lab_of(rgb) == pytest.approx(theirs.tolist(), abs=0.5)


@pytest.mark.parametrize(("colour", "pen"), [("darkred", 1), ("orange", 1), ("navy", 2), ("gray", 0)])
def test_the_nearest_pen_is_the_one_that_a_person_would_take(colour: str, pen: int) -> None:
    assert PENS.nearest(rgb_of(colour) or (0, 0, 0)) == pen


def test_lines_are_sorted_by_pen_without_those_that_are_left_out() -> None:
    colours = [(0, 0, 200), (250, 0, 0), (0, 0, 0), (0, 0, 180)]
    assert PENS.sorted("abcd", colours) == {0: ["c"], 2: ["a", "d"]}
    assert PENS.sorted("ab", ()) == {0: ["a", "b"]}
    assert ONE_PEN.sorted("abcd", colours) == {0: ["a", "b", "c", "d"]}
