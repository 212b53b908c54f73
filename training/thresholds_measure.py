"""What the thresholds of Raghav et al. (2020), Sec. 5.3, do on one sketch whose lines are known.

Three ways to a graph are measured. `alone`: Eqs. 1 to 3 on all pairs of corners, as the paper has it. `paper`: the
daemon's `graph = "paper"`, which scores only pairs with ink at seven points between them. `repaired`: the default.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.graph.feedback import Adaptation, select
from daemon.graph.interpret import interpret
from daemon.graph.plausibility import mean_along, plausibilities, sampled, values_at
from daemon.graph.repairs import TRIM_PX
from daemon.graph.vertices import centroids
from daemon.ink import ink_mask
from daemon.report.fidelity import fidelity
from daemon.shapes import Map, PageImage, Segmentation
from daemon.vision.segmenter import Segmenter
from training.render import CANVAS_PX, LINE_PX, SKETCH_PX, Points, crossings, fit, reference

Indices = NDArray[np.intp]
Floats = NDArray[np.float64]
Mode = Literal["alone", "paper", "repaired"]

MODES: tuple[Mode, ...] = ("alone", "paper", "repaired")
BETAS_PX = (3.0, 5.0, 7.0)
FIXED = tuple(
    Adaptation(beta_px=beta, tau0=tau, rounds=0) for beta, tau in ((2.0, 0.3), (3.0, 0.22), (5.0, 0.2), (7.0, 0.15))
)
ROUNDS = tuple(Adaptation(rounds=rounds) for rounds in (0, 5, 10))
TAU0S = (0.15, 0.25, 0.35, 0.45, 0.55, 0.65)
RATES = (0.0, 0.02, 0.05, 0.1, 0.2)
NEIGHBOURS = 3
"""k: scores around the cut whose mean is tau-hat."""
LINE, THROUGH, OFF = range(3)
"""Kinds of pairs: joined by a line; on ink all the way, but through another vertex; the rest."""
_ASIDE_PX = 0.71
"""A crossing is rounded to the pixel: so far may its vertex lie from the line that it cuts."""
_PAIRS_AT_ONCE = 20_000


@dataclass(frozen=True, slots=True, eq=False)
class Known:
    """vertices: (V, 2) in px. lines: (L, 2) indices of those that a line joins, no vertex between. segments: drawn."""

    vertices: Points
    lines: Indices
    segments: int

    @property
    def lengths_px(self) -> Floats:
        return np.asarray(np.hypot(*(self.vertices[self.lines[:, 1]] - self.vertices[self.lines[:, 0]]).T))


def known_lines(strokes: Sequence[NDArray[np.floating]]) -> Known:
    """Vertices and lines of the reference rendering: strokes in px, rounded, cut wherever a vertex lies on them."""
    whole = [np.rint(stroke).astype(float) for stroke in strokes]
    starts, ends = np.concatenate([s[:-1] for s in whole]), np.concatenate([s[1:] for s in whole])
    moved = (starts != ends).any(axis=1)
    starts, ends = starts[moved], ends[moved]
    if not len(starts):
        return Known(np.empty((0, 2)), np.empty((0, 2), np.intp), 0)
    vertices = np.unique(np.concatenate([starts, ends, np.rint(crossings(whole))]), axis=0)
    found: set[tuple[int, int]] = set()
    for start, end in zip(starts, ends, strict=True):
        on = _on_segment(vertices, start, end)
        found.update((min(p, q), max(p, q)) for p, q in pairwise(on.tolist()))
    drawn = np.unique(np.sort(np.stack([_rows(vertices, starts), _rows(vertices, ends)], axis=1), axis=1), axis=0)
    return Known(vertices, np.array(sorted(found), np.intp).reshape(-1, 2), len(drawn))


def _on_segment(vertices: Points, start: Points, end: Points) -> Indices:
    """Indices of the vertices on a segment, in order from its start."""
    length = float(np.hypot(*(end - start)))
    unit, offset = (end - start) / length, vertices - start
    at, aside = offset @ unit, np.abs(offset @ np.array([-unit[1], unit[0]]))
    on = np.flatnonzero((aside <= _ASIDE_PX) & (at > -1e-6) & (at < length + 1e-6))
    return np.asarray(on[np.argsort(at[on], kind="stable")], np.intp)


def _rows(vertices: Points, points: Points) -> Indices:
    """The index of each point among the sorted, distinct vertices."""
    width = 2 * CANVAS_PX
    return np.searchsorted(vertices[:, 0] * width + vertices[:, 1], points[:, 0] * width + points[:, 1])


def all_pairs(count: int) -> Indices:
    return np.stack(np.triu_indices(count, 1), axis=1)


def scores(lines: Map, vertices: Points, pairs: Indices, beta_px: float) -> Floats:
    """eta of Eq. 2 of each pair, a bounded number of them at once."""
    parts = [pairs[k : k + _PAIRS_AT_ONCE] for k in range(0, len(pairs), _PAIRS_AT_ONCE)]
    found = [plausibilities(lines, vertices[p[:, 0]], vertices[p[:, 1]], width_px=beta_px) for p in parts]
    return np.concatenate([np.empty(0), *found])


def approximate_threshold(eta: Floats, lines: int) -> float:
    """tau-hat: scores in reverse, cut after as many as there are lines, mean of the k = 3 around the last kept."""
    aside = NEIGHBOURS // 2
    last = min(lines, len(eta)) - 1
    return float(np.sort(eta)[::-1][max(0, last - aside) : last + aside + 1].mean())


def kinds(known: Known, pairs: Indices, ink: NDArray[np.bool_]) -> NDArray[np.int8]:
    """LINE, THROUGH or OFF for each pair of known vertices."""
    wide = cv2.dilate(ink.astype(np.float32), np.ones((3, 3), np.uint8)).astype(np.float32)
    found = np.full(len(pairs), OFF, np.int8)
    for first in range(0, len(pairs), _PAIRS_AT_ONCE):
        p, q = pairs[first : first + _PAIRS_AT_ONCE].T
        samples = sampled(known.vertices[p], known.vertices[q])
        on_ink = mean_along(samples, values_at(wide, samples.points)) > 1 - 1e-9
        found[first : first + _PAIRS_AT_ONCE][on_ink] = THROUGH
    keys = pairs[:, 0] * len(known.vertices) + pairs[:, 1]
    found[np.isin(keys, known.lines[:, 0] * len(known.vertices) + known.lines[:, 1])] = LINE
    return found


def outranks(upper: Floats, lower: Floats) -> float | None:
    """Share of the couples of an upper and a lower score in which the upper is the greater, a tie counting half.

    The area under the ROC curve; None where there is nothing to compare.
    """
    if not len(upper) or not len(lower):
        return None
    ordered = np.sort(lower)
    below = np.searchsorted(ordered, upper, side="left") + np.searchsorted(ordered, upper, side="right")
    return float(below.mean() / 2 / len(lower))


class Sketch:
    """One sketch: its reference rendering as a page, the network's channels, its known lines, its scores."""

    def __init__(self, strokes: Sequence[NDArray[np.float32]], segmenter: Segmenter) -> None:
        grey = np.asarray(255 - reference(strokes).ink, np.uint8)
        self.known = known_lines(fit(strokes, CANVAS_PX, SKETCH_PX))
        self.page = PageImage(grey, np.eye(3), CANVAS_PX, CANVAS_PX, "", line_width_px=float(LINE_PX))
        self.maps = segmenter.segment(self.page)
        self.alone = Alone(self.page, self.maps)

    def thresholds(self) -> dict[str, Any]:
        """By beta: [tau-hat, mean eta] in three readings, and what the cut keeps of each kind of pairs."""
        pairs = all_pairs(len(self.known.vertices))
        kind = kinds(self.known, pairs, ink_mask(self.page.grey))
        lines = len(self.known.lines)
        found: dict[str, Any] = {}
        for beta in BETAS_PX:
            eta, seen = scores(self.maps.lines, self.known.vertices, pairs, beta), self.alone.eta(beta)
            tau = approximate_threshold(eta, lines)
            found[f"{beta:g}"] = {
                "known": [tau, float(eta.mean())],
                "drawn": [approximate_threshold(eta, self.known.segments), float(eta.mean())],
                "seen": [approximate_threshold(seen, lines), float(seen.mean())] if len(seen) else None,
                "pairs": np.bincount(kind, minlength=3).tolist(),
                "above": np.bincount(kind[eta > tau], minlength=3).tolist(),
                "ranked": [outranks(eta[kind == LINE], eta[kind == other]) for other in (THROUGH, OFF)],
            }
        return found

    def figures(self, mode: Mode, adaptation: Adaptation) -> list[float]:
        """Ink precision and recall in percent, edges per known line, drawn length by known length."""
        strokes = graph(self.page, self.maps, self.alone, mode, adaptation)
        found = fidelity(self.page, strokes, line_width_px=float(LINE_PX))
        length = sum(float(np.hypot(*np.diff(points, axis=0).T).sum()) for points in strokes)
        lengths = self.known.lengths_px
        return [100 * found.precision, 100 * found.recall, len(strokes) / len(lengths), length / float(lengths.sum())]


class Alone:
    """Eqs. 1 to 3 on all pairs of the corners' centroids of a page; the scores of each beta are kept."""

    def __init__(self, page: PageImage, maps: Segmentation) -> None:
        self._ink, self._lines = ink_mask(page.grey), maps.lines
        self._width_px = page.line_width_px or float(LINE_PX)
        self._vertices = centroids(maps.corners)
        self._pairs = all_pairs(len(self._vertices))
        self._eta: dict[float, Floats] = {}

    def eta(self, beta_px: float) -> Floats:
        if beta_px not in self._eta:
            self._eta[beta_px] = scores(self._lines, self._vertices, self._pairs, beta_px)
        return self._eta[beta_px]

    def strokes(self, adaptation: Adaptation) -> list[Points]:
        eta = self.eta(adaptation.beta_px)
        chosen = select(self._vertices, self._pairs, eta, self._ink, adaptation, width_px=self._width_px)
        return [self._vertices[pair] for pair in self._pairs[chosen]]


def graph(page: PageImage, maps: Segmentation, alone: Alone, mode: Mode, adaptation: Adaptation) -> list[Points]:
    """The edges of a page in one of the three ways, each (N, 2) in px."""
    if mode == "alone":
        return alone.strokes(adaptation)
    return [edge.polyline for edge in interpret(page, maps, mode=mode, adaptation=adaptation).edges]


def measure(strokes: Sequence[NDArray[np.float32]], segmenter: Segmenter, *, grid: bool) -> dict[str, Any] | None:
    """Everything that is measured on one sketch, for `json.dumps`; None where it has no line."""
    sketch = Sketch(strokes, segmenter)
    if not len(sketch.known.lines):
        return None
    modes: tuple[Mode, ...] = ("alone", "repaired")
    tried = [Adaptation(tau0=tau0, rate=rate) for tau0 in TAU0S for rate in RATES] if grid else []
    return {
        "lines": len(sketch.known.lines),
        "short": int((sketch.known.lengths_px <= 2 * TRIM_PX).sum()),
        "thresholds": sketch.thresholds(),
        "settings": [{mode: sketch.figures(mode, a) for mode in MODES} for a in (*FIXED, *ROUNDS)],
        "grid": [{mode: sketch.figures(mode, a) for mode in modes} for a in tried],
    }
