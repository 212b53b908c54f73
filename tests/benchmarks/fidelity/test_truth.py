"""What is known of a drawing: its ink, its fewest strokes and the length of its lines."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from daemon.graph.strokes import strokes
from daemon.shapes import Points
from tests.benchmarks.fidelity.curves import curves
from tests.benchmarks.fidelity.known import Known
from tests.benchmarks.fidelity.measure import length_px, scribbled
from tests.benchmarks.fidelity.planar import graph, planar
from tests.benchmarks.fidelity.sketches import sketches
from tests.benchmarks.fidelity.technical import technical
from tests.drawings.hand import line, ring

OWN = {known.name: known for known in curves() + technical()}
SQUARE = line((10, 10), (50, 10), (50, 50), (10, 50), (10, 10))


def test_a_line_is_inked_as_wide_as_the_pen() -> None:
    ink = Known("line", [line((10.3, 20.6), (50.3, 20.6))], 64, pen_px=3.0).ink
    assert ink[:, 20:40].sum() / 20 == pytest.approx(3.0, abs=0.01)
    assert (ink[:, 20:40] * np.arange(64)[:, None]).sum() / ink[:, 20:40].sum() == pytest.approx(20.6, abs=0.01)


def test_a_dot_is_a_disc_of_the_pens_width() -> None:
    assert Known("dot", [line((20.2, 20.7))], 64, pen_px=4.0).ink.sum() == pytest.approx(np.pi * 4, rel=0.02)


@pytest.mark.parametrize(
    ("fewest", "lines"),
    [
        (1, [SQUARE]),
        (2, [line((10, 30), (50, 30)), line((30, 10), (30, 50))]),
        (2, [line((10, 10), (50, 10)), line((30, 10), (30, 50))]),
        (1, [line((10, 10), (50, 10)), line((50, 10), (10, 10))]),
        (2, [line((10, 10), (20, 10)), line((40, 10), (50, 10))]),
        (1, [line((10, 10), (20, 10)), line((20.1, 10.1), (50, 10))]),
        (2, [SQUARE, line((30, 30))]),
        (1, [SQUARE, line((10, 10))]),
    ],
    ids=["square", "cross", "T", "there and back", "apart", "meeting within half a pixel", "with a dot", "dot on it"],
)
def test_the_fewest_strokes_are_eulers(fewest: int, lines: list[Points]) -> None:
    assert planar(lines).fewest_strokes == fewest


def test_a_line_drawn_twice_counts_once_in_the_length() -> None:
    assert planar([line((10, 10), (50, 10)), line((40, 10), (20, 10))]).union_px == pytest.approx(40.0)


@pytest.mark.parametrize(
    ("name", "fewest"),
    [("splines", 5), ("waves", 8), ("circles", 5), ("loops", 2), ("chords", 1), ("rings", 1), ("grid", 22)],
)
def test_acute_crossings_of_curves_add_no_strokes(name: str, fewest: int) -> None:
    assert planar(OWN[name].strokes).fewest_strokes == fewest


@pytest.mark.parametrize("name", OWN)
def test_the_graph_of_a_drawing_holds_all_its_lines(name: str) -> None:
    lines = OWN[name].strokes
    edges = [edge.polyline for edge in graph(lines).edges]
    assert length_px(edges) == pytest.approx(planar(lines).union_px, rel=0.005)


@pytest.mark.parametrize("name", ["house", "waves", "grid", "chords"])
def test_the_graph_of_a_drawing_can_be_drawn_in_the_fewest_strokes(name: str) -> None:
    lines = OWN[name].strokes
    drawn = strokes(graph(lines), width_px=512, height_px=512).strokes
    assert len(drawn) == planar(lines).fewest_strokes


def test_a_line_is_scribbled_over_where_the_ink_is_more_than_1_6_times_as_wide() -> None:
    """The middle one of three lines lies 1.5 px and their distance away from the paper."""
    for apart_px, share in ((0.8, 0.0), (1.0, 1 / 3)):
        lines = [line((10, 30 + i * apart_px), (110, 30 + i * apart_px)) for i in range(3)]
        assert scribbled(Known("three lines", lines, 128)) == pytest.approx(share, abs=0.02)


def test_a_crossing_is_no_scribble() -> None:
    assert scribbled(Known("cross", [line((10, 30), (50, 30)), line((30, 10), (30, 50))], 64)) == 0


def test_sketches_are_split_into_those_that_resolve_and_scribbles(tmp_path: Path) -> None:
    scribble = line(*((x / 4, 10 if x % 2 else 90) for x in range(400)))
    rows = [("ring", ring(50, 50, 40)), ("scribble", scribble)]
    file = tmp_path / "rows.ndjson"
    file.write_text("\n".join(json.dumps({"word": word, "drawing": [points.T.tolist()]}) for word, points in rows))
    resolved, scribbles = sketches(file)
    assert [known.name for known in resolved] == ["000 ring"]
    assert [known.name for known in scribbles] == ["001 scribble"]
