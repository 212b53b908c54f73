"""Points taken through a homography."""

from __future__ import annotations

import numpy as np

from daemon.shapes import Homography, Points


def through(transform: Homography, points: Points) -> Points:
    """points: (..., 2), (x, y). Returns where the transform leads them, of the same shape; equal points stay equal."""
    x, y = points[..., 0], points[..., 1]
    u, v, w = (row[0] * x + row[1] * y + row[2] for row in transform)
    return np.stack([u / w, v / w], axis=-1)
