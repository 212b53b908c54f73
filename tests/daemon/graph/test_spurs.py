"""Loose ends within the ink of other lines are left out; ticks that stand out of it stay."""

from __future__ import annotations

import numpy as np
import pytest

from daemon.graph.crossings import Lines
from daemon.graph.interpret import interpret
from daemon.graph.spurs import unspurred
from daemon.graph.strokes import strokes
from tests.daemon.graph.drawn import channels, degrees, page
from tests.daemon.graph.test_crossings import lines_of

Corners = list[tuple[float, float]]
LINE: Corners = [(0.0, 20.0), (30.0, 20.0), (60.0, 20.0)]
THROUGH = [(0, 1), (1, 2)]
WIDTH_PX = 3.0
RIM = np.zeros((64, 64), np.float32)
"""No ink beyond any loose end."""


def beside(tip: tuple[float, float], *more: tuple[float, float]) -> Lines:
    """A line with a short edge from its middle to a loose tip, and others from the tip on."""
    pairs = [*THROUGH, (1, 3), *((3 + i, 4 + i) for i in range(len(more)))]
    return lines_of([*LINE, tip, *more], pairs)


@pytest.mark.parametrize("tip", [(31.0, 22.0), (33.0, 20.5), (30.0, 22.9)])
def test_a_loose_end_within_a_lines_ink_is_a_spur(tip: tuple[float, float]) -> None:
    fewer = unspurred(beside(tip), RIM, width_px=WIDTH_PX)
    assert fewer is not None
    assert fewer.ends.tolist() == [list(pair) for pair in THROUGH]
    assert (fewer.kept, fewer.gone) == ([0, 1], {2: "spur"})


@pytest.mark.parametrize("tip", [(30.0, 23.2), (31.0, 24.0)])
def test_a_tick_that_stands_out_of_the_line_is_none(tip: tuple[float, float]) -> None:
    assert unspurred(beside(tip), RIM, width_px=WIDTH_PX) is None


def test_a_loose_end_where_a_pen_has_stopped_is_none() -> None:
    ink = RIM.copy()
    ink[20:25, 29:32] = 1.0
    assert unspurred(beside((30.0, 22.9)), ink, width_px=WIDTH_PX) is None


def test_an_edge_that_leads_on_is_none() -> None:
    assert unspurred(beside((31.0, 22.0), (33.0, 60.0)), RIM, width_px=WIDTH_PX) is None


def test_the_short_end_of_a_line_is_none() -> None:
    assert unspurred(lines_of([*LINE[1:], (62.0, 21.0)], [(0, 1), (1, 2)]), RIM, width_px=WIDTH_PX) is None


def test_of_two_loose_ends_at_the_end_of_a_line_one_stays() -> None:
    fewer = unspurred(
        lines_of([(0, 20), (30, 20), (32, 21), (31, 18)], [(0, 1), (1, 2), (1, 3)]), RIM, width_px=WIDTH_PX
    )
    assert fewer is not None
    assert fewer.ends.tolist() in ([[0, 1], [1, 2]], [[0, 1], [1, 3]])


def test_a_false_corner_beside_a_line_adds_no_stroke() -> None:
    drawn = page([[(20, 64), (108, 64)]], width_px=3)
    graph = interpret(drawn, channels(drawn, [(20, 64), (60, 64), (61, 67), (108, 64)]))
    assert len(strokes(graph, width_px=128, height_px=128).strokes) == 1


def test_a_tick_of_two_line_widths_is_drawn() -> None:
    drawn = page([[(20, 64), (108, 64)], [(60, 64), (60, 70)]], width_px=3)
    corners = [(20, 64), (60, 64), (60, 70), (108, 64)]
    assert degrees(interpret(drawn, channels(drawn, corners))) == [1, 1, 1, 3]
