"""The metrics of one drawing: drawn strokes against the true ones, both in px of the same picture, no shift removed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.shapes import Points
from tests.benchmarks.fidelity.known import Known
from tests.benchmarks.fidelity.nearest import nearest_px
from tests.benchmarks.fidelity.planar import planar

STEP_PX = 0.25
_INVENTED_PENS = 3
_INK_BESIDE_PX = 1.0
"""Ink so near to the redrawn ink is not visibly missing."""


@dataclass(frozen=True, slots=True)
class Measure:
    """Distances in px, shares in 0..1; chamfer_px is nan where nothing was drawn."""

    chamfer_px: float
    """Mean of the mean distances from drawn to true and from true to drawn samples."""
    precision: float
    """Share of the drawn samples within 1.5 px, or half a pen's width if that is more, of a true one."""
    recall: float
    """Share of the true samples as near to a drawn one."""
    f1: float
    iou: float
    """Soft: sum of the lesser by sum of the greater of true ink and drawn strokes inked with the same pen."""
    ink_recall: float
    """Share of the true ink that lies within 1 px of the drawn strokes' ink."""
    length_ratio: float
    """Drawn length by the length of the union of the true lines; nan where these are dots."""
    stroke_ratio: float
    """strokes by minimum."""
    strokes: int
    minimum: int
    """The fewest strokes that can draw the true lines."""
    invented_px: float
    """Drawn length farther from every true line than three pens are wide."""
    pen_up_px: float
    """Straight ways between the strokes as they follow each other, from (0, 0)."""


def measure(known: Known, drawn: Sequence[Points]) -> Measure:
    """Of the drawn strokes in px of the picture, each (N, 2), N >= 1, in drawing order."""
    true, ours = samples(known.strokes), samples(drawn)
    to_true, to_drawn = distances(ours, true), distances(true, ours)
    precision, recall = (float((each <= known.within_px).mean()) if len(each) else 0.0 for each in (to_true, to_drawn))
    fewest = planar(known.strokes)
    ink = known.ink
    redrawn = replace(known, strokes=drawn).ink
    wider = replace(known, strokes=drawn, pen_px=known.pen_px + 2 * _INK_BESIDE_PX).ink
    return Measure(
        chamfer_px=(float(to_true.mean()) + float(to_drawn.mean())) / 2 if len(ours) else math.nan,
        precision=precision,
        recall=recall,
        f1=2 * precision * recall / (precision + recall) if precision + recall else 0.0,
        iou=float(np.minimum(ink, redrawn).sum() / np.maximum(ink, redrawn).sum()),
        ink_recall=float(np.minimum(ink, wider).sum() / ink.sum()),
        length_ratio=length_px(drawn) / fewest.union_px if fewest.union_px else math.nan,
        stroke_ratio=len(drawn) / fewest.fewest_strokes,
        strokes=len(drawn),
        minimum=fewest.fewest_strokes,
        invented_px=float((to_true > _INVENTED_PENS * known.pen_px).sum()) * STEP_PX,
        pen_up_px=pen_up_px(drawn),
    )


def samples(strokes: Sequence[Points]) -> Points:
    """Points every 0.25 px along each stroke, its ends among them."""
    return np.concatenate([np.empty((0, 2)), *map(_resampled, strokes)])


def _resampled(stroke: Points) -> Points:
    lengths = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(stroke, axis=0).T))])
    at = np.linspace(0.0, lengths[-1], math.ceil(lengths[-1] / STEP_PX) + 1)
    return np.stack([np.interp(at, lengths, column) for column in stroke.T], axis=1)


def distances(points: Points, others: Points) -> NDArray[np.float64]:
    return nearest_px(points, others) if len(points) and len(others) else np.full(len(points), np.inf)


def length_px(strokes: Sequence[Points]) -> float:
    return float(sum(np.hypot(*np.diff(s, axis=0).T).sum() for s in strokes))


def pen_up_px(strokes: Sequence[Points], *, back: bool = False) -> float:
    """back: and at the end to (0, 0) again."""
    stops = [np.zeros(2), *(end for s in strokes for end in (s[0], s[-1])), np.zeros(2)]
    ways = np.diff(np.array(stops), axis=0)[::2]
    return float(np.hypot(*ways.T)[: len(ways) if back else -1].sum())


def scribbled(known: Known) -> float:
    """Share of the true line where the ink's half width exceeds 1.6 times the pen's: lines that have run together."""
    ink = known.fine
    fine = ink.shape[0] // known.side_px
    inked = np.pad((ink > 0.5).astype(np.uint8), 1)
    half_px = cv2.distanceTransform(inked, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)[1:-1, 1:-1] / fine
    at = np.rint((samples(known.strokes) + 0.5) * fine - 0.5).astype(int).clip(0, half_px.shape[0] - 1)
    return float((half_px[at[:, 1], at[:, 0]] > 1.6 * known.pen_px / 2).mean())
