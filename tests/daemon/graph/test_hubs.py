"""Many lines that run into one point meet in one vertex."""

from __future__ import annotations

import numpy as np
import pytest

from daemon.graph.crossings import Lines
from daemon.graph.hubs import hubs
from daemon.graph.interpret import interpret
from tests.daemon.graph.drawn import degrees, distances, page, polylines, silent

TIP = np.array([20.0, 64.0])


def fan(count: int, *, widest: float = 60.0) -> list[np.ndarray]:
    angles = np.radians(np.linspace(-widest, widest, count))
    return [np.array([TIP, TIP + 90 * np.array([np.cos(a), np.sin(a)])]) for a in angles]


def knotted(count: int, *, off_px: float) -> Lines:
    """A fan that ends in a knot of three vertices; every second line misses the tip by so much."""
    vertices, ends = list(TIP + np.array([[3.0, -3], [4, 0], [3, 3]])), [(0, 1), (1, 2)]
    drawn = [np.array([vertices[a], vertices[b]]) for a, b in ends]
    for index, (near, far) in enumerate(fan(count)):
        aside = off_px * (index % 2) * np.array([-(far - near)[1], (far - near)[0]]) / 90
        drawn.append(np.linspace(near + aside + (far - near) / 30, far + aside, 88))
        ends.append((min(2, 3 * index // count), 3 + index))
        vertices.append(far + aside)
    sound = [np.arange(len(line)) > 6 for line in drawn]
    return Lines(drawn, sound, np.array(ends), np.array(vertices))


def test_a_fan_of_lines_is_led_into_its_tip() -> None:
    lines = fan(7, widest=85.0)
    drawn = page([[tuple(point) for point in 0.6 * line + 20] for line in lines], width_px=2)
    graph = interpret(drawn, silent(drawn))
    assert degrees(graph) == [1] * 7 + [7]
    assert distances([0.6 * line + 20 for line in lines], polylines(graph)).max() < 1.5


@pytest.mark.parametrize(
    ("count", "off_px", "drawn_together"), [(9, 0.5, True), (9, 5.0, False), (15, 5.0, False), (5, 0.0, False)]
)
def test_a_knot_is_drawn_together_where_enough_lines_meet(count: int, off_px: float, drawn_together: bool) -> None:
    better = hubs(knotted(count, off_px=off_px), width_px=3.0)
    assert (better is not None) == drawn_together
    if better is not None:
        assert np.bincount(better.ends.ravel()).max() == count
        assert np.hypot(*(better.vertices[better.ends[0, 0]] - TIP)) < 1.0
        assert better.gone == {0: "knot", 1: "knot"}
        assert better.kept == list(range(2, 2 + count))
