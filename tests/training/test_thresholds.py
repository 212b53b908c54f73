"""The threshold study on drawings whose lines are known, and its command on a few zigzags."""

import json
from pathlib import Path

import numpy as np
import pytest

from daemon.graph.feedback import Adaptation
from daemon.graph.interpret import interpret
from daemon.shapes import PageImage, Segmentation
from daemon.vision.segmenter import Segmenter
from training import thresholds, thresholds_measure, thresholds_pictures
from training.render import CORNERS, LINES, polylines
from training.thresholds_measure import (
    LINE,
    OFF,
    THROUGH,
    Alone,
    all_pairs,
    approximate_threshold,
    kinds,
    known_lines,
    measure,
    outranks,
    scores,
)

pytestmark = [pytest.mark.training, pytest.mark.filterwarnings("ignore")]

CROSS = [np.array([[20.0, 100.0], [180.0, 100.0]]), np.array([[100.0, 20.0], [100.0, 180.0]])]
MARKS = "\n".join(f"<!-- {name} -->\n<!-- /{name} -->" for name in ("measured", "tau-hat", "separation", "settings"))


def page_of(strokes: list[np.ndarray]) -> tuple[PageImage, Segmentation]:
    """A page and what a network without fault says of it."""
    sample = polylines(strokes, 221)
    lines, corners = ((sample.label == label).astype(np.float32) for label in (LINES, CORNERS))
    page = PageImage(255 - sample.ink, np.eye(3), 221, 221, "", line_width_px=2.0)
    return page, Segmentation(1 - lines - corners, lines, corners)


def test_a_cross_has_four_lines_of_two_segments() -> None:
    known = known_lines(CROSS)
    assert (len(known.vertices), len(known.lines), known.segments) == (5, 4, 2)
    assert known.lengths_px.tolist() == [80.0] * 4


def test_a_line_drawn_twice_counts_once() -> None:
    known = known_lines([CROSS[0], CROSS[0][::-1], np.array([[100.0, 100.0], [180.0, 100.0]])])
    assert (len(known.vertices), len(known.lines)) == (3, 2)


def test_a_point_that_comes_twice_is_no_segment() -> None:
    known = known_lines([np.array([[20.0, 100.0], [20.0, 100.0], [180.0, 100.0]])])
    assert (len(known.lines), known.segments) == (1, 1)


def test_strokes_that_stand_still_have_no_line() -> None:
    assert len(known_lines([np.array([[5.0, 5.0], [5.2, 5.2]]), np.array([[9.0, 9.0]])]).lines) == 0


def test_a_pair_is_a_line_or_goes_through_a_vertex_or_is_off_the_ink() -> None:
    known, pairs = known_lines(CROSS), all_pairs(5)
    kind = kinds(known, pairs, polylines(CROSS, 221).ink > 127)
    assert np.bincount(kind).tolist() == [4, 2, 4]
    through = known.vertices[pairs[kind == THROUGH]]
    assert np.hypot(*(through[:, 1] - through[:, 0]).T).tolist() == [160.0, 160.0]


def test_tau_hat_is_the_mean_of_three_scores_around_the_cut() -> None:
    eta = np.array([0.1, 0.9, 0.0, 0.6, 0.8])
    assert approximate_threshold(eta, 2) == pytest.approx((0.9 + 0.8 + 0.6) / 3)
    assert approximate_threshold(eta, 3) == pytest.approx((0.8 + 0.6 + 0.1) / 3)
    assert approximate_threshold(eta, 1) == pytest.approx((0.9 + 0.8) / 2)
    assert approximate_threshold(eta, 9) == pytest.approx((0.1 + 0.0) / 2)


def test_lines_outrank_what_is_off_the_ink_but_not_what_goes_through_a_vertex() -> None:
    known, pairs = known_lines(CROSS), all_pairs(5)
    page, maps = page_of(CROSS)
    kind, eta = kinds(known, pairs, page.grey < 128), scores(maps.lines, known.vertices, pairs, 3.0)
    assert outranks(eta[kind == LINE], eta[kind == OFF]) == 1.0
    assert outranks(eta[kind == LINE], eta[kind == THROUGH]) == 0.0
    assert outranks(np.array([0.5]), np.array([0.5, 0.4])) == 0.75
    assert outranks(np.array([0.5]), np.array([])) is None


def test_the_equations_on_all_pairs_are_those_of_the_daemon() -> None:
    page, maps = page_of(CROSS)
    ours = Alone(page, maps).strokes(Adaptation())
    theirs = [edge.polyline for edge in interpret(page, maps, mode="paper").edges]
    assert len(ours) == 6
    assert {each.tobytes() for each in ours} == {each.tobytes() for each in theirs}


def test_tables_go_between_their_marks_and_nowhere_else() -> None:
    text = "a\n<!-- x -->\nold\n<!-- /x -->\nb\n"
    assert thresholds.fill(text, {"x": "new"}) == "a\n<!-- x -->\nnew\n<!-- /x -->\nb\n"
    with pytest.raises(ValueError, match="'y'"):
        thresholds.fill(text, {"y": "new"})


def test_the_command_measures_writes_and_prints_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    random = np.random.default_rng(5)
    rows = [{"word": "zigzag", "drawing": [random.integers(0, 256, (2, 5)).tolist()]} for _ in range(3)]
    data, page = tmp_path / "zigzags.ndjson", tmp_path / "thresholds.md"
    data.write_text("\n".join(map(json.dumps, rows)))
    page.write_text(f"words\n{MARKS}\n<!-- grid -->\n<!-- /grid -->\n")
    monkeypatch.setattr(thresholds, "FOLDER", tmp_path)
    monkeypatch.setattr(thresholds, "CACHE", tmp_path / "cache")
    monkeypatch.setattr(thresholds_pictures, "SHOWN", ("star.png",))
    for module in (thresholds, thresholds_measure):
        monkeypatch.setattr(module, "TAU0S", (0.35, 0.65))
        monkeypatch.setattr(module, "RATES", (0.0, 0.1))
    command = ["--data", str(data), "--limit", "3", "--grid", "1"]
    assert thresholds.main(command) == 0
    found = json.loads((tmp_path / "thresholds.json").read_text())
    assert (found["n"], found["grid_n"], len(found["grid"])) == (3, 1, 4)
    seven = found["settings"][3]
    assert seven["alone"]["edges"] > seven["repaired"]["edges"] > 0.5
    assert seven["repaired"]["precision"] > 95.0
    assert sum(found["thresholds"]["3"]["known"]["tau"]["counts"]) == 3
    assert all(f"thresholds_{name}.png" in {f.name for f in tmp_path.iterdir()} for name in ("tau", "grid", "fixed"))
    printed = capsys.readouterr().out
    assert all(block in page.read_text() for block in printed.strip().split("\n\n"))

    assert thresholds.main([]) == 0
    assert capsys.readouterr().out == printed


def test_measuring_goes_on_after_a_row_that_was_cut_off(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    data = tmp_path / "lines.ndjson"
    data.write_text("\n".join(json.dumps({"word": "line", "drawing": [[[0, 9], [0, k]]]}) for k in (1, 5)))
    monkeypatch.setattr(thresholds, "CACHE", tmp_path / "cache")
    whole = thresholds.rows_of(data, 2, 0)
    (cache,) = (tmp_path / "cache").iterdir()
    cache.write_text(cache.read_text()[:-9])
    measured: list[object] = []
    monkeypatch.setattr(
        thresholds, "measure", lambda *given, grid: measured.append(given) or measure(*given, grid=grid)
    )
    assert thresholds.rows_of(data, 2, 0) == whole
    assert len(measured) == 1
    assert [row["lines"] for row in whole] == [1, 1]
    assert cache.read_text().count("\n") == 2


def test_a_sketch_without_a_line_is_left_out() -> None:
    dot = [np.array([[0, 0], [0, 0]], np.float32), np.array([[99, 99]], np.float32)]
    assert thresholds_measure.measure(dot, Segmenter(threads=1), grid=False) is None
