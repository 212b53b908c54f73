"""Ink is told apart by the stroke whose beginning it is."""

from __future__ import annotations

import numpy as np
import pytest

from tests.torture.sheet import Inked, whose

STROKES = [np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]]), np.array([[0.0, 20.0], [30.0, 20.0]])]
PROGRAMS = {"1-a": STROKES}


@pytest.mark.parametrize(
    ("ink", "found"),
    [
        ([[0, 0], [10, 0], [10, 10]], Inked("1-a", 0, whole=True)),
        ([[0, 0], [10, 0], [10, 4]], Inked("1-a", 0, whole=False)),
        ([[0, 20.05], [30, 20.05]], Inked("1-a", 1, whole=True)),
        ([[0, 0]], Inked("1-a", 0, whole=False)),
        ([[0, 0], [10, 10]], None),
        ([[10, 10], [10, 0], [0, 0]], None),
        ([[0, 20], [40, 20]], None),
        ([[5, 0], [10, 0]], None),
    ],
)
def test_a_line_of_ink_is_a_stroke_from_its_beginning(ink: list[list[float]], found: Inked | None) -> None:
    assert whose(np.array(ink, float), PROGRAMS) == found
