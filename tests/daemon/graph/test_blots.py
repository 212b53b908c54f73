"""A blot and what ends on it are drawn without more lifts than its lines alone would take."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from daemon.graph.blots import led_in
from daemon.graph.crossings import Lines
from daemon.graph.interpret import interpret
from daemon.graph.strokes import strokes
from daemon.page.blots import rimmed
from daemon.shapes import Drawing, PageImage, Points
from tests.daemon.graph.drawn import page, silent

_WIDTH_PX = 3.0


def drawn(*lines: list[tuple[float, float]]) -> tuple[PageImage, Drawing]:
    """A disc of 25 px and lines, as they are understood."""
    given = page(list(lines), width_px=int(_WIDTH_PX))
    grey = given.grey.copy()
    cv2.circle(grey, (64, 80), 12, 0, -1, cv2.LINE_AA)
    seen = rimmed(replace(given, grey=grey, line_width_px=_WIDTH_PX))
    graph = interpret(seen, silent(seen))
    return replace(given, grey=grey), strokes(graph, width_px=128, height_px=128)


def test_a_blot_is_one_stroke_that_inks_all_of_it() -> None:
    given, drawing = drawn([(10, 10), (110, 10)])
    blot = [stroke for stroke in drawing.strokes if stroke.points[:, 1].max() > 20]
    assert len(blot) == 1
    ink = np.zeros((128 * 8, 128 * 8), np.uint8)
    cv2.polylines(ink, [np.rint((blot[0].points + 0.5) * 8).astype(np.int32)], False, 255, 24)
    inked = cv2.resize(ink, (128, 128), interpolation=cv2.INTER_AREA) > 128
    black = given.grey < 128
    black[:20] = False
    assert (black & inked).sum() > 0.97 * black.sum()
    assert (inked & ~black).sum() < 0.05 * black.sum()


def test_a_note_and_its_stem_are_one_stroke() -> None:
    _, drawing = drawn([(75, 80), (75, 20)])
    assert len(drawing.strokes) == 1
    assert drawing.strokes[0].points[:, 1].min() < 24


def test_a_line_that_runs_through_a_blot_costs_no_further_lift() -> None:
    _, drawing = drawn([(10, 80), (118, 80)])
    ends = np.concatenate([stroke.points[[0, -1]] for stroke in drawing.strokes])
    assert len(drawing.strokes) <= 2
    assert ends[:, 0].min() == pytest.approx(10, abs=2)
    assert ends[:, 0].max() == pytest.approx(118, abs=2)


def ring(*spokes: float) -> Lines:
    """A closed rim of radius 10 about the origin, cut where it is met by a line from outside at these angles."""
    angles = np.radians(spokes)
    rim = 10 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    count = len(spokes)
    arcs = [np.array([rim[i], rim[(i + 1) % count]]) for i in range(count)]
    outer: list[Points] = [np.array([point, 3 * point]) for point in rim]
    ends = [(i, (i + 1) % count) for i in range(count)] + [(i, count + i) for i in range(count)]
    polylines = arcs + outer
    return Lines(polylines, [np.ones(2, bool)] * len(polylines), np.array(ends), np.concatenate([rim, 3 * rim]))


FILL = np.array([[-5.0, -6], [5, -6], [8, 0], [-8, 0], [-5, 6], [5, 6]])


def test_both_ends_of_a_fill_go_to_vertices_where_an_odd_number_of_lines_end() -> None:
    lines = led_in([FILL], ring(20, 200), width_px=_WIDTH_PX)
    assert sorted(lines.ends[-1].tolist()) == [0, 1]
    for end, point in zip(lines.ends[-1], lines.polylines[-1][[0, -1]], strict=True):
        assert np.array_equal(lines.vertices[end], point)
    assert (np.bincount(lines.ends.ravel())[:2] % 2 == 0).all()


def test_a_vertex_where_an_even_number_of_lines_end_is_left_though_it_is_nearer() -> None:
    every = ring(20, 160, 230)
    rim = Lines(every.polylines[:5], every.sound[:5], every.ends[:5], every.vertices)
    assert sorted(led_in([FILL], rim, width_px=_WIDTH_PX).ends[-1].tolist()) == [0, 1]


def test_a_fill_with_one_vertex_on_its_rim_begins_there_and_ends_in_the_open() -> None:
    rim = ring(20)
    alone = Lines(rim.polylines[:1], rim.sound[:1], rim.ends[:1], rim.vertices)
    lines = led_in([FILL], alone, width_px=_WIDTH_PX)
    assert 0 in lines.ends[-1]
    assert len(lines.vertices) == len(alone.vertices) + 1


def test_a_fill_whose_rim_is_not_there_stays_alone() -> None:
    lines = led_in([FILL + 60.0], ring(20, 200), width_px=_WIDTH_PX)
    assert np.array_equal(lines.polylines[-1], FILL + 60.0)
    assert lines.ends[-1].min() >= 4
