"""Each candidate for an edge is told with the rule that kept or refused it."""

from __future__ import annotations

import json

import pytest

from daemon.graph.interpret import interpret, interpret_with_reasons
from daemon.graph.verdicts import Origins, Reasons, Rule, as_json
from daemon.shapes import LineGraph
from tests.daemon.graph.drawn import Lines, channels, circle, page

CROSS: Lines = [[(20, 64), (108, 64)], [(64, 20), (64, 108)]]
ARC = circle(64, 64, 40, turns=0.4)


def told(lines: Lines, corners: list[tuple[float, float]]) -> tuple[LineGraph, Reasons]:
    drawn = page(lines)
    graph, reasons = interpret_with_reasons(drawn, channels(drawn, corners))
    return graph, reasons()


def rule(said: Reasons, one: tuple[float, float], other: tuple[float, float]) -> Rule:
    """Of the one verdict on this pair for a straight edge."""
    on_pair = [v for v in said.candidates if {v.start_px, v.end_px} == {one, other}]
    (found,) = [v for v in on_pair if v.rule not in ("traced", "covered")]
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
    assert [verdict.rule for verdict in bent.candidates] == ["traced"]
    assert [verdict.rule for verdict in straight.candidates if verdict.plausibility is None] == ["covered"]


def test_a_bridge_between_melted_lines_is_told() -> None:
    graph, said = told([[(14, 51), (114, 77)], [(14, 77), (114, 51)]], [])
    taken = [verdict for verdict in said.candidates if verdict.rule == "bridge"]
    assert taken
    assert not any(verdict.kept for verdict in taken)
    assert len(said.edges) == len(graph.edges)


def test_every_edge_has_its_rule() -> None:
    blot: Lines = [[(30, 100 + i), (60, 100 + i)] for i in range(0, 14, 2)]
    graph, said = told([*CROSS, ARC, *blot, [(10, 10), (10, 10)]], [*CROSS[0], *CROSS[1], (64, 64)])
    assert set(said.edges) == {"straight", "traced", "filling", "dot"}
    kinds = [len(edge.polyline) for edge in graph.edges]
    assert len(said.edges) == len(kinds)
    assert [kind == 1 for kind in kinds] == [why == "dot" for why in said.edges]
    kept = [verdict.rule for verdict in said.candidates if verdict.kept]
    assert {why: kept.count(why) for why in ("filling", "dot")} == {w: said.edges.count(w) for w in ("filling", "dot")}


def test_a_candidate_is_gone_only_when_no_edge_is_made_of_it() -> None:
    """Candidate 1 was cut into two edges: one of them is taken out, the other stays."""
    found = Origins(((0,), (1,), (1,), (2,))).without([0, 2], {1: "bridge", 3: "spur"})
    assert found.of == ((0,), (1,))
    assert found.gone == {1: "bridge", 2: "spur"}
    assert found.joined([(0, 1)]).of == ((0, 1),)


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
    assert [(edge["kind"], edge["rule"]) for edge in words["edges"]] == [("straight", "straight"), ("dot", "dot")]
    assert words["edges"][0]["length_px"] == pytest.approx(88, abs=2)
    assert words["candidates"][0] | {"plausibility": 1.0} == {
        "start_px": [20, 64],
        "end_px": [108, 64],
        "kept": True,
        "rule": "straight",
        "plausibility": 1.0,
    }
