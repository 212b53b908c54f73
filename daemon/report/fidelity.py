"""How well drawn lines cover the ink of a page: precision, recall, their harmonic mean, and overlap."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.ink import Mask, ink_mask, thin
from daemon.report.places import Place, places
from daemon.shapes import PageImage, Points

RECALL_WITHIN_PX = 1.5
_SAMPLED_PX, _STROKES_AT_ONCE = 50_000, 5_000
"""So much line is looked at together."""
_BESIDE = cv2.getStructuringElement(cv2.MORPH_CROSS, (3, 3))
"""One pixel beside a mask still belongs to it."""


@dataclass(frozen=True, slots=True)
class Fidelity:
    """Shares in 0..1, higher is better. Where neither ink nor line exists all are 1, where only one of them does 0."""

    precision: float
    """Share of the drawn length that lies on the page's ink, one pixel beside it allowed."""
    recall: float
    """Share of the ink's centre line within max(1.5 px, half a line width) of a drawn line."""
    f1: float
    """Harmonic mean of precision and recall."""
    iou: float
    """Intersection over union of the page's ink and the lines, drawn again at the page's line width."""
    not_drawn: tuple[Place, ...] = ()
    """Ink that no line covers, longer than two line widths; a pixel beside a line is covered."""
    not_on_ink: tuple[Place, ...] = ()
    """Drawn line where there is no ink, longer than two line widths; a pixel beside ink is on it."""


def fidelity(page: PageImage, strokes: Sequence[Points], *, line_width_px: float) -> Fidelity:
    """Compare lines with the ink of a page.

    strokes: each (N, 2) in px of this page, N >= 1; a single point is a dot and counts as one line width of line.
    line_width_px: full width of the pen line on this page, > 0. Parts off the page are lines without ink. Raises
    ValueError when the line width is not positive. Distances are from sample points, at most half a pixel apart, to
    pixel centres; the centre line is the thinned ink.
    """
    if not line_width_px > 0:
        raise ValueError(f"line width {line_width_px} px: it must be positive")
    ink = ink_mask(page.grey)
    recall = _recall(ink, strokes, max(RECALL_WITHIN_PX, line_width_px / 2))
    grown_ink = _grown(ink)
    precision = _precision(ink, grown_ink, strokes, line_width_px)
    f1 = 2 * precision * recall / (precision + recall) if precision + recall else 0.0
    drawn = within(strokes, ink.shape, line_width_px / 2)
    overlap = _overlap(ink, drawn)
    not_on_ink = places(np.greater(drawn, grown_ink, out=grown_ink), longer_than_px=2 * line_width_px)
    del grown_ink
    beside = _grown(drawn)
    del drawn
    not_drawn = places(np.greater(ink, beside, out=beside), longer_than_px=2 * line_width_px)
    return Fidelity(precision, recall, f1, overlap, not_drawn, not_on_ink)


def within(strokes: Sequence[Points], shape: tuple[int, ...], radius_px: float) -> Mask:
    """Pixels whose centre lies within a radius of a line: the line drawn `2 * radius_px` wide.

    strokes: each (N, 2) in px, N >= 1. shape: (H, W) of the bool mask returned. radius_px: > 0.
    """
    height, width = shape
    near = np.zeros((height, width), bool)
    reach = int(radius_px + 0.5)
    for points, _ in _samples(strokes, min(0.5, radius_px / 3) if radius_px < 4 else radius_px / 6):
        pixels = np.rint(points).astype(np.intp)
        off = points - pixels
        for dy in range(-reach, reach + 1):
            for dx in range(-reach, reach + 1):
                hit = (off[:, 0] - dx) ** 2 + (off[:, 1] - dy) ** 2 <= radius_px**2
                x, y = pixels[hit, 0] + dx, pixels[hit, 1] + dy
                on = (x >= 0) & (x < width) & (y >= 0) & (y < height)
                near[y[on], x[on]] = True
    return near


def _precision(ink: Mask, grown: Mask, strokes: Sequence[Points], dot_px: float) -> float:
    """grown: the ink and what lies beside it."""
    total = hit = 0.0
    for points, lengths in _samples(strokes, 0.5, dot_px=dot_px):
        x, y = np.rint(points).astype(np.intp).T
        on = (x >= 0) & (x < ink.shape[1]) & (y >= 0) & (y < ink.shape[0])
        on[on] = grown[y[on], x[on]]
        total += float(lengths.sum())
        hit += float(lengths[on].sum())
    if not total:
        return 0.0 if ink.any() else 1.0
    return hit / total


def _recall(ink: Mask, strokes: Sequence[Points], tolerance_px: float) -> float:
    centre = thin(ink)
    if not centre.any():
        return 0.0 if strokes else 1.0
    return float(within(strokes, ink.shape, tolerance_px)[centre].mean())


def _overlap(ink: Mask, drawn: Mask) -> float:
    common = np.count_nonzero(ink & drawn)
    union = np.count_nonzero(ink) + np.count_nonzero(drawn) - common
    return common / union if union else 1.0


def _grown(mask: Mask) -> Mask:
    return np.asarray(cv2.dilate(mask.view(np.uint8), _BESIDE), np.uint8).view(np.bool_)


def _samples(
    strokes: Sequence[Points], step_px: float, *, dot_px: float = 0.0
) -> Iterator[tuple[Points, NDArray[np.float64]]]:
    """Points along the strokes, at most `step_px` apart, (S, 2), and the length that each stands for, (S,).

    Some strokes at a time: the points of a whole sheet are large.
    """
    some: list[Points] = []
    length_px = 0.0
    for stroke in strokes:
        some.append(stroke)
        length_px += float(np.hypot(*np.diff(stroke, axis=0).T).sum())
        if length_px > _SAMPLED_PX or len(some) == _STROKES_AT_ONCE:
            yield _samples_of(some, step_px, dot_px)
            some, length_px = [], 0.0
    yield _samples_of(some, step_px, dot_px)


def _samples_of(strokes: Sequence[Points], step_px: float, dot_px: float) -> tuple[Points, NDArray[np.float64]]:
    segments = [np.hstack([s[:-1], s[1:]]) if len(s) > 1 else np.hstack([s, s]) for s in strokes]
    ends = np.concatenate([np.empty((0, 4)), *segments])
    lengths = np.hypot(ends[:, 2] - ends[:, 0], ends[:, 3] - ends[:, 1])
    counts = np.maximum(1, np.ceil(lengths / step_px)).astype(np.intp) + 1
    first = np.cumsum(counts) - counts
    part = (np.arange(counts.sum()) - np.repeat(first, counts)) / np.repeat(counts - 1, counts)
    start, end = np.repeat(ends[:, :2], counts, axis=0), np.repeat(ends[:, 2:], counts, axis=0)
    # The end points of a segment stand for half as much as the points between them.
    weight = np.where((part == 0) | (part == 1), 0.5, 1.0)
    dots = np.concatenate([np.zeros(0, bool), *(np.full(max(1, len(s) - 1), s.shape[0] == 1) for s in strokes)])
    share = np.where(dots, dot_px, lengths) / (counts - 1)
    return start + (end - start) * part[:, None], weight * np.repeat(share, counts)
