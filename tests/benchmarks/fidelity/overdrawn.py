"""Overdrawn lines, 512 px: each stroke two or three times over itself, as a sketching hand does."""

from __future__ import annotations

from itertools import islice

import numpy as np

from daemon.shapes import Points
from tests.benchmarks.fidelity.known import Known, averaged, fine_ink
from tests.benchmarks.fidelity.subjects import subjects
from tests.drawings.hand import by_hand

SIDE_PX = 512
PEN_PX = 4.0
_SUBJECTS = 20
_TIMES = (2, 3)
_TOUCHING, _APART = 0.45, 0.9
"""Of the pen's width: so far a pass lies aside at most. With the first passes touch, with the second paper shows."""


def overdrawn() -> list[Known]:
    """Twenty, their passes touching. See `_set`."""
    return _set(_TOUCHING)


def apart() -> list[Known]:
    """The same twenty with paper between the passes. See `_set`."""
    return _set(_APART)


def _set(wobble: float) -> list[Known]:
    """Twenty subjects, twice and three times in turn; wobble in widths of the pen.

    A pen of 4 px; the true line is the mean of its passes, and ends and corners wobble as the rest does.
    """
    return [
        _known(name, strokes, random, _TIMES[number % len(_TIMES)], wobble)
        for number, (name, strokes, random) in enumerate(islice(subjects(), _SUBJECTS))
    ]


def _known(name: str, subject: list[Points], random: np.random.Generator, times: int, wobble: float) -> Known:
    strokes = [points * SIDE_PX / 100 - 0.5 for points in subject]
    passes = [each for points in strokes for each in _passes(points, random, times, wobble * PEN_PX)]
    ink = averaged(fine_ink(passes, SIDE_PX, PEN_PX), finer=4)
    given = np.asarray(np.rint(255 * (1 - ink)), np.uint8)
    return Known(f"{name}, {times} x, {wobble:g}", strokes, SIDE_PX, pen_px=PEN_PX, given=given)


def _passes(points: Points, random: np.random.Generator, times: int, most_px: float) -> list[Points]:
    """The stroke so many times, nowhere farther aside than that, on the mean nowhere aside."""
    if len(points) == 1:
        return [points] * times
    straight = by_hand(points, np.random.default_rng(0), wobble_px=0.0)
    aside = np.stack([by_hand(points, random, wobble_px=most_px) - straight for _ in range(times)])
    aside -= aside.mean(axis=0)
    farthest_px = float(np.hypot(aside[:, :, 0], aside[:, :, 1]).max(initial=0.0))
    return list(straight + aside * most_px / max(farthest_px, 1e-9))
