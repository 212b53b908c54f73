"""Nothing is drawn where the machine cannot go."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from daemon.errors import OutOfReach
from daemon.shapes import Points, Stroke

_ROUNDING_MM = 1e-6


def check_reach(
    strokes: Sequence[Stroke],
    *,
    reach_mm: tuple[float, float],
    reach_low_mm: tuple[float, float],
    park_mm: tuple[float, float],
) -> None:
    """Raises OutOfReach, naming the first stroke and point (or the park position) that the machine cannot reach.

    strokes: points in machine mm. reach_mm: width and height; reach_low_mm: the smallest x and y the machine goes to.
    Straight moves between points of a rectangle stay inside it, so points are all that need checking.
    """
    for index, stroke in enumerate(strokes):
        outside = _outside(stroke.points, reach_mm, reach_low_mm)
        if outside is not None:
            x_mm, y_mm = stroke.points[outside]
            raise OutOfReach(_sentence(f"stroke {index}, point {outside}", x_mm, y_mm, reach_mm, reach_low_mm))
    if _outside(np.array([park_mm], float), reach_mm, reach_low_mm) is not None:
        raise OutOfReach(_sentence("the park position", *park_mm, reach_mm, reach_low_mm))


def _outside(points: Points, reach_mm: tuple[float, float], low_mm: tuple[float, float]) -> int | None:
    low = np.asarray(low_mm) - _ROUNDING_MM
    high = np.asarray(low_mm) + reach_mm + _ROUNDING_MM
    inside = ((points >= low) & (points <= high)).all(axis=1)
    return None if inside.all() else int(np.argmin(inside))


def _sentence(what: str, x_mm: float, y_mm: float, reach_mm: tuple[float, float], low_mm: tuple[float, float]) -> str:
    high_mm = (low_mm[0] + reach_mm[0], low_mm[1] + reach_mm[1])
    return (
        f"{what} lies at ({x_mm:.1f}, {y_mm:.1f}) mm, the machine reaches x {low_mm[0]:g} to {high_mm[0]:g} "
        f"and y {low_mm[1]:g} to {high_mm[1]:g} mm: make the box smaller (with size = 'fit'), move the origin, or "
        "correct reach_mm"
    )
