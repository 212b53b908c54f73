"""Why an edge was kept or refused: every candidate with the rule that decided."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from daemon.graph.plausibility import Floats
from daemon.graph.skeleton import Chain, Indices
from daemon.shapes import LineGraph, Points

Rule: TypeAlias = Literal[
    "straight", "bend", "gap", "fill", "plausibility", "suppression", "threshold", "prune", "traced", "covered"
]
"""What decided. Kept: `straight` by all rules of a straight edge, `traced` along the ink. Refused, in the order in
which the rules look: `bend` its own chain of ink leaves the straight line; `gap` ink is missing; `fill` less than a
line's width of ink; `plausibility` below all thresholds; `suppression` passes by a corner; `threshold` Eqs. 1 and 3;
`prune` others cover it; `covered` a chain of ink that straight edges draw already."""
STRAIGHT_RULES: tuple[Rule, ...] = (
    "straight",
    "bend",
    "gap",
    "fill",
    "plausibility",
    "suppression",
    "threshold",
    "prune",
)
KEPT, BEND, GAP, FILL, PLAUSIBILITY, SUPPRESSION, THRESHOLD, PRUNE = range(8)


@dataclass(frozen=True, slots=True, eq=False)
class Judged:
    """Candidates for straight edges: pairs (P, 2) of vertices, eta (P,), nan where nobody looked, and rules (P,)."""

    pairs: Indices
    eta: Floats
    rules: NDArray[np.int8]

    @property
    def kept(self) -> Indices:
        return np.asarray(self.pairs[self.rules == KEPT], np.intp)


@dataclass(frozen=True, slots=True)
class Verdict:
    """On one candidate, from one vertex to another as they were found, in px of the page."""

    start_px: tuple[float, float]
    end_px: tuple[float, float]
    plausibility: float | None
    rule: Rule

    @property
    def kept(self) -> bool:
        return self.rule in ("straight", "traced")


def verdicts(vertices: Points, judged: Judged, chains: Sequence[Chain], traced: Iterable[Chain]) -> list[Verdict]:
    """On all candidates: pairs for a straight edge first, then chains of ink."""
    places = [(round(x, 2), round(y, 2)) for x, y in vertices.tolist()]
    rows = zip(judged.pairs.tolist(), judged.eta.tolist(), judged.rules.tolist(), strict=True)
    straight = [
        Verdict(places[p], places[q], None if math.isnan(eta) else eta, STRAIGHT_RULES[rule])
        for (p, q), eta, rule in rows
    ]
    followed = set(map(id, traced))
    return straight + [
        Verdict(places[chain.start], places[chain.end], None, "traced" if id(chain) in followed else "covered")
        for chain in chains
    ]


def as_json(graph: LineGraph, said: Sequence[Verdict]) -> dict[str, Any]:
    """The graph edge by edge and every candidate with its verdict, in px of the page, for `json.dumps`."""
    edges = [
        {
            "start": edge.start,
            "end": edge.end,
            "kind": ("dot", "straight", "bent")[min(len(edge.polyline), 3) - 1],
            "length_px": round(float(np.hypot(*np.diff(edge.polyline, axis=0).T).sum()), 2),
            "plausibility": round(edge.plausibility, 4),
            "least_plausibility": round(edge.least_plausibility, 4),
        }
        for edge in graph.edges
    ]
    candidates = [
        {
            "start_px": verdict.start_px,
            "end_px": verdict.end_px,
            "kept": verdict.kept,
            "rule": verdict.rule,
            "plausibility": verdict.plausibility if verdict.plausibility is None else round(verdict.plausibility, 4),
        }
        for verdict in said
    ]
    return {"vertices_px": graph.vertices.round(2).tolist(), "edges": edges, "candidates": candidates}
