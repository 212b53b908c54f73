"""Ink that no line covers is found, and filled."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from daemon.graph.interpret import interpret
from daemon.graph.remains import fillings, tied, uncovered
from tests.daemon.graph.drawn import page, polylines, silent

LINE = np.array([[10.0, 20], [90, 20]])


def inked(*, square: bool) -> np.ndarray:
    ink = np.zeros((100, 100), bool)
    ink[19:22, 10:91] = True
    ink[40:64, 30:70] = square
    return ink


def test_a_covered_line_leaves_nothing_to_fill() -> None:
    assert not uncovered(inked(square=False), [LINE], width_px=3.0).any()
    assert fillings(inked(square=False), [LINE], width_px=3.0)[0] == []


def test_the_rounding_of_a_corner_is_no_remainder() -> None:
    ink = inked(square=False)
    ink[23:26, 40:43] = True
    assert not uncovered(ink, [LINE], width_px=3.0).any()


def test_a_filled_area_is_covered_by_its_fillings() -> None:
    ink = inked(square=True)
    lines, ends, vertices = fillings(ink, [LINE], width_px=3.0)
    bare = uncovered(ink, [LINE, *lines], width_px=3.0)
    assert bare.sum() < 0.02 * 24 * 40
    for line, (start, end) in zip(lines, ends, strict=True):
        assert np.array_equal(line[[0, -1]], vertices[[start, end]])


def test_a_scribble_is_drawn_with_all_its_ink() -> None:
    zigzag = [(20 + 2.2 * i, 30 + 60 * (i % 2)) for i in range(40)]
    drawn = replace(page([zigzag], width_px=3), line_width_px=3.0)
    lines = polylines(interpret(drawn, silent(drawn)))
    assert uncovered(drawn.grey < 128, lines, width_px=3.0).sum() < 0.01 * (drawn.grey < 128).sum()


def test_a_loose_end_is_tied_to_the_nearest_vertex_of_odd_degree() -> None:
    vertices = np.array([[0.0, 0], [10, 0], [20, 0], [10, 10], [13, 0], [40, 0]])
    others, ends = np.array([[0, 1], [1, 2], [1, 3]]), np.array([[4, 5]])
    (line,), tied_ends = tied([vertices[[4, 5]]], ends, others, vertices, within_px=6.0)
    assert tied_ends.tolist() == [[1, 5]]
    assert line.tolist() == [[10, 0], [13, 0], [40, 0]]
    assert tied([vertices[[4, 5]]], ends, others, vertices, within_px=2.0)[1].tolist() == [[4, 5]]


def test_a_vertex_takes_one_loose_end() -> None:
    vertices = np.array([[0.0, 0], [10, 0], [13, 0], [40, 0], [13, 3]])
    others, ends = np.array([[0, 1]]), np.array([[2, 3], [4, 3]])
    _, tied_ends = tied([vertices[pair] for pair in ends], ends, others, vertices, within_px=4.5)
    assert tied_ends.tolist() == [[1, 3], [4, 3]]


def test_a_filling_that_would_hang_on_nothing_is_led_to_a_vertex_of_even_degree() -> None:
    vertices = np.array([[0.0, 0], [10, 0], [20, 5], [10, 4], [14, 9]])
    others, ends = np.array([[0, 1], [1, 2]]), np.array([[3, 4]])
    _, tied_ends = tied([vertices[[3, 4]]], ends, others, vertices, within_px=5.0)
    assert tied_ends.tolist() == [[1, 4]]
