"""Every line of a page is drawn once, in the middle of its ink, whatever the network says."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from daemon.graph.feedback import Adaptation
from daemon.graph.interpret import _simplified, interpret, interpret_with_reasons
from daemon.graph.ridge import onto_ridge
from daemon.graph.strokes import strokes
from daemon.shapes import LineGraph, PageImage, Segmentation
from tests.daemon.graph.drawn import (
    Lines,
    arrays,
    channels,
    circle,
    degrees,
    distances,
    length_px,
    page,
    polylines,
    silent,
)

SQUARE: Lines = [[(30, 30), (98, 30), (98, 98), (30, 98), (30, 30)]]
CROSS: Lines = [[(20, 64), (108, 64)], [(64, 20), (64, 108)]]
TEE: Lines = [[(20, 40), (108, 40)], [(64, 40), (64, 108)]]
ACUTE: Lines = [[(15, 50), (113, 78)], [(15, 78), (113, 50)]]
ZIGZAG: Lines = [[(15, 30), (40, 98), (60, 30), (82, 98), (112, 30)]]
STAR: Lines = [[(64, 12), (94, 108), (14, 48), (114, 48), (34, 108), (64, 12)]]
HATCH: Lines = [[(20, 20 + 8 * i), (108, 28 + 8 * i)] for i in range(10)]
CIRCLE: Lines = [circle(64.3, 63.8, 40)]
SPIRAL: Lines = [circle(64, 64, 6, turns=4, growth=12)]
SHAPES = {
    "square": (SQUARE, SQUARE[0]),
    "cross": (CROSS, [*CROSS[0], *CROSS[1], (64, 64)]),
    "tee": (TEE, [*TEE[0], *TEE[1]]),
    "acute": (ACUTE, [*ACUTE[0], *ACUTE[1], (64, 64)]),
    "zigzag": (ZIGZAG, ZIGZAG[0]),
    "star": (STAR, [*STAR[0], (53, 48), (75, 48), (83, 72), (64, 86), (45.5, 72)]),
    "hatch": (HATCH, [point for line in HATCH for point in line]),
    "circle": (CIRCLE, []),
    "spiral": (SPIRAL, [SPIRAL[0][0], SPIRAL[0][-1]]),
}


def agrees(graph: LineGraph, lines: Lines, *, within_px: float) -> bool:
    """No ink lost, none invented, none doubled."""
    truth, drawn = arrays(lines), polylines(graph)
    lost, invented = distances(truth, drawn), distances(drawn, truth)
    ratio = length_px(drawn) / length_px(truth)
    return bool(max(lost.max(), invented.max()) <= within_px and 0.97 <= ratio <= 1.03)


@pytest.mark.parametrize("name", SHAPES)
def test_draws_each_line_once_in_its_place(name: str) -> None:
    lines, corners = SHAPES[name]
    drawn = page(lines)
    assert agrees(interpret(drawn, channels(drawn, corners)), lines, within_px=0.8)


@pytest.mark.parametrize("name", SHAPES)
def test_a_silent_network_loses_no_line(name: str) -> None:
    lines, _ = SHAPES[name]
    drawn = page(lines)
    assert agrees(interpret(drawn, silent(drawn)), lines, within_px=2.3)


@pytest.mark.parametrize("width_px", [1, 2, 3, 4])
def test_a_line_lies_on_the_middle_of_its_ink(width_px: int) -> None:
    lines: Lines = [[(20.4, 40.3), (100.7, 61.6)], circle(60.2, 95.7, 20.3)]
    drawn = page(lines, width_px=width_px)
    graph = interpret(drawn, channels(drawn, lines[0]))
    assert distances(polylines(graph), arrays(lines)).mean() < 0.15


def test_false_corners_strung_along_a_curve_do_no_harm() -> None:
    drawn = page(CIRCLE)
    dots = CIRCLE[0][::12]
    assert agrees(interpret(drawn, channels(drawn, dots)), CIRCLE, within_px=0.8)


def test_corners_a_pixel_off_their_place_are_drawn_on_the_ink() -> None:
    drawn = page(SQUARE)
    displaced = [(31, 29), (97, 31), (99, 99), (29, 98)]
    assert agrees(interpret(drawn, channels(drawn, displaced)), SQUARE, within_px=0.8)


def test_a_missed_crossing_is_found_on_the_ink() -> None:
    drawn = page(TEE)
    graph = interpret(drawn, channels(drawn, [TEE[0][0], TEE[0][1]]))
    assert agrees(graph, TEE, within_px=1.6)


def test_a_wide_bow_with_a_missed_branch_is_not_cut_by_a_chord() -> None:
    bow = [(x, 60 + 2.2 * ((x - 64) / 36) ** 2) for x in np.linspace(28, 100, 73).tolist()]
    lines: Lines = [bow, [(64, 60), (64, 20)]]
    drawn = page(lines, width_px=4)
    assert agrees(interpret(drawn, channels(drawn, [bow[0], bow[-1], (64, 20)])), lines, within_px=1.2)


def test_a_crossing_joins_four_edges() -> None:
    drawn = page(CROSS)
    graph = interpret(drawn, channels(drawn, [*CROSS[0], *CROSS[1], (64, 64)]))
    assert degrees(graph) == [1, 1, 1, 1, 4]


def test_a_circle_without_a_corner_is_one_closed_edge() -> None:
    drawn = page(CIRCLE)
    graph = interpret(drawn, silent(drawn))
    assert [(edge.start, edge.end) for edge in graph.edges] == [(0, 0)]
    assert np.array_equal(graph.edges[0].polyline[0], graph.edges[0].polyline[-1])


def test_edges_end_in_their_vertices() -> None:
    drawn = page(STAR)
    graph = interpret(drawn, channels(drawn, SHAPES["star"][1]))
    for edge in graph.edges:
        assert np.array_equal(edge.polyline[[0, -1]], graph.vertices[[edge.start, edge.end]])


def test_a_dot_is_a_stroke_of_one_point() -> None:
    drawn = page([[(64, 40), (64, 40)], *CROSS[:1]])
    drawing = strokes(interpret(drawn, silent(drawn)), width_px=128, height_px=128)
    dots = [stroke.points for stroke in drawing.strokes if len(stroke.points) == 1]
    assert len(dots) == 1
    assert np.abs(dots[0] - (64, 40)).max() < 0.6


def test_an_edge_between_two_vertices_on_one_place_stays_there() -> None:
    drawn = page(CROSS)
    places = np.array([[64.0, 64], [64, 64]])
    ink = np.asarray(drawn.grey < 128, np.float32)
    lines = onto_ridge([places], np.array([[0, 1]]), places, ink, width_px=2.0)
    assert np.isfinite(lines.vertices).all()
    assert np.abs(lines.polylines[0] - (64, 64)).max() < 1.6


def test_a_single_dark_pixel_is_dirt() -> None:
    grey = np.full((64, 64), 255, np.uint8)
    grey[30, 30] = 0
    drawn = PageImage(grey, np.eye(3), 64, 64, "")
    assert interpret(drawn, silent(drawn)).edges == ()


@pytest.mark.parametrize("tone", [0, 255])
def test_a_page_of_one_tone_has_no_edge(tone: int) -> None:
    drawn = PageImage(np.full((64, 64), tone, np.uint8), np.eye(3), 64, 64, "")
    assert interpret(drawn, silent(drawn)).edges == ()


def test_a_page_that_is_all_corner_still_gives_its_lines() -> None:
    drawn = page(CROSS)
    nothing = np.zeros_like(silent(drawn).lines)
    graph = interpret(drawn, Segmentation(nothing, nothing, nothing + 1))
    assert distances(arrays(CROSS), polylines(graph)).max() < 1.6


def test_the_paper_alone_draws_a_line_through_a_corner_more_than_once() -> None:
    drawn = page(CROSS)
    graph = interpret(drawn, channels(drawn, [*CROSS[0], *CROSS[1], (64, 64)]), mode="paper")
    assert length_px(polylines(graph)) == pytest.approx(2 * length_px(arrays(CROSS)), rel=0.02)


def test_the_paper_alone_finds_nothing_with_a_strip_much_wider_than_the_line() -> None:
    drawn = page(CROSS)
    maps = channels(drawn, [*CROSS[0], *CROSS[1]])
    edges = [len(interpret(drawn, maps, mode="paper", adaptation=Adaptation(beta_px=b)).edges) for b in (1.8, 30.0)]
    assert edges == [2, 0]


def test_channels_of_another_page_are_refused() -> None:
    with pytest.raises(ValueError, match="segment this page"):
        interpret(page(CROSS), silent(page(CROSS, size=64)))


def test_channels_that_are_not_finite_are_refused() -> None:
    drawn = page(CROSS)
    maps = silent(drawn)
    with pytest.raises(ValueError, match="not finite"):
        interpret(drawn, Segmentation(maps.background, maps.lines * np.nan, maps.corners))


def test_twenty_thousand_specks_are_left_out_and_counted() -> None:
    grey = np.full((900, 900), 255, np.uint8)
    grey[2::6, 2::6] = 0
    grey[2::6, 3::12] = 0
    grey[400:402, 100:800] = 0
    drawn = PageImage(grey, np.eye(3), 900, 900, "")
    graph = interpret(drawn, silent(drawn))
    assert graph.specks == 150 * 150
    assert len(graph.edges) == 1


@pytest.mark.parametrize("radius_px", [3, 4])
def test_a_round_blot_that_is_larger_than_a_dot_is_a_dot(radius_px: int) -> None:
    """Its middle line is one pixel long."""
    drawn = replace(page([[(80, 10), (80, 118)]]), line_width_px=2.0)
    cv2.circle(drawn.grey, (20 * 16, 30 * 16), radius_px * 16, 0, -1, cv2.LINE_AA, 4)
    graph, reasons = interpret_with_reasons(drawn, channels(drawn, []))
    (dot,) = [edge for edge in graph.edges if len(edge.polyline) == 1]
    assert np.abs(dot.polyline[0] - (20, 30)).max() < 0.6
    assert len(reasons().edges) == len(graph.edges)


def test_thousands_of_specks_are_thousands_of_dots() -> None:
    grey = np.full((900, 900), 255, np.uint8)
    grey[::6, ::6] = grey[1::6, ::6] = grey[::6, 1::6] = grey[1::6, 1::6] = 0
    drawn = PageImage(grey, np.eye(3), 900, 900, "")
    assert len(interpret(drawn, silent(drawn)).edges) == 150 * 150


def test_a_closed_curve_is_simplified_without_losing_its_last_bend() -> None:
    square = np.array([(0, 0), (20, 0), (20, 20), (0, 20), (0, 0)], float)
    assert _simplified(square).tolist() == square.tolist()


def test_an_open_curve_is_simplified_to_its_bends() -> None:
    dense = np.array([*((x, 0) for x in range(11)), *((10, y) for y in range(1, 6))], float)
    assert _simplified(dense).tolist() == [[0, 0], [10, 0], [10, 5]]
