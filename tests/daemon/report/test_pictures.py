"""The pictures of a report: what must be found on them, and that odd input leaves them whole."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from daemon.report import canvas
from daemon.report.canvas import Colour, Picture
from daemon.report.contact_sheet import Row, contact_sheet, drawn_tile, understood_tile
from daemon.report.explain import explain
from daemon.report.preview import in_words, preview
from daemon.shapes import Drawing, Edge, LineGraph, PageImage, Points, Segmentation, Step, Stroke, Toolpath

LINE = np.array([[20.0, 30.0], [70.0, 30.0]])
ARC = np.array([[20.0, 80.0], [40.0, 70.0], [70.0, 80.0]])


def has(picture: Picture, colour: Colour) -> bool:
    return bool((picture == np.array(colour, np.uint8)).all(axis=2).any())


def page_with(*lines: Points) -> PageImage:
    grey = np.full((100, 120), 255, np.uint8)
    for line in lines:
        cv2.polylines(grey, [line.astype(np.int32)], False, 0, 2)
    return PageImage(grey, np.eye(3), 120, 100, "")


def explained(page: PageImage, *strokes: Points, name: str = "house.png") -> Picture:
    ink = (page.grey < 128).astype(np.float32)
    corners = np.zeros_like(ink)
    corners[28:33, 18:23] = 1
    segmentation = Segmentation(1 - np.maximum(ink, corners), ink * (1 - corners), corners)
    edges = tuple(Edge(0, 1, stroke, 1.0) for stroke in strokes)
    vertices = np.array([stroke[0] for stroke in strokes]).reshape(-1, 2)
    drawing = Drawing(tuple(Stroke(stroke) for stroke in strokes), 120, 100)
    return explain(page, segmentation, LineGraph(vertices, edges), drawing, name=name)


def toolpath(*strokes: Points) -> Toolpath:
    return Toolpath(tuple(Stroke(stroke) for stroke in strokes), np.eye(2, 3))


def sheet(path: Toolpath) -> Picture:
    return preview(path, box_mm=(64.0, 64.0), box_origin_mm=(25.0, 25.0), seconds=83.0)


def test_explain_shows_vertices_straight_and_bent_edges() -> None:
    picture = explained(page_with(LINE, ARC), LINE, ARC)
    assert has(picture, canvas.ORANGE)
    assert has(picture, canvas.GREEN)
    assert has(picture, canvas.BLUE)


def test_explain_marks_ink_that_no_stroke_passes() -> None:
    assert not has(explained(page_with(LINE, ARC), LINE, ARC), canvas.RED)
    assert has(explained(page_with(LINE, ARC), LINE), canvas.RED)


def test_explain_shows_an_empty_page_and_a_very_long_name() -> None:
    picture = explained(page_with(), name="x" * 500)
    assert picture.shape == explained(page_with(LINE), LINE).shape


def test_explain_shows_the_page_before_each_step_and_nothing_more_of_a_clean_one() -> None:
    clean = page_with(LINE)
    put_right = replace(clean, steps=tuple(Step(f"step {number}", clean.grey // 2) for number in range(5)))
    picture, without = explained(put_right, LINE), explained(clean, LINE)
    below = picture[len(without) :]
    assert np.array_equal(picture[: len(without)], without)
    assert ((below == 127).all(axis=2).sum(axis=1) > 1000).any()
    assert (below == 127).all(axis=2).any(axis=0).sum() > 1000


def test_preview_draws_with_y_up() -> None:
    low = sheet(toolpath(np.array([[30.0, 30.0], [80.0, 30.0]])))
    high = sheet(toolpath(np.array([[30.0, 80.0], [80.0, 80.0]])))
    assert first_row_of(low, canvas.INK) > first_row_of(high, canvas.INK)


def first_row_of(picture: Picture, colour: Colour) -> int:
    return int(np.flatnonzero((picture == np.array(colour, np.uint8)).all(axis=2).any(axis=1))[0])


def test_preview_keeps_the_aspect_of_the_sheet() -> None:
    picture = sheet(toolpath(np.array([[30.0, 30.0], [80.0, 30.0], [80.0, 80.0], [30.0, 80.0], [30.0, 30.0]])))
    rows, columns = np.nonzero((picture[:-100] == np.array(canvas.INK, np.uint8)).all(axis=2))
    assert np.ptp(rows) == pytest.approx(np.ptp(columns), abs=3)


def test_preview_shows_a_sheet_without_strokes() -> None:
    assert not has(sheet(toolpath())[:-80], canvas.INK)


@pytest.mark.parametrize("far", [(900.0, 20.0), (20.0, 900.0)])
def test_preview_grows_around_a_drawing_far_outside_the_box(far: tuple[float, float]) -> None:
    picture = sheet(toolpath(np.array([[-400.0, 0.0], far])))
    assert picture.shape[1] >= 800
    assert (picture[:-80] < 110).all(axis=2).sum() > 900


@pytest.mark.parametrize(
    ("seconds", "words"), [(0.4, "0 s"), (59.7, "1 min 00 s"), (83, "1 min 23 s"), (3900, "1 h 05 min")]
)
def test_durations_are_said_in_words(seconds: float, words: str) -> None:
    assert in_words(seconds) == words


def row(name: str = "house", **more: object) -> Row:
    given = canvas.blank(120, 60)
    return Row(name, given, [LINE], [LINE + np.array([0.0, 20.0])], **more)  # type: ignore[arg-type]


def test_a_contact_sheet_has_equal_rows_however_different_the_jobs() -> None:
    one = contact_sheet([row()], title="linedrawd")
    three = contact_sheet([row(), row("n" * 200, f1=0.98, seconds=83.0), row(trouble="lost " * 99)], title="linedrawd")
    two = contact_sheet([row(), row()], title="linedrawd")
    assert three.shape[1] == one.shape[1]
    assert three.shape[0] - two.shape[0] == two.shape[0] - one.shape[0]


def test_many_jobs_stand_in_two_columns() -> None:
    six, seven = (contact_sheet([row()] * count, title="linedrawd") for count in (6, 7))
    assert seven.shape[1] > 1.8 * six.shape[1]
    assert seven.shape[0] < six.shape[0]


def test_a_contact_sheet_without_jobs_is_a_heading() -> None:
    assert contact_sheet([], title="linedrawd").shape[0] > 0


def test_strokes_and_ink_lie_on_their_tiles_as_on_the_given_picture() -> None:
    # 120 x 60 px on a square tile of 300 px: 2.5 times as large, 75 px of margin above.
    strokes = np.nonzero((understood_tile(row()) != 255).any(axis=2))
    ink = np.nonzero((drawn_tile(row()) < 128).all(axis=2))
    assert strokes[0].mean() == pytest.approx(75 + 30.5 * 2.5, abs=2)
    assert ink[0].mean() == pytest.approx(75 + 50.5 * 2.5, abs=1)
    assert ink[1].mean() == pytest.approx(45.5 * 2.5, abs=1)


def test_ink_is_as_wide_as_the_pen() -> None:
    wide = (drawn_tile(row(line_width_px=4.0)) < 128).all(axis=2)
    assert wide[:, 110].sum() == pytest.approx(10, abs=1)


@pytest.mark.parametrize("width_px", [1, 3, 5, 9])
def test_a_line_is_as_wide_as_it_was_asked_for(width_px: int) -> None:
    picture = canvas.blank(60, 40)
    canvas.line(picture, np.array([[10.0, 20.0], [50.0, 20.0]]), (0, 0, 0), width_px)
    assert (255 - picture[:, 30, 0].astype(float)).sum() / 255 == pytest.approx(width_px, abs=0.7)


def test_a_dot_of_ink_is_as_wide_as_the_pen() -> None:
    dot = replace(row(line_width_px=4.0), drawn=[np.array([[60.0, 30.0]])])
    assert (drawn_tile(dot) < 128).all(axis=2).sum() == pytest.approx(np.pi * 5**2, rel=0.15)


def test_neighbouring_strokes_differ_in_colour() -> None:
    colours = canvas.many_colours()
    some = np.array([next(colours) for _ in range(40)], float)
    assert np.abs(np.diff(some, axis=0)).sum(axis=1).min() > 60


def test_a_word_that_fits_is_not_shortened() -> None:
    assert canvas.shortened("house.png", 500) == "house.png"
    assert canvas.words_width_px(canvas.shortened("a" * 80, 120)) <= 120


def test_a_picture_becomes_a_png_file() -> None:
    picture = contact_sheet([row()], title="linedrawd")
    assert np.array_equal(cv2.imdecode(np.frombuffer(canvas.png(picture), np.uint8), cv2.IMREAD_COLOR), picture)
