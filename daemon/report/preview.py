"""preview.png: the sheet as it will be drawn."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Literal

import numpy as np

from daemon.report import canvas
from daemon.report.canvas import Picture
from daemon.shapes import Points, Toolpath

_LONG_SIDE_PX = 960
_MARGIN_PX = 48
_LEAST_WIDTH_PX = 860  # Room for the words below.
_FOOT_PX = 64
_AROUND_MM = 8.0
_RULER = (242, 240, 238)
_TRAVEL = (230, 190, 140)


def preview(
    toolpath: Toolpath,
    *,
    box_mm: tuple[float, float],
    box_origin_mm: tuple[float, float],
    seconds: float | None = None,
    line_width_mm: float = 0.4,
) -> Picture:
    """Strokes black or in their pens' colours, travel dashed, box, origin and parked pen, a ruler, size and time.

    box_mm: width and height of the box. box_origin_mm: its lower left corner, in machine mm like the toolpath.
    seconds: how long drawing will take, None where nobody knows. Returns uint8 (H, W, 3), y up like the machine.
    """
    sheet = _Sheet(_area(toolpath, box_mm, box_origin_mm))
    picture = sheet.picture
    _rulers(sheet)
    corner = np.asarray(box_origin_mm, float)
    (left, bottom), (right, top) = sheet.px(np.stack([corner, corner + box_mm]))
    canvas.box(picture, (left, bottom), (right, top), canvas.FRAME)
    _travel(sheet, toolpath)
    for stroke in toolpath.strokes:
        ink = _bgr(toolpath.pens[stroke.pen].colour) if toolpath.pens else canvas.INK
        canvas.line(picture, sheet.px(stroke.points), ink, line_width_mm * sheet.px_per_mm)
    _marks(sheet, toolpath)
    _words(picture, toolpath, seconds)
    return picture


def in_words(seconds: float) -> str:
    """A duration as people say it: "48 s", "3 min 20 s", "1 h 05 min"."""
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60:02d} s"
    return f"{whole // 3600} h {whole % 3600 // 60:02d} min"


def _bgr(colour: str) -> tuple[int, int, int]:
    red, green, blue = bytes.fromhex(colour.removeprefix("#"))
    return blue, green, red


class _Sheet:
    """A picture of an area of the machine, and where a point of the machine lies on it."""

    def __init__(self, area_mm: Points) -> None:
        self.low, self.high = area_mm
        size = self.high - self.low
        self.px_per_mm = float(_LONG_SIDE_PX / size.max())
        width, height = np.ceil(size * self.px_per_mm).astype(int) + 2 * _MARGIN_PX
        self.picture = canvas.blank(max(int(width), _LEAST_WIDTH_PX), int(height) + _FOOT_PX)

    def px(self, points_mm: Points) -> Points:
        x = _MARGIN_PX + (points_mm[:, 0] - self.low[0]) * self.px_per_mm
        y = _MARGIN_PX + (self.high[1] - points_mm[:, 1]) * self.px_per_mm
        return np.stack([x, y], axis=1)


def _area(toolpath: Toolpath, box_mm: tuple[float, float], box_origin_mm: tuple[float, float]) -> Points:
    """The lowest and the highest corner in mm, (2, 2), of everything that is shown."""
    corner = np.asarray(box_origin_mm, float)
    ends = np.array([corner, corner + box_mm, toolpath.start_mm, toolpath.park_mm, (0.0, 0.0)])
    points = np.concatenate([ends, *(stroke.points for stroke in toolpath.strokes)])
    return np.stack([points.min(axis=0) - _AROUND_MM, points.max(axis=0) + _AROUND_MM])


def _rulers(sheet: _Sheet) -> None:
    step = 10 if float((sheet.high - sheet.low).max()) < 250 else 50
    for axis in (0, 1):
        for count in range(math.ceil(sheet.low[axis] / step), math.floor(sheet.high[axis] / step) + 1):
            _ruler(sheet, axis, count * step)


def _ruler(sheet: _Sheet, axis: int, at_mm: int) -> None:
    ends = np.stack([sheet.low, sheet.high])
    ends[:, axis] = at_mm
    canvas.line(sheet.picture, sheet.px(ends), _RULER)
    x, y = sheet.px(ends)[0]
    align: Literal["centre", "right"] = "right" if axis else "centre"
    canvas.write(
        sheet.picture, str(at_mm), (x - 8, y + 5) if axis else (x, y + 18), canvas.QUIET, size_px=12, align=align
    )


def _travel(sheet: _Sheet, toolpath: Toolpath) -> None:
    park, stops = np.array([toolpath.park_mm], float), [np.array([toolpath.start_mm], float)]
    for index, stroke in enumerate(toolpath.strokes):
        stops += [*[park] * (index > 0 and index in toolpath.passes), stroke.points[[0, -1]]]
    stops.append(park)
    for before, after in pairwise(stops):
        canvas.dashes(sheet.picture, sheet.px(np.stack([before[-1], after[0]])), _TRAVEL)


def _marks(sheet: _Sheet, toolpath: Toolpath) -> None:
    origin, start, park = sheet.px(np.array([(0.0, 0.0), toolpath.start_mm, toolpath.park_mm]))
    arm = 12.0
    canvas.line(sheet.picture, origin + np.array([[-arm, 0], [arm, 0]]), canvas.RED)
    canvas.line(sheet.picture, origin + np.array([[0, -arm], [0, arm]]), canvas.RED)
    canvas.write(sheet.picture, "0, 0", (origin[0] + 8, origin[1] - 8), canvas.RED, size_px=13)
    canvas.dot(sheet.picture, start, 4.0, canvas.PAPER, canvas.GREEN)
    canvas.dot(sheet.picture, park, 2.0, canvas.RED)


def _words(picture: Picture, toolpath: Toolpath, seconds: float | None) -> None:
    said = [canvas.counted(len(toolpath.strokes), "stroke", "strokes")]
    if toolpath.strokes:
        points = np.concatenate([stroke.points for stroke in toolpath.strokes])
        width, height = points.max(axis=0) - points.min(axis=0)
        said.insert(0, f"{width:.1f} × {height:.1f} mm")
    said += [f"{toolpath.drawn_mm:.0f} mm drawn", f"{toolpath.travelled_mm:.0f} mm travelled"]
    said += [] if seconds is None else [f"about {in_words(seconds)}"]
    base = picture.shape[0] - 28
    canvas.write(picture, "   ·   ".join(said), (_MARGIN_PX, base), size_px=17, weight=500)
