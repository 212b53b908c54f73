"""The metrics say what they are named for."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from daemon.shapes import Points
from tests.benchmarks.fidelity.bars import BARS, FIGURES, Bar, Scored
from tests.benchmarks.fidelity.curves import curves
from tests.benchmarks.fidelity.known import Known
from tests.benchmarks.fidelity.measure import Measure, measure, pen_up_px, samples
from tests.benchmarks.fidelity.nearest import nearest_px
from tests.benchmarks.fidelity.ours import understood
from tests.benchmarks.fidelity.table import verdict
from tests.drawings.hand import line, ring

LINE: Points = line((20, 40), (100, 40))
KNOWN = Known("a line", [LINE], 128)
PERFECT = Measure(
    chamfer_px=0, precision=1, recall=1, f1=1, iou=1, ink_recall=1, length_ratio=1,
    stroke_ratio=1, strokes=1, minimum=1, invented_px=0, pen_up_px=44.7,
)  # fmt: skip


def lower(by_px: float) -> Points:
    return np.asarray(LINE + np.array([0, by_px]))


def test_the_true_strokes_are_perfect() -> None:
    found = measure(KNOWN, KNOWN.strokes)
    assert replace(found, pen_up_px=44.7) == PERFECT
    assert found.pen_up_px == pytest.approx(math.hypot(20, 40))


def test_a_shift_is_not_forgiven() -> None:
    found = measure(KNOWN, [lower(1)])
    assert found.chamfer_px == pytest.approx(1.0, abs=0.01)
    assert (found.precision, found.recall) == (1, 1)
    assert found.iou == pytest.approx(2 / 4, abs=0.02)


def test_beyond_a_pixel_and_a_half_a_line_is_another() -> None:
    assert measure(KNOWN, [lower(1.4)]).f1 == 1
    assert measure(KNOWN, [lower(1.6)]).f1 == 0


def test_half_a_line_has_half_the_recall() -> None:
    found = measure(KNOWN, [LINE * [0.5, 1] + [10, 0]])
    assert found.recall == pytest.approx(0.5, abs=0.03)
    assert found.precision == 1
    assert found.length_ratio == pytest.approx(0.5)
    assert found.ink_recall == pytest.approx(0.5, abs=0.04)


def test_a_line_drawn_twice_is_twice_too_long() -> None:
    found = measure(KNOWN, [LINE, LINE])
    assert found.length_ratio == pytest.approx(2.0)
    assert found.stroke_ratio == 2


def test_ink_a_pixel_beside_is_not_missing_and_ink_three_beside_is() -> None:
    assert measure(KNOWN, [lower(0.9)]).ink_recall > 0.99
    assert measure(KNOWN, [lower(3)]).ink_recall < 0.8


def test_nothing_drawn_is_nothing_found() -> None:
    found = measure(KNOWN, [])
    assert math.isnan(found.chamfer_px)
    assert (found.f1, found.iou, found.strokes) == (0, 0, 0)


def test_pen_up_counts_the_ways_between_strokes_from_the_corner() -> None:
    drawn: list[Points] = [line((3, 4), (10, 4)), line((10, 8), (30, 40))]
    assert pen_up_px(drawn) == pytest.approx(5 + 4)
    assert pen_up_px(drawn, back=True) == pytest.approx(5 + 4 + 50)


def test_samples_lie_a_quarter_of_a_pixel_apart() -> None:
    steps = np.hypot(*np.diff(samples([ring(50, 50, 30)]), axis=0).T)
    assert steps.max() <= 0.25
    assert steps.min() > 0.24


@pytest.mark.parametrize("spread_px", [3, 40, 900])
def test_distances_to_the_nearest_are_exact(spread_px: float) -> None:
    rng = np.random.default_rng(1)
    points, others = rng.uniform(-9, spread_px, (400, 2)), rng.uniform(0, 50, (300, 2))
    expected = np.hypot(*(points[:, None] - others[None]).transpose(2, 0, 1)).min(axis=1)
    assert nearest_px(points, others) == pytest.approx(expected, abs=1e-9)


def test_a_figure_on_its_bar_meets_it() -> None:
    assert Bar(0.97, 1.02).met(0.97)
    assert Bar(0.97, 1.02).met(1.02)
    assert not Bar(0.97, 1.02).met(1.0201)
    assert not Bar(0.97, 1.02).met(0.9699)
    assert not Bar(high=0.12).met(math.nan)


def test_the_verdict_stands_beside_the_figure() -> None:
    assert verdict("curves", "F1", 0.996).split() == [">=", "0.995", "met"]
    assert verdict("curves", "F1", 0.994).split() == [">=", "0.995", "MISSED"]
    assert verdict("curves", "precision at 1.5 px", 0.1) == ""


def test_the_worst_twentieth_is_the_mean_of_the_lowest() -> None:
    scores = [Scored(str(i), replace(PERFECT, f1=1 - i / 100), cpu_ms=5, network_cpu_ms=2) for i in range(40)]
    assert FIGURES["worst 5 %: F1"](scores) == pytest.approx((0.61 + 0.62) / 2)
    assert FIGURES["without the network"](scores) == 3


def test_every_bar_is_of_a_figure() -> None:
    assert {figure for bars in BARS.values() for figure in bars} <= FIGURES.keys()


def test_what_is_understood_is_in_px_of_the_given_picture() -> None:
    known = next(each for each in curves() if each.name == "circles")
    seen = understood(known.grey)
    assert measure(known, seen.strokes).chamfer_px < 0.25
    assert 0 < seen.network_cpu_ms < seen.cpu_ms
