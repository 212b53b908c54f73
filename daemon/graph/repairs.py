"""The rules that keep Eqs. 1 to 3 from drawing a line that is not there, or one line twice."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from daemon.graph.anchors import Nearest
from daemon.graph.plausibility import Floats, in_parts, mean_along, sampled, values_at
from daemon.graph.skeleton import Indices
from daemon.ink import Mask
from daemon.shapes import Points

TRIM_PX = 2.5
"""Corners are discs of this radius: so much of an edge at either end lies in the corners channel, not in the lines'."""
_GAP_PX = 2.0
_GAP_SHARE = 0.06
_EDGE_PX = 0.6
_TWICE_SHARE = 0.8
_THROUGH_PX, NEAR_PX = 1.5, 3.0
_LOOKS = np.arange(1, 24) / 24


def without_gap(ink: Mask, starts: Points, ends: Points) -> NDArray[np.bool_]:
    """Which segments have ink under them: at most max(2 px, 6 %) of the length may be bare (rule *gap*).

    ink: bool (H, W). starts, ends: (P, 2) in px. Half a pixel to the side still counts as under it.
    """

    def bridged(starts: Points, ends: Points) -> NDArray[np.bool_]:
        return _little(1.0 - _strip(ink, starts, ends, 0.5).max(axis=0), starts, ends)

    return in_parts(bridged, starts, ends, np.bool_)


def filled(ink: Mask, starts: Points, ends: Points, *, width_px: float) -> NDArray[np.bool_]:
    """Which segments lie in the middle of a line's width of ink: the rule *gap* for the strip's edges too.

    width_px: of the line; its outer half pixel on either side is grey and does not count.
    """
    aside_px = max(0.0, width_px / 2 - _EDGE_PX)

    def full(starts: Points, ends: Points) -> NDArray[np.bool_]:
        return _little(1.0 - _strip(ink, starts, ends, aside_px).min(axis=0), starts, ends)

    return in_parts(full, starts, ends, np.bool_)


def _strip(ink: Mask, starts: Points, ends: Points, aside_px: float) -> Floats:
    """Whether there is ink at each sample of each segment, left of it, on it and right of it: (3, S) of 0 and 1."""
    samples = sampled(starts, ends)
    aside = aside_px * samples.normals[samples.segment]
    return np.stack([values_at(ink, samples.points + side * aside) for side in (-1.0, 0.0, 1.0)])


def _little(bare: Floats, starts: Points, ends: Points) -> NDArray[np.bool_]:
    lengths = np.hypot(*(ends - starts).T)
    return np.asarray(
        mean_along(sampled(starts, ends), bare) * (lengths + 1) <= np.maximum(_GAP_PX, _GAP_SHARE * lengths)
    )


def suppressed(corners: Points, pairs: Indices, known: Indices, near: Nearest) -> NDArray[np.bool_]:
    """Which pairs pass by a corner that they should end in (rule *suppression*).

    p-r is refused when a corner q lies within 1.5 px of the segment, or within 3 px and p-q and q-r are known to be
    joined: every crossing is a corner, so no true edge passes through one. corners: (C, 2) in px; pairs, known: (P, 2)
    and (K, 2) indices of corners, lower first; near: the nearest corner of each pixel.
    """
    samples = sampled(corners[pairs[:, 0]], corners[pairs[:, 1]], trim_px=0.0)
    x, y = np.rint(samples.points).astype(np.intp).T
    vertex, away_px = near.at(y, x)
    between = vertex.astype(np.intp)
    p, r = pairs[samples.segment].T
    hit = (away_px <= NEAR_PX) & (between != p) & (between != r)
    p, q, r, segment = p[hit], between[hit], r[hit], samples.segment[hit]
    ahead = _is_between(corners, p, q, r)
    keys = np.sort(known[:, 0] * len(corners) + known[:, 1])
    through = away_px[hit] <= _THROUGH_PX
    joined = (through | (_known(p, q, keys, corners) & _known(q, r, keys, corners))) & ahead
    refused = np.zeros(len(pairs), bool)
    refused[segment[joined]] = True
    return refused


def clear_of_corners(corners: Points, pairs: Indices, near: Nearest) -> NDArray[np.bool_]:
    """Which pairs do not pass by a corner at one of a few points between them: a quick look ahead of `suppressed`.

    What it refuses `suppressed` would refuse; it bounds the work in a scribble whose corners and lines have melted.
    """
    clear = np.ones(len(pairs), bool)
    start, along = corners[pairs[:, 0]], corners[pairs[:, 1]] - corners[pairs[:, 0]]
    lengths = np.hypot(*along.T)
    for share in _LOOKS:
        left = np.flatnonzero(clear & (lengths * min(share, 1 - share) > 1.0 + _THROUGH_PX))
        x, y = np.rint(start[left] + share * along[left]).astype(np.intp).T
        between, away_px = near.at(y, x)
        beside = (away_px <= _THROUGH_PX) & (between[:, None] != pairs[left]).all(axis=1)
        clear[left[beside]] = False
    return clear


def redundant(shape: tuple[int, ...], starts: Points, ends: Points, order: Indices) -> NDArray[np.bool_]:
    """Which segments the others cover anyway (rule *prune*): looked at in `order`, dropped when 80 % lies under them.

    shape: of the page. starts, ends: (P, 2) in px. order: indices of the segments that may be dropped, least trusted
    first. A segment covers the pixels within about one of it.
    """
    dropped = np.zeros(len(starts), bool)
    if not order.size:
        return dropped
    samples, area = sampled(starts, ends), int(np.prod(shape))
    beside = samples.normals[samples.segment]
    left, centre, right = (_flat(samples.points + side * beside, shape) for side in (-1.0, 0.0, 1.0))
    segment, pixels = np.divmod(np.unique(samples.segment * area + np.stack([left, centre, right])), area)
    bounds = np.searchsorted(segment, np.arange(len(starts) + 1))
    last = np.append(samples.first[1:], len(centre))
    covered, pixels, cover = np.unique(pixels, return_inverse=True, return_counts=True)
    pixels, centre = pixels.reshape(-1), np.searchsorted(covered, centre)
    for index in order.tolist():
        if (cover[centre[samples.first[index] : last[index]]] >= 2).mean() >= _TWICE_SHARE:
            dropped[index] = True
            cover[pixels[bounds[index] : bounds[index + 1]]] -= 1
    return dropped


def _flat(points: Points, shape: tuple[int, ...]) -> Indices:
    """The index of the pixel at each point in a flattened page; points outside it count as on its border."""
    x, y = np.clip(np.rint(points).astype(np.intp), 0, [shape[1] - 1, shape[0] - 1]).T
    return np.asarray(y * shape[1] + x, np.intp)


def _is_between(corners: Points, p: Indices, q: Indices, r: Indices) -> NDArray[np.bool_]:
    """Whether q's foot lies inside the segment p-r, more than a pixel from either end."""
    along = corners[r] - corners[p]
    length = np.maximum(np.hypot(*along.T), 1e-9)
    foot_px = ((corners[q] - corners[p]) * along).sum(axis=1) / length
    return np.asarray((foot_px > 1.0) & (foot_px < length - 1.0))


def _known(a: Indices, b: Indices, known: Indices, corners: Points) -> NDArray[np.bool_]:
    """Whether a-b is among the known pairs, or too short to have a lines channel between its two discs."""
    close = np.hypot(*(corners[a] - corners[b]).T) <= 2 * TRIM_PX
    keys = np.minimum(a, b) * len(corners) + np.maximum(a, b)
    at = np.minimum(np.searchsorted(known, keys), max(0, len(known) - 1))
    return np.asarray(close | (known[at] == keys)) if len(known) else close
