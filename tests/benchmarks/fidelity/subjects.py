"""Forty drawings of known strokes for the sets of real paper: twenty subjects, each as it is and once by hand."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from daemon.shapes import Points
from tests.benchmarks.fidelity import curves, technical
from tests.drawings import scenes, signs
from tests.drawings.hand import by_hand

_SUBJECTS: dict[str, Callable[[], list[Points]]] = {
    **curves.SUBJECTS,
    "cat": scenes.cat,
    "fish": scenes.fish,
    "flower": scenes.flower,
    "script": signs.script,
    "plan": signs.plan,
    "dashes": signs.dashes,
    "mesh": technical.mesh,
}
_WOBBLE = 0.3
"""Of the hundred that a subject spans."""


def subjects() -> Iterator[tuple[str, list[Points], np.random.Generator]]:
    """Name, strokes over 0..100, and a generator of the drawing's own. The second twenty are mirrored."""
    for number, (name, subject) in enumerate(_SUBJECTS.items()):
        yield name, subject(), np.random.default_rng([9, number])
    for number, (name, subject) in enumerate(_SUBJECTS.items(), start=len(_SUBJECTS)):
        random = np.random.default_rng([9, number])
        mirrored = [points * [-1, 1] + [100, 0] for points in subject()]
        yield f"{name} by hand", [_by_hand(points, random) for points in mirrored], random


def _by_hand(points: Points, random: np.random.Generator) -> Points:
    return by_hand(points, random, wobble_px=_WOBBLE) if len(points) > 1 else points
