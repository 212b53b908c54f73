"""Lines on each other are drawn once; lines beside or across each other all stay."""

from __future__ import annotations

import numpy as np
import pytest

from daemon.intake.vector.common import Vectors
from daemon.intake.vector.overlaps import drawn_once
from daemon.intake.vector.sheet import as_page
from daemon.shapes import Points


def line(*points: tuple[float, float]) -> Points:
    return np.array(points, float)


def circle(count: int, start: float = 0.0) -> Points:
    turn = start + np.linspace(0, 2 * np.pi, count + 1)
    return np.stack([50 + 20 * np.cos(turn), 50 + 20 * np.sin(turn)], axis=1)


def length(lines: list[Points]) -> float:
    return sum(float(np.hypot(*np.diff(each, axis=0).T).sum()) for each in lines)


@pytest.mark.parametrize(
    ("lines", "left_mm"),
    [
        ([line((0, 0), (50, 0)), line((0, 0), (50, 0))], 50),
        ([line((0, 0), (50, 0)), line((50, 0), (0, 0))], 50),
        ([line((0, 0), (50, 0)), line((30, 0), (80, 0))], 80),
        ([line((0, 0), (50, 0)), line((-10, 0), (80, 0))], 90),
        ([line((0, 0), (50, 0), (0, 0))], 50),
        ([line((0, 0), (20, 0), (20, 20), (0, 20), (0, 0)), line((20, 0), (40, 0), (40, 20), (20, 20), (20, 0))], 140),
        ([line((0, 0), (30, 40)), line((0, 0.01), (30, 40.01))], 50),
        # None of these lie on each other.
        ([line((0, 0), (50, 0)), line((0, 0.05), (50, 0.05))], 100),
        ([line((0, 0), (50, 0)), line((25, -25), (25, 25))], 100),
        ([line((0, 0), (50, 0)), line((50, 0), (100, 0))], 100),
        ([line((0, 0), (25, 0), (50, 0))], 50),
        ([line((0, 0), (50, 0)), line((25, 0), (25, 0.03))], 50.03),
    ],
)
def test_the_length_that_is_left(lines: list[Points], left_mm: float) -> None:
    assert length(drawn_once(lines)) == pytest.approx(left_mm, abs=0.1)


def test_a_circle_that_is_drawn_twice_is_drawn_once_wherever_it_begins() -> None:
    assert length(drawn_once([circle(300), circle(300, 1.0)])) == pytest.approx(length([circle(300)]), rel=0.01)


def test_what_stays_of_lines_that_do_not_overlap_is_the_very_same() -> None:
    given = [circle(100), line((0, 0), (10, 10)), line((3, 3))]
    assert all(a is b for a, b in zip(drawn_once(given), given, strict=True))


def test_dots_are_drawn_once() -> None:
    assert len(drawn_once([line((3, 3)), line((3, 3)), line((4, 3))])) == 2


def test_everything_drawn_lies_on_what_was_given() -> None:
    rng = np.random.default_rng(5)
    given = [rng.uniform(0, 30, (2, 2)).round() for _ in range(400)]
    left = drawn_once(given)
    assert length(left) < length(given)
    seen = as_page(Vectors(tuple(given), 40, 40, sized=True), sha256="").page.grey
    again = as_page(Vectors(tuple(left), 40, 40, sized=True), sha256="").page.grey
    assert np.mean((seen < 128) ^ (again < 128)) < 1e-3
