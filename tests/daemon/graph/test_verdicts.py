"""Each candidate for an edge is told with the rule that kept or refused it."""

from __future__ import annotations

import json

import pytest

from daemon.graph.interpret import interpret, interpret_with_reasons
from daemon.graph.verdicts import Rule, Verdict, as_json
from daemon.shapes import LineGraph
from tests.daemon.graph.drawn import Lines, channels, circle, page

CROSS: Lines = [[(20, 64), (108, 64)], [(64, 20), (64, 108)]]
ARC = circle(64, 64, 40, turns=0.4)


def told(lines: Lines, corners: list[tuple[float, float]]) -> tuple[LineGraph, list[Verdict]]:
    drawn = page(lines)
    graph, reasons = interpret_with_reasons(drawn, channels(drawn, corners))
    return graph, reasons()


def rule(said: list[Verdict], one: tuple[float, float], other: tuple[float, float]) -> Rule:
    """Of the one verdict on this pair for a straight edge."""
    (found,) = [v for v in said if {v.start_px, v.end_px} == {one, other} and v.rule not in ("traced", "covered")]
    return found.rule


def test_an_edge_is_kept_and_one_that_passes_by_a_corner_is_suppressed() -> None:
    _, said = told(CROSS, [*CROSS[0], *CROSS[1], (64, 64)])
    assert rule(said, (20, 64), (64, 64)) == "straight"
    assert rule(said, *CROSS[0]) == "suppression"


@pytest.mark.parametrize(
    ("lines", "pair", "why"),
    [
        ([ARC], (ARC[0], ARC[-1]), "bend"),
        ([[(20, 64), (54, 64)], [(63, 64), (108, 64)]], ((20, 64), (108, 64)), "gap"),
    ],
)
def test_a_refused_candidate_names_the_rule(
    lines: Lines, pair: tuple[tuple[float, float], tuple[float, float]], why: Rule
) -> None:
    one, other = ((round(x), round(y)) for x, y in pair)
    _, said = told(lines, [one, other])
    assert rule(said, one, other) == why


def test_ink_that_bends_is_traced_and_ink_under_a_straight_edge_is_covered() -> None:
    _, bent = told([ARC], [])
    _, straight = told(CROSS[:1], CROSS[0])
    assert [verdict.rule for verdict in bent] == ["traced"]
    assert [verdict.rule for verdict in straight if verdict.plausibility is None] == ["covered"]


def test_reasons_cost_the_graph_nothing() -> None:
    drawn = page(CROSS)
    segmentation = channels(drawn, CROSS[0])
    graph, _ = interpret_with_reasons(drawn, segmentation)
    assert len(graph.edges) == len(interpret(drawn, segmentation).edges)


def test_the_weakest_pixel_of_an_edge_is_known() -> None:
    drawn = page(CROSS[:1])
    segmentation = channels(drawn, CROSS[0])
    segmentation.lines[:, 40] = 0.25
    (edge,) = interpret(drawn, segmentation).edges
    assert edge.least_plausibility == pytest.approx(0.25)
    assert 0.9 < edge.plausibility < 1.0


def test_the_file_tells_each_edge_with_its_figures() -> None:
    graph, said = told([*CROSS[:1], [(64, 100), (64, 100)]], CROSS[0])
    words = json.loads(json.dumps(as_json(graph, said), allow_nan=False))
    assert [edge["kind"] for edge in words["edges"]] == ["straight", "dot"]
    assert words["edges"][0]["length_px"] == pytest.approx(88, abs=2)
    assert words["candidates"][0] | {"plausibility": 1.0} == {
        "start_px": [20, 64],
        "end_px": [108, 64],
        "kept": True,
        "rule": "straight",
        "plausibility": 1.0,
    }
