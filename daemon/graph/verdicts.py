"""Why an edge was kept or refused: every candidate with the rule that decided."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import count
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from daemon.graph.plausibility import Floats
from daemon.graph.skeleton import Chain, Indices
from daemon.shapes import LineGraph, Points

Rule: TypeAlias = Literal[
    "straight",
    "bend",
    "gap",
    "fill",
    "plausibility",
    "suppression",
    "threshold",
    "prune",
    "traced",
    "covered",
    "short",
    "twice",
    "stub",
    "bridge",
    "rung",
    "knot",
    "loop",
    "spur",
    "filling",
    "dot",
]
"""What decided. Kept: `straight` by all rules of a straight edge, `traced` along the ink, `filling` in the middle of an
area that no line covers, `dot`. Refused, in the order in which the rules look: `bend` its own chain of ink leaves the
straight line; `gap` ink is missing; `fill` less than a line's width of ink; `plausibility` below all thresholds;
`suppression` passes by a corner; `threshold` Eqs. 1 and 3; `prune` others cover it. Of chains of ink: `covered` by
straight edges; `loop` a ring in hardly more ink than a line's width; `short` between vertices that touch and are joined
otherwise; `twice` beside another short one between the same vertices; `stub` into a fork whose other branches straight
edges draw. Taken out again: `knot` within a knot of vertices whose lines meet in one point, `bridge` between two
vertices whose lines meet in one point, `rung` between two lines whose inks touch, `loop`, and `spur` a loose end within
the ink of the lines at its fork."""
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
_KEPT: tuple[Rule, ...] = ("straight", "traced", "filling", "dot")
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
        return self.rule in _KEPT


@dataclass(frozen=True, slots=True)
class Origins:
    """Of which candidates each edge is made, and those that are in none any more with the rule that took them out."""

    of: tuple[tuple[int, ...], ...]
    gone: Mapping[int, Rule] = field(default_factory=dict)

    def joined(self, members: Sequence[tuple[int, ...]]) -> Origins:
        """members: for each new edge the edges that it is made of."""
        return Origins(tuple(tuple(o for edge in some for o in self.of[edge]) for some in members), self.gone)

    def without(self, kept: Sequence[int], gone: Mapping[int, Rule]) -> Origins:
        """kept: the edges that stay, in their new order. gone: those that do not, and why."""
        taken = {origin: rule for edge, rule in gone.items() for origin in self.of[edge]}
        return Origins(tuple(self.of[edge] for edge in kept), {**self.gone, **taken})


@dataclass(frozen=True, slots=True)
class Reasons:
    """edges: for each edge of the graph the rule that keeps it. candidates: the verdict on every candidate."""

    edges: list[Rule]
    candidates: list[Verdict]


@dataclass(frozen=True, slots=True, eq=False)
class Candidates:
    """All that was looked at: pairs for a straight edge, and chains of ink with their rules; some are traced."""

    vertices: Points
    judged: Judged
    chains: Sequence[Chain]
    rules: Sequence[Rule]
    traced: Sequence[Chain]

    def origins(self, pieces: Sequence[int]) -> Origins:
        """Of the kept pairs and then of pieces of the traced chains, the chain of each piece given by its place."""
        straight = len(self.judged.kept)
        return Origins(tuple((index,) for index in [*range(straight), *(straight + piece for piece in pieces)]))


def reasons(looked_at: Candidates, origins: Origins, fillings: Sequence[Points], dots: Points) -> Reasons:
    """Why each edge is in a graph and each candidate is or is not: edges of the origins first, fillings, then dots."""
    straight = len(looked_at.judged.kept)
    left = {origin: rule for origin, rule in origins.gone.items() if origin not in {o for of in origins.of for o in of}}
    edges: list[Rule] = ["straight" if max(of, default=straight) < straight else "traced" for of in origins.of]
    found = [*_on_pairs(looked_at, left), *_on_chains(looked_at, left)]
    found += [Verdict(_place(line[0]), _place(line[-1]), None, "filling") for line in fillings]
    found += [Verdict(_place(dot), _place(dot), None, "dot") for dot in dots]
    edges += ["filling" for _ in fillings]
    edges += ["dot" for _ in dots]
    return Reasons(edges, found)


def _on_pairs(looked_at: Candidates, left: Mapping[int, Rule]) -> Iterator[Verdict]:
    judged, kept = looked_at.judged, count()
    for (p, q), eta, number in zip(judged.pairs.tolist(), judged.eta.tolist(), judged.rules.tolist(), strict=True):
        rule = left.get(next(kept), "straight") if number == KEPT else STRAIGHT_RULES[number]
        ends = _place(looked_at.vertices[p]), _place(looked_at.vertices[q])
        yield Verdict(*ends, None if math.isnan(eta) else eta, rule)


def _on_chains(looked_at: Candidates, left: Mapping[int, Rule]) -> Iterator[Verdict]:
    first = len(looked_at.judged.kept)
    numbers = {id(chain): first + index for index, chain in enumerate(looked_at.traced)}
    for chain, rule in zip(looked_at.chains, looked_at.rules, strict=True):
        ends = _place(looked_at.vertices[chain.start]), _place(looked_at.vertices[chain.end])
        yield Verdict(*ends, None, left.get(numbers.get(id(chain), -1), rule))


def _place(point: NDArray[np.float64]) -> tuple[float, float]:
    x, y = point.tolist()
    return round(x, 2), round(y, 2)


def as_json(graph: LineGraph, said: Reasons) -> dict[str, Any]:
    """The graph edge by edge and every candidate with its verdict, in px of the page, for `json.dumps`."""
    edges = [
        {
            "start": edge.start,
            "end": edge.end,
            "rule": rule,
            "kind": ("dot", "straight", "bent")[min(len(edge.polyline), 3) - 1],
            "length_px": round(float(np.hypot(*np.diff(edge.polyline, axis=0).T).sum()), 2),
            "plausibility": round(edge.plausibility, 4),
            "least_plausibility": round(edge.least_plausibility, 4),
        }
        for edge, rule in zip(graph.edges, said.edges, strict=True)
    ]
    candidates = [
        {
            "start_px": verdict.start_px,
            "end_px": verdict.end_px,
            "kept": verdict.kept,
            "rule": verdict.rule,
            "plausibility": verdict.plausibility if verdict.plausibility is None else round(verdict.plausibility, 4),
        }
        for verdict in said.candidates
    ]
    return {"vertices_px": graph.vertices.round(2).tolist(), "edges": edges, "candidates": candidates}
