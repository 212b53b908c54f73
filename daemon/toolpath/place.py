"""From pixels of the drawing to millimetres of the machine."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from daemon.errors import SettingsError
from daemon.shapes import Affine, Points

Turn: TypeAlias = Literal[0, 90, 180, 270]
_QUARTERS = {0: (1, 0), 90: (0, -1), 180: (-1, 0), 270: (0, 1)}
"""Cosine and sine of a turn in degrees clockwise, y up."""


@dataclass(frozen=True, slots=True)
class Layout:
    """How a picture lies in its box: mirrored, then turned, then made as large as the box less its margin, or true.

    box_mm: width and height; box_origin_mm: the lower left corner in machine mm. mirror: left and right exchanged.
    rotate: degrees clockwise. margin_mm: left free inside the box, all round. true_size: as large as the picture's own
    resolution says, whatever the box.
    """

    box_mm: tuple[float, float] = (64.0, 64.0)
    box_origin_mm: tuple[float, float] = (25.0, 25.0)
    margin_mm: float = 0.0
    rotate: Turn = 0
    mirror: bool = False
    true_size: bool = False


def placement(width_px: int, height_px: int, layout: Layout, *, px_per_mm: float | None = None) -> Affine:
    """The map that puts a picture into the middle of a box: its proportions kept, y turned up.

    width_px, height_px: size of the picture; fitted, its outer edges, half a pixel outside the outer pixels' centres,
    touch the box less its margin. px_per_mm: the picture's resolution, where it states one. Returns (2, 3) float64.
    Raises ValueError when a size is not positive, SettingsError when true size is asked for and no resolution stated.
    """
    room_mm = (layout.box_mm[0] - 2 * layout.margin_mm, layout.box_mm[1] - 2 * layout.margin_mm)
    if min(width_px, height_px) <= 0 or min(room_mm) <= 0:
        raise ValueError(f"a picture of {width_px} x {height_px} px does not fit a box of {room_mm} mm: give sizes > 0")
    cosine, sine = _QUARTERS[layout.rotate]
    turned_px = (height_px, width_px) if sine else (width_px, height_px)
    fitted = min(room_mm[0] / turned_px[0], room_mm[1] / turned_px[1])
    mm_per_px = 1 / _stated(px_per_mm) if layout.true_size else fitted
    side = -1.0 if layout.mirror else 1.0
    linear = mm_per_px * np.array([[cosine * side, sine], [sine * side, -cosine]])
    middle_px = np.array([(width_px - 1) / 2, (height_px - 1) / 2])
    middle_mm = np.asarray(layout.box_origin_mm, float) + np.asarray(layout.box_mm, float) / 2
    return np.column_stack([linear, middle_mm - linear @ middle_px])


def _stated(px_per_mm: float | None) -> float:
    if px_per_mm is None:
        raise SettingsError(
            "[sheet] size = 'true', but the picture states no resolution: save it with one (dpi), or set size = 'fit'"
        )
    return px_per_mm


def place(points: Points, from_px: Affine) -> Points:
    """points: (N, 2) in px; from_px: (2, 3). Returns (N, 2) in mm; equal points stay equal to the last bit."""
    x, y = points.T
    return np.stack([row[0] * x + row[1] * y + row[2] for row in from_px], axis=1)


def invert(from_px: Affine) -> Affine:
    """The way back: from mm to px. (2, 3) to (2, 3)."""
    back = np.linalg.inv(from_px[:, :2])
    return np.column_stack([back, -back @ from_px[:, 2]])
