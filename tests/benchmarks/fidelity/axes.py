"""F1 over line width, ink contrast, rotation and size: `python -m tests.benchmarks.fidelity.axes [docs/axes.png]`."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import cv2
import numpy as np

from daemon.report import canvas
from daemon.report.canvas import Picture
from daemon.shapes import Points
from tests.benchmarks.fidelity.curves import SUBJECTS
from tests.benchmarks.fidelity.known import PEN_PX, Known
from tests.benchmarks.fidelity.measure import measure
from tests.benchmarks.fidelity.ours import understood
from tests.benchmarks.fidelity.wear import Camera, Paper, inked, sheet_of, taken

BAR = 0.97
_NAMES = ("house", "face", "splines", "gear 8", "star", "car")
_SIDE_PX = 256
_TALL_PX, _WIDE_PX, _MARGIN_PX = 260, 420, 56


def by_width(name: str, width_px: float) -> Known:
    """A pen of that width; the picture grows with it from 256 px on."""
    return _clean(name, max(_SIDE_PX, round(64 * width_px)), width_px)


def by_contrast(name: str, percent: float) -> Known:
    """Ink that takes so much of the light, on grey paper with grain of two levels."""
    random, known = np.random.default_rng(round(percent)), _clean(name, _SIDE_PX, PEN_PX)
    shape = (_SIDE_PX, _SIDE_PX)
    page = sheet_of(shape, Paper(0.92), random) * (1 - percent / 100 * inked(list(known.strokes), shape, PEN_PX))
    given = taken(np.asarray(page, np.float32), Camera(0.5, 2.0, None), random)
    return Known(name, known.strokes, _SIDE_PX, given=given)


def by_rotation(name: str, degrees: float) -> Known:
    """Turned about the middle of a picture of 384 px."""
    side_px, angle = 384, np.radians(degrees)
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    middle = (side_px - 1) / 2
    strokes = [(points - 50) * _SIDE_PX / 100 @ turn + middle for points in SUBJECTS[name]()]
    return Known(name, strokes, side_px)


def by_size(name: str, side_px: float) -> Known:
    """A picture of that side; the pen's line grows more slowly than the picture."""
    return _clean(name, round(side_px), PEN_PX * (side_px / _SIDE_PX) ** 0.75)


def _clean(name: str, side_px: int, pen_px: float) -> Known:
    strokes: Sequence[Points] = [points * side_px / 100 - 0.5 for points in SUBJECTS[name]()]
    return Known(name, strokes, side_px, pen_px=pen_px, finer=4 if side_px <= 1024 else 1)


AXES: dict[str, tuple[Callable[[str, float], Known], tuple[float, ...], tuple[float, float]]] = {
    "line width, px": (by_width, (0.7, 1, 1.5, 2, 3, 5, 8, 12, 20, 30, 40, 60), (1, 40)),
    "ink contrast, %": (by_contrast, (8, 12, 15, 20, 30, 50, 75, 100), (15, 100)),
    "rotation, degrees": (by_rotation, tuple(np.arange(0, 91, 11.25).tolist()), (0, 90)),
    "side, px": (by_size, (48, 64, 96, 128, 256, 512, 1024, 2048, 4096), (64, 4096)),
}
"""Of each axis: the drawing at a value, the values, and the range that is worked in."""


def measured(axis: str) -> list[float]:
    """Mean F1 of the drawings at each value."""
    at, values, _ = AXES[axis]
    found = []
    for value in values:
        drawings = [at(name, value) for name in _NAMES]
        found.append(float(np.mean([measure(known, understood(known.grey).strokes).f1 for known in drawings])))
        print(f"{axis:20}{value:>8g}{found[-1]:>9.4f}", flush=True)
    return found


def chart(f1: dict[str, list[float]]) -> Picture:
    """A chart for each axis, the range that is worked in shaded, the bar dashed."""
    return np.concatenate([_one(axis, found) for axis, found in f1.items()], axis=1)


def _one(axis: str, found: list[float]) -> Picture:
    _, values, (low, high) = AXES[axis]
    picture = canvas.blank(_WIDE_PX, _TALL_PX, canvas.PAPER)
    evenly = np.linspace(_MARGIN_PX, _WIDE_PX - 24, len(values))
    inside = evenly[[low <= value <= high for value in values]]
    cv2.rectangle(picture, (int(inside[0]), 36), (int(inside[-1]), _TALL_PX - 40), canvas.DESK, -1)
    canvas.dashes(picture, np.array([[_MARGIN_PX, _y(BAR)], [_WIDE_PX - 24.0, _y(BAR)]]), canvas.ORANGE)
    for share in (0.8, 0.9, 1.0):
        canvas.write(picture, f"{share:g}", (_MARGIN_PX - 12, _y(share) + 5), canvas.QUIET, align="right")
    canvas.write(picture, f"F1 over {axis}", (_MARGIN_PX, 22), weight=600)
    points = np.stack([evenly, [_y(each) for each in found]], axis=1)
    canvas.line(picture, points, canvas.BLUE, 3)
    for point, value in zip(points, values, strict=True):
        canvas.dot(picture, point, 4, canvas.BLUE)
        canvas.write(picture, f"{value:g}", (point[0] - 8, _TALL_PX - 16), canvas.QUIET, size_px=12)
    return picture


def _y(f1: float) -> float:
    return 40 + (1.0 - max(f1, 0.75)) / 0.25 * (_TALL_PX - 84)


def main() -> None:
    cv2.setNumThreads(1)
    found = {axis: measured(axis) for axis in AXES}
    for path in sys.argv[1:2]:
        Path(path).write_bytes(canvas.png(chart(found)))


if __name__ == "__main__":
    main()
