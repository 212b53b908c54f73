"""The drawings and random strokes whose order is measured."""

from __future__ import annotations

import numpy as np
import pytest

from tests.benchmarks.fidelity.curves import curves
from tests.benchmarks.fidelity.planar import graph
from tests.benchmarks.fidelity.travel import (
    CURVES,
    REFERENCE_MM,
    SEEDS,
    TECHNICAL,
    drawings,
    ordered,
    random_strokes,
    shuffled,
)


def test_without_a_file_of_sketches_there_are_fourteen_drawings() -> None:
    names = [known.name for known in drawings(None)]
    assert len(names) == CURVES + TECHNICAL == 14
    assert {"house", "waves", "hatch", "chords"} <= set(names)


def test_shuffled_edges_are_the_same_edges_in_another_order() -> None:
    cut = graph(curves()[0].strokes)
    mixed = shuffled(cut)
    assert mixed.edges != cut.edges
    assert {id(edge) for edge in mixed.edges} == {id(edge) for edge in cut.edges}


def test_a_drawing_cut_at_its_junctions_is_put_together_again() -> None:
    (row,) = ordered([known for known in curves() if known.name == "waves"])
    assert row.edges > 30
    assert row.lifts == row.minimum == 8
    assert 0 < row.pen_up_px < row.pen_up_and_back_px


@pytest.mark.parametrize("count", REFERENCE_MM)
def test_random_strokes_lie_on_the_sheet_and_come_again(count: int) -> None:
    given = random_strokes(count, SEEDS[0])
    every = np.concatenate(given)
    assert len(given) == count
    assert {len(points) for points in given} <= set(range(2, 9))
    assert every.min() >= 0
    assert every.max() <= 200
    assert np.array_equal(every, np.concatenate(random_strokes(count, SEEDS[0])))
