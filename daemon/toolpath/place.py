"""From pixels of the drawing to millimetres of the machine."""

from __future__ import annotations

import numpy as np

from daemon.shapes import Affine, Points


def placement(
    width_px: int, height_px: int, *, box_mm: tuple[float, float], box_origin_mm: tuple[float, float]
) -> Affine:
    """The map that fits a picture into a box: its proportions kept, centred, y turned up.

    width_px, height_px: size of the picture; its outer edges, half a pixel outside the outer pixels' centres, touch
    the box. box_mm: width and height; box_origin_mm: the box's lower left corner in machine mm. Returns (2, 3) float64.
    Raises ValueError when a size is not positive.
    """
    if min(width_px, height_px) <= 0 or min(box_mm) <= 0:
        raise ValueError(f"a picture of {width_px} x {height_px} px does not fit a box of {box_mm} mm: give sizes > 0")
    mm_per_px = min(box_mm[0] / width_px, box_mm[1] / height_px)
    left_mm = box_origin_mm[0] + (box_mm[0] - width_px * mm_per_px) / 2
    top_mm = box_origin_mm[1] + (box_mm[1] + height_px * mm_per_px) / 2
    half_px_mm = mm_per_px / 2
    return np.array([[mm_per_px, 0.0, left_mm + half_px_mm], [0.0, -mm_per_px, top_mm - half_px_mm]])


def place(points: Points, from_px: Affine) -> Points:
    """points: (N, 2) in px; from_px: (2, 3). Returns (N, 2) in mm."""
    placed: Points = points @ from_px[:, :2].T + from_px[:, 2]
    return placed


def invert(from_px: Affine) -> Affine:
    """The way back: from mm to px. (2, 3) to (2, 3)."""
    back = np.linalg.inv(from_px[:, :2])
    return np.column_stack([back, -back @ from_px[:, 2]])
