"""Which strokes the first lines of a job cover."""

from __future__ import annotations

import pytest

from firmware_protocol.strokes import strokes_before, strokes_touched

STROKES = (None, 0, 0, 0, 1, 1, 2, None)


@pytest.mark.parametrize(("line", "strokes"), [(0, 0), (1, 0), (3, 0), (4, 1), (6, 2), (7, 3), (8, 3)])
def test_strokes_before_a_line(line: int, strokes: int) -> None:
    assert strokes_before(STROKES, line) == strokes


@pytest.mark.parametrize(("lines", "strokes"), [(0, 0), (1, 0), (2, 1), (5, 2), (7, 3), (8, 3)])
def test_strokes_touched_by_the_first_lines(lines: int, strokes: int) -> None:
    assert strokes_touched(STROKES, lines) == strokes


def test_a_job_that_goes_on_with_stroke_7_leaves_the_first_seven_as_they_are() -> None:
    assert strokes_before((None, 7, 8), 0) == 7
    assert strokes_touched((None, 7, 8), 1) == 7
