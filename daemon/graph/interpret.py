"""From a page and its segmentation to the graph of its lines."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from typing import Literal, TypeAlias

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.components import components
from daemon.graph.anchors import anchored
from daemon.graph.bends import sharpened
from daemon.graph.blots import led_in
from daemon.graph.crossings import Lines, unmelted
from daemon.graph.feedback import Adaptation
from daemon.graph.hubs import hubs
from daemon.graph.joints import joined
from daemon.graph.plausibility import values_at
from daemon.graph.remains import fillings, tied
from daemon.graph.ridge import onto_ridge
from daemon.graph.skeleton import Chain, Indices, Skeleton, chain_points, chains, thinned
from daemon.graph.spurs import unspurred
from daemon.graph.straight import equations_alone, straight_edges
from daemon.graph.trace import unexplained
from daemon.graph.verdicts import Candidates, Origins, Reasons, reasons
from daemon.graph.vertices import centroids, corner_vertices
from daemon.ink import Mask, ink_mask
from daemon.shapes import Edge, Grey, LineGraph, Map, PageImage, Points, Segmentation

_SIMPLIFIED_PX = 0.04
_ROUNDING_PX = 1e-3
_LEAST_SPECK_PX = 3
_USUAL_PX = 2.5
"""Line width of a page on which nobody has estimated it: what pages are scaled to."""
_ROUNDS = 4
_BLOT_WIDTHS = 12.0

Floats32: TypeAlias = NDArray[np.float32]


@dataclass(frozen=True, slots=True, eq=False)
class _Ink:
    """The ink of a page: its lines as a mask, its dots (D, 2) in px, line width and specks, and the page's greys.

    blots: (B, 6), what is larger than a dot and no area: its middle in px, and its box as left, top, width and height.
    levels: float32 (256,), how much of a pixel of each grey level is inked, 0..1.
    fills: lines that ink the insides of what the page shows the rims of.
    """

    lines: Mask
    dots: Points
    blots: Points
    width_px: float
    specks: int
    grey: Grey
    levels: Floats32
    fills: tuple[Points, ...]

    def shades(self) -> Map:
        """How much of each pixel is inked: large, so nobody keeps it."""
        return self.levels[self.grey]


def interpret(
    page: PageImage,
    segmentation: Segmentation,
    *,
    mode: Literal["repaired", "paper"] = "repaired",
    adaptation: Adaptation | None = None,
) -> LineGraph:
    """The vertices and edges of a page.

    `paper` is Sec. 3.3 of Raghav et al. (2020) alone: corners' centroids, straight edges by Eqs. 1 to 3. `repaired`
    splits melted corners, draws each line once (see `straight_edges`), follows the ink where no straight edge explains
    it, and moves all of it onto the middle of the ink; what the network missed is found on the thinned ink, so every
    line of the page is an edge. A dot is an edge of one point from a vertex to itself. Ink of less than 3 px is dirt.

    adaptation: constants of Eqs. 2 and 3, the paper's own by default. A page without ink gives a graph without edges.
    Raises ValueError when the maps differ in shape from the page or hold values that are not finite.
    """
    if mode == "paper":
        _check(page, segmentation)
        return _by_the_paper(segmentation, _ink_of(page), adaptation or Adaptation())
    return interpret_with_reasons(page, segmentation, adaptation=adaptation)[0]


def interpret_with_reasons(
    page: PageImage, segmentation: Segmentation, *, adaptation: Adaptation | None = None
) -> tuple[LineGraph, Callable[[], Reasons]]:
    """The repaired graph of `interpret`, and what says, when it is called, why each candidate was kept or refused."""
    _check(page, segmentation)
    ink = _ink_of(page)
    graph, why = _lines(segmentation, ink, adaptation or Adaptation())
    dots = np.concatenate([ink.dots, _left_bare(ink.blots, graph, page.grey.shape)])
    return replace(_with_dots(graph, dots), specks=ink.specks), partial(why, dots)


def _check(page: PageImage, segmentation: Segmentation) -> None:
    for name in ("background", "lines", "corners"):
        channel: Map = getattr(segmentation, name)
        if channel.shape != page.grey.shape:
            raise ValueError(f"the {name} channel is {channel.shape}, the page {page.grey.shape}: segment this page")
        if not np.isfinite(channel).all():
            raise ValueError(f"the {name} channel holds values that are not finite: check the network's output")


def _ink_of(page: PageImage) -> _Ink:
    """Ink without specks, dots taken out of it."""
    mask = ink_mask(page.grey)
    pieces = components(mask)
    stats, centres = pieces.stats, pieces.centres
    areas = stats[:, cv2.CC_STAT_AREA]
    width_px = page.line_width_px or _USUAL_PX
    dirt = areas < _LEAST_SPECK_PX
    sides = stats[:, 2:4].max(axis=1)
    dots = ~dirt & (sides <= 1.5 * width_px + 1.0)
    blots = ~dirt & ~dots & (sides <= _BLOT_WIDTHS * width_px)
    dots[0] = dirt[0] = blots[0] = False
    lines = pieces.mapped(~(dots | dirt))
    lines &= mask
    middles = centres[dots]
    about = np.concatenate([centres[blots], stats[blots, :4]], axis=1)
    return _Ink(lines, middles, about, width_px, int(dirt.sum()), page.grey, _levels(page.grey, mask), page.fills)


def _levels(grey: Grey, mask: Mask) -> Floats32:
    """How much of a pixel of each grey level is inked, 0..1."""
    if not mask.any():
        return np.zeros(256, np.float32)
    paper, full = float(np.median(grey[~mask])) if not mask.all() else 255.0, float(np.percentile(grey[mask], 10))
    greys = np.arange(256, dtype=np.float32)
    return np.asarray(np.clip((paper - greys) / max(1.0, paper - full), 0.0, 1.0), np.float32)


def _by_the_paper(segmentation: Segmentation, ink: _Ink, adaptation: Adaptation) -> LineGraph:
    vertices = centroids(segmentation.corners)
    pairs, eta = equations_alone(segmentation, vertices, ink.lines, adaptation, width_px=ink.width_px)
    edges = [Edge(p, q, vertices[[p, q]], float(score)) for (p, q), score in zip(pairs.tolist(), eta, strict=True)]
    return LineGraph(vertices, tuple(edges))


def _lines(
    segmentation: Segmentation, ink: _Ink, adaptation: Adaptation
) -> tuple[LineGraph, Callable[[Points], Reasons]]:
    """The edges of all ink but the dots, and what gives the reasons once these are known."""
    width_px, shape = ink.width_px, (ink.lines.shape[0], ink.lines.shape[1])
    skeleton = thinned(ink.lines, shortest_spur_px=width_px / 2 + 1.5)
    corners = corner_vertices(segmentation.corners, ink.lines)
    nodes = anchored(skeleton, corners, shape, width_px=width_px)
    found = chains(skeleton, nodes.owners)
    judged = straight_edges(segmentation, nodes, skeleton, found, ink.lines, adaptation, width_px=width_px)
    straight = judged.kept
    traced, rules = unexplained(found, skeleton, nodes.vertices, straight, shape, width_px=width_px)
    looked_at = Candidates(nodes.vertices, judged, found, rules, traced)
    pieces, of, ends, vertices = _cut_at_tips(skeleton, traced, nodes.vertices, ink.lines)
    polylines, origins = [nodes.vertices[pair] for pair in straight] + pieces, looked_at.origins(of)
    if not polylines:
        return LineGraph(np.empty((0, 2)), ()), partial(reasons, looked_at, origins, [])
    polylines, ends, members = joined(polylines, np.concatenate([straight, ends]), vertices)
    lines, origins = _on_ridge(polylines, ends, vertices, origins.joined(members), ink)
    filled = _filled(lines, ink)
    why = partial(reasons, looked_at, origins, filled.polylines[len(lines.polylines) :])
    return _used(filled.vertices, _edges(filled, segmentation.lines + segmentation.corners)), why


def _cut_at_tips(
    skeleton: Skeleton, traced: list[Chain], vertices: Points, ink: Mask
) -> tuple[list[Points], list[int], Indices, Points]:
    """The traced lines, cut at their sharp bends: pieces, the line of each, its vertices; each tip is one more."""
    polylines: list[Points] = []
    of: list[int] = []
    ends: list[tuple[int, int]] = []
    tips: list[Points] = []
    for number, chain in enumerate(traced):
        pieces = sharpened(chain_points(skeleton, chain, vertices), ink)
        first = len(vertices) + len(tips)
        stops = [chain.start, *range(first, first + len(pieces) - 1), chain.end]
        polylines += pieces
        of += [number] * len(pieces)
        ends += pairwise(stops)
        tips += [piece[-1:] for piece in pieces[:-1]]
    return polylines, of, np.array(ends, np.intp).reshape(-1, 2), np.concatenate([vertices, *tips])


def _on_ridge(
    polylines: list[Points], ends: Indices, vertices: Points, origins: Origins, ink: _Ink
) -> tuple[Lines, Origins]:
    """The edges in the middle of the ink, without what melted ink and false corners have put between them."""
    shades = ink.shades()
    lines = onto_ridge(polylines, ends, vertices, shades, width_px=ink.width_px)
    for _ in range(_ROUNDS):
        fewer = hubs(lines, width_px=ink.width_px) or unmelted(lines, width_px=ink.width_px)
        if fewer is None:
            break
        origins = origins.without(fewer.kept, fewer.gone)
        lines = onto_ridge(fewer.polylines, fewer.ends, fewer.vertices, shades, width_px=ink.width_px)
    fewer = unspurred(lines, shades, width_px=ink.width_px)
    if fewer is None:
        return lines, origins
    polylines, ends, members = joined(fewer.polylines, fewer.ends, fewer.vertices)
    origins = origins.without(fewer.kept, fewer.gone).joined(members)
    return onto_ridge(polylines, ends, fewer.vertices, shades, width_px=ink.width_px), origins


def _filled(lines: Lines, ink: _Ink) -> Lines:
    """The edges, and more where lines have melted into an area that they do not cover, or ink the inside of a rim."""
    polylines, ends, vertices = fillings(ink.lines, lines.polylines, width_px=ink.width_px)
    ends, vertices = ends + len(lines.vertices), np.concatenate([lines.vertices, vertices])
    polylines, ends = tied(polylines, ends, lines.ends, vertices, within_px=1.5 * ink.width_px + 2.0)
    sound = [np.zeros(len(polyline), bool) for polyline in polylines]
    covered = Lines(lines.polylines + polylines, lines.sound + sound, np.concatenate([lines.ends, ends]), vertices)
    return led_in(ink.fills, covered, width_px=ink.width_px) if ink.fills else covered


def _edges(lines: Lines, response: Map) -> list[Edge]:
    """The edges with what the channels say of them."""
    lengths = np.array([len(polyline) for polyline in lines.polylines])
    firsts = np.cumsum(lengths) - lengths
    values = values_at(response, np.concatenate(lines.polylines))
    means = np.add.reduceat(values, firsts) / lengths
    leasts = np.minimum.reduceat(values, firsts)
    edges = zip(lines.ends.tolist(), lines.polylines, means.tolist(), leasts.tolist(), strict=True)
    return [Edge(p, q, _simplified(polyline), mean, least) for (p, q), polyline, mean, least in edges]


def _simplified(polyline: Points) -> Points:
    """A polyline of fewer points, at most 0.04 px from the given one (Ramer 1972; Douglas and Peucker 1973)."""
    kept = cv2.approxPolyDP(polyline.astype(np.float32).reshape(-1, 1, 2), _SIMPLIFIED_PX, False).reshape(-1, 2)
    # OpenCV leaves out the last point of a closed curve: its first one again.
    ended = len(kept) > 1 and np.abs(kept[-1] - polyline[-1]).max() < _ROUNDING_PX
    return np.concatenate([polyline[:1], kept[1 : len(kept) - ended], polyline[-1:]])


def _used(vertices: Points, edges: list[Edge]) -> LineGraph:
    """The graph without vertices that no edge ends in."""
    kept = np.zeros(len(vertices), bool)
    for edge in edges:
        kept[[edge.start, edge.end]] = True
    number = (np.cumsum(kept) - 1).tolist()
    renamed = [replace(edge, start=number[edge.start], end=number[edge.end]) for edge in edges]
    return LineGraph(vertices[kept], tuple(renamed))


def _left_bare(blots: Points, graph: LineGraph, shape: tuple[int, ...]) -> Points:
    """The middles of the blots, (D, 2), that no edge runs through: what is round has no middle line."""
    if not len(blots):
        return np.empty((0, 2))
    drawn = np.zeros(shape, bool)
    for edge in graph.edges:
        x, y = np.rint(edge.polyline).astype(np.intp).T
        drawn[y.clip(0, shape[0] - 1), x.clip(0, shape[1] - 1)] = True
    boxes = blots[:, 2:].astype(int).tolist()
    bare = [not drawn[top : top + high, left : left + wide].any() for left, top, wide, high in boxes]
    return blots[bare, :2]


def _with_dots(graph: LineGraph, dots: Points) -> LineGraph:
    first = len(graph.vertices)
    edges = [Edge(first + i, first + i, dot[None], 1.0) for i, dot in enumerate(dots)]
    return LineGraph(np.concatenate([graph.vertices, dots]), graph.edges + tuple(edges))
