"""Pages to measure on: one sketch of 256 px, repeated until it fills 512 or 1024 px, so that work grows with area."""

from __future__ import annotations

import cv2
import numpy as np

from daemon.shapes import Grey, Points

SIDES_PX = (256, 512, 1024)
_SKETCH_PX = 256
_FINE = 8


def sketch() -> list[Points]:
    """A house, a sun, a path and a hatched hill: straight lines, corners, crossings and curves, in px of 256 x 256."""
    turn = np.linspace(0.0, 2 * np.pi, 40)
    along = np.linspace(0.0, 1.0, 40)
    house = [[50, 200], [50, 110], [100, 60], [150, 110], [150, 200], [50, 200]]
    strokes = [np.array(house, float), np.array([[50, 110], [150, 110]], float)]
    strokes.append(np.array([[85, 200], [85, 150], [115, 150], [115, 200]], float))
    strokes.append(np.stack([205 + 22 * np.cos(turn), 50 + 22 * np.sin(turn)], axis=1))
    strokes.append(np.stack([20 + 216 * along, 222 + 10 * np.sin(9 * along)], axis=1))
    strokes += [np.array([[165 + 9 * i, 205], [190 + 9 * i, 150]], float) for i in range(5)]
    strokes += [np.array([[170, 165 + 14 * i], [232, 165 + 14 * i]], float) for i in range(3)]
    return strokes


def page(side_px: int, *, line_width_px: float = 2.5) -> Grey:
    """A page of side_px x side_px px, uint8, dark lines of that width on white, smooth at their edges."""
    fine = np.full((_SKETCH_PX * _FINE, _SKETCH_PX * _FINE), 255, np.uint8)
    for stroke in sketch():
        points = np.rint((stroke + 0.5) * _FINE - 0.5).astype(np.int32)
        cv2.polylines(fine, [points], False, 0, round(line_width_px * _FINE) - 1)
    one = cv2.resize(fine, (_SKETCH_PX, _SKETCH_PX), interpolation=cv2.INTER_AREA).astype(np.uint8)
    return np.tile(one, (side_px // _SKETCH_PX, side_px // _SKETCH_PX))
