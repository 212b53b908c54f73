"""Which pairs of vertices a straight line joins: Eq. 2, feedback and the repairs, on pairs that the ink connects."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from daemon.graph.anchors import Anchored, Nearest, nearest
from daemon.graph.feedback import Adaptation, select
from daemon.graph.plausibility import Floats, pairs_on_ink, plausibilities
from daemon.graph.repairs import NEAR_PX, TRIM_PX, clear_of_corners, filled, redundant, suppressed, without_gap
from daemon.graph.skeleton import Chain, Indices, Skeleton
from daemon.graph.verdicts import BEND, FILL, GAP, KEPT, PLAUSIBILITY, PRUNE, SUPPRESSION, THRESHOLD, Judged
from daemon.ink import Mask
from daemon.shapes import Points, Segmentation

_HOPS = 3
_NEIGHBOURS = 100
_BEND_PX = 1.2
"""A chain that leaves its chord by more than this is a curve."""


def equations_alone(
    segmentation: Segmentation, vertices: Points, ink: Mask, adaptation: Adaptation, *, width_px: float
) -> tuple[Indices, Floats]:
    """The edges of Eqs. 1 to 3 with no repair: pairs (E, 2) of vertices and their eta (E,) (Raghav et al. 2020, 3.3).

    Draws most lines two or three times: an edge that passes through a vertex is as plausible as its two halves.
    """
    pairs = pairs_on_ink(vertices, ink)
    eta = plausibilities(segmentation.lines, *_ends(vertices, pairs), width_px=adaptation.beta_px)
    chosen = select(vertices, pairs, eta, ink, adaptation, width_px=width_px)
    return pairs[chosen], eta[chosen]


def straight_edges(
    segmentation: Segmentation,
    anchored: Anchored,
    skeleton: Skeleton,
    chains: list[Chain],
    ink: Mask,
    adaptation: Adaptation,
    *,
    width_px: float,
) -> Judged:
    """Pairs of vertices that a straight line may join, judged: each line of the page is kept once.

    Candidates are pairs at most three chains apart and pairs near each other on the page, about a hundred a vertex, so
    their number grows with the vertices, not with their square.
    A pair is refused where its eta is below its threshold (Eqs. 2 and 3; both discs trimmed off, corners on the way
    counted as line), where ink is missing along it, where it passes by a corner, where its own chain bends, and where
    other edges cover it.
    """
    vertices = anchored.vertices[: anchored.corners]
    near = nearest(vertices, (ink.shape[0], ink.shape[1]), within_px=NEAR_PX)
    pairs, bends = _candidates(anchored, skeleton, chains, ink, near)
    rules = _by_ink(vertices, pairs, bends, ink, width_px)
    eta = np.full(len(pairs), np.nan)
    looked_at = (rules == KEPT) | (bends >= 0)
    ends = _ends(vertices, pairs[looked_at])
    eta[looked_at] = plausibilities(
        segmentation.lines + segmentation.corners, *ends, width_px=adaptation.beta_px, trim_px=TRIM_PX
    )
    rules[(rules == KEPT) & ~(eta > adaptation.tau0 * (1 - adaptation.rate) ** adaptation.rounds)] = PLAUSIBILITY
    left = np.flatnonzero(rules == KEPT)
    known = pairs[looked_at & ((eta > adaptation.tau0) | (bends >= 0))]
    rules[left[suppressed(vertices, pairs[left], known, near)]] = SUPPRESSION
    del near
    left = np.flatnonzero(rules == KEPT)
    rules[left[~select(vertices, pairs[left], eta[left], ink, adaptation, width_px=width_px)]] = THRESHOLD
    left = np.flatnonzero(rules == KEPT)
    unbacked = np.flatnonzero(bends[left] < 0)
    order = unbacked[np.argsort(eta[left[unbacked]], kind="stable")]
    rules[left[redundant(ink.shape, *_ends(vertices, pairs[left]), order)]] = PRUNE
    return Judged(pairs, eta, rules)


def _by_ink(vertices: Points, pairs: Indices, bends: Floats, ink: Mask, width_px: float) -> NDArray[np.int8]:
    """Which pairs have the ink of a line between them; a full line's width of it where no chain joins the two."""
    rules = np.where(bends <= _BEND_PX, KEPT, BEND).astype(np.int8)
    left = np.flatnonzero(rules == KEPT)
    rules[left[~without_gap(ink, *_ends(vertices, pairs[left]))]] = GAP
    alone = np.flatnonzero((rules == KEPT) & (bends < 0))
    rules[alone[~filled(ink, *_ends(vertices, pairs[alone]), width_px=width_px)]] = FILL
    return rules


def bends_px(skeleton: Skeleton, chains: list[Chain], vertices: Points) -> Floats:
    """How far each chain leaves the straight line between its vertices, in px; a loop leaves it without bound."""
    ends = np.array([(chain.start, chain.end) for chain in chains], np.intp).reshape(-1, 2)
    lengths = np.array([len(chain.path) for chain in chains], np.intp)
    bends = np.where(ends[:, 0] == ends[:, 1], np.inf, 0.0)
    long = np.flatnonzero((lengths > 0) & (bends == 0))
    if not long.size:
        return bends
    pixels = skeleton.pixels[np.concatenate([chains[index].path for index in long])]
    of = np.repeat(long, lengths[long])
    p, q = vertices[ends[of, 0]], vertices[ends[of, 1]]
    (x, y), (across, down) = (pixels - p).T, (q - p).T
    away = np.abs(x * down - y * across) / np.maximum(np.hypot(across, down), 1e-9)
    bends[long] = np.maximum.reduceat(away, np.cumsum(lengths[long]) - lengths[long])
    return bends


def _candidates(
    anchored: Anchored, skeleton: Skeleton, chains: list[Chain], ink: Mask, near: Nearest
) -> tuple[Indices, Floats]:
    """Pairs of corners (P, 2), lower first, that few chains join, and the least bend of a chain that joins them.

    The bend is -1 where no chain joins the two.
    """
    bends: dict[tuple[int, int], float] = {}
    neighbours: list[set[int]] = [set() for _ in anchored.vertices]
    for chain, bend in zip(chains, bends_px(skeleton, chains, anchored.vertices).tolist(), strict=True):
        if chain.start != chain.end:
            pair = (min(chain.start, chain.end), max(chain.start, chain.end))
            bends[pair] = min(bends.get(pair, np.inf), bend)
            neighbours[chain.start].add(chain.end)
            neighbours[chain.end].add(chain.start)
    corners = anchored.corners
    linked = [(p, q) for p in range(corners) for q in _within(p, neighbours) if p < q < corners]
    near_by = pairs_on_ink(anchored.vertices[:corners], ink, within_px=_reach_px(corners, ink))
    near_by = near_by[clear_of_corners(anchored.vertices, near_by, near)]
    pairs = np.unique(np.concatenate([np.array(linked, np.intp).reshape(-1, 2), near_by]), axis=0)
    return pairs, np.array([bends.get((p, q), -1.0) for p, q in pairs.tolist()])


def _reach_px(corners: int, ink: Mask) -> float:
    """A distance within which a corner has about a hundred others, were they spread evenly over the page."""
    return float(np.sqrt(_NEIGHBOURS * ink.size / (np.pi * max(1, corners))))


def _within(vertex: int, neighbours: list[set[int]]) -> list[int]:
    """The vertices at most three chains away, in order."""
    reached = front = {vertex}
    for _ in range(_HOPS):
        front = set().union(*(neighbours[v] for v in front)) - reached
        reached = reached | front
    return sorted(reached)


def _ends(vertices: Points, pairs: Indices) -> tuple[Points, Points]:
    return vertices[pairs[:, 0]], vertices[pairs[:, 1]]
