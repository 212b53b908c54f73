"""A traced line gets back the tips of its sharp bends, which thinning has rounded off."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from daemon.graph.plausibility import Floats
from daemon.ink import Mask
from daemon.shapes import Points

_SPAN = 5
"""Steps of the centre line before and after a point between which its turn is measured."""
_SHARP_DEGREES = 60.0
_LEG = slice(4, 11)
"""Steps away from a bend that show where the straight parts before and after it lie."""
_FARTHEST_PX = 8.0
_SHARES = np.array([[1.0], [0.75], [0.5], [0.25]])


def sharpened(polyline: Points, ink: Mask) -> list[Points]:
    """The polyline led through the tips of its sharp bends, and cut there: what follows would round them off again.

    polyline: (N, 2) in px, pixel by pixel. ink: bool (H, W). A tip is where the straight parts before and after a bend
    meet, at most 8 px from the bend, or as far towards that as there is ink. Each piece begins where the one before it
    ends.
    """
    pieces, begun, done = [], polyline[:0], 0
    for at in _bends(polyline):
        tip = _meeting(polyline[at - _LEG.stop : at - _LEG.start], polyline[at + _LEG.start : at + _LEG.stop])
        if np.hypot(*(tip - polyline[at])) > _FARTHEST_PX:
            continue
        inked = [place for place in polyline[at] + _SHARES * (tip - polyline[at]) if _is_inked(place, ink)]
        if inked:
            pieces.append(np.concatenate([begun, polyline[done : at - _SPAN + 1], inked[:1]]))
            begun, done = inked[0][None], at + _SPAN
    return [*pieces, np.concatenate([begun, polyline[done:]])]


def _bends(polyline: Points) -> list[int]:
    """Where the line turns by more than 60 degrees within ten steps, at the sharpest point, away from the ends."""
    if len(polyline) < 2 * _LEG.stop + 1:
        return []
    turns = _turns(polyline)
    turns[: _LEG.stop] = turns[len(turns) - _LEG.stop :] = 0.0
    found: list[int] = []
    for at in np.argsort(-turns, kind="stable")[: int((turns >= _SHARP_DEGREES).sum())].tolist():
        if all(abs(at - other) > _LEG.stop for other in found):
            found.append(at)
    return sorted(found)


def _turns(polyline: Points) -> Floats:
    """The turn at each point in degrees, 0 next to the ends."""
    before = polyline[_SPAN:-_SPAN] - polyline[: -2 * _SPAN]
    after = polyline[2 * _SPAN :] - polyline[_SPAN:-_SPAN]
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    turns = np.zeros(len(polyline))
    turns[_SPAN:-_SPAN] = np.degrees(np.abs(np.arctan2(cross, (before * after).sum(axis=1))))
    return turns


def _meeting(before: Points, after: Points) -> NDArray[np.float64]:
    """Where the lines through two stretches meet; far away when they are parallel."""
    (p, u), (q, v) = _line(before), _line(after)
    cross = u[0] * v[1] - u[1] * v[0]
    if abs(cross) < 0.05:
        return np.full(2, np.inf)
    share = ((q - p)[0] * v[1] - (q - p)[1] * v[0]) / cross
    return np.asarray(p + share * u)


def _line(points: Points) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The middle of a stretch and its direction."""
    middle = points.mean(axis=0)
    return middle, np.linalg.svd(points - middle)[2][0]


def _is_inked(point: NDArray[np.float64], ink: Mask) -> bool:
    x, y = (round(float(value)) for value in point)
    return 0 <= y < ink.shape[0] and 0 <= x < ink.shape[1] and bool(ink[y, x])
