"""The paths of a page of a PDF, by PDFium's own functions, become lines in mm."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from daemon.colours import BLACK, Rgb
from daemon.intake.vector.common import FLAT_MM, Collected, Vectors, checked_points, chords_of_bezier, clipped, left_out
from daemon.intake.vector.dashes import dashed
from daemon.intake.vector.svg_units import Matrix
from daemon.shapes import Points

_MOST_OBJECTS = 100_000
_MOST_NESTED = 20
_WHITE_FROM, _SEEN_FROM = 250, 5
"""Of 255, of colours and of opacity."""


Box: TypeAlias = tuple[tuple[float, float], tuple[float, float]]
"""Its lower and its higher corner."""
_EVERYWHERE: Box = ((-math.inf, -math.inf), (math.inf, math.inf))


@dataclass(frozen=True, slots=True, eq=False)
class _Shown:
    """object: of PDFium. to_mm: from its space. within: what is seen of it. nested: it lies in so many forms."""

    object: Any
    to_mm: Matrix
    within: Box
    nested: int = 0


class Reading:
    """raw: PDFium's functions. sheet: the page. to_mm: from its units."""

    def __init__(self, raw: Any, sheet: Any, to_mm: Matrix) -> None:
        self._c, self._sheet, self._to_mm = raw, sheet, to_mm
        self._collected = Collected()
        self._white = self._segments = 0

    def vectors(self, size_mm: tuple[float, float]) -> Vectors | None:
        """All lines of the page; None where it holds something else. Raises ValueError where it holds too much."""
        shown = list(self._shown())
        if any(self._c.FPDFPageObj_GetType(each.object) != self._c.FPDF_PAGEOBJ_PATH for each in shown):
            return None
        for each in shown:
            self._path(each)
        found = self._collected
        found.clip(size_mm)
        warnings = left_out(self._white, "white shape", "white shapes")
        return Vectors(tuple(found.lines), *size_mm, True, tuple(warnings), tuple(found.colours))

    def _shown(self) -> Iterator[_Shown]:
        """Each object of the page but forms, which are taken apart."""
        c = self._c
        top = _each(self._sheet, c.FPDFPage_CountObjects, c.FPDFPage_GetObject)
        waiting = [_Shown(each, self._to_mm, _EVERYWHERE) for each in top][::-1]
        for _ in range(_MOST_OBJECTS):
            if not waiting:
                return
            each = waiting.pop()
            if each.nested > _MOST_NESTED or c.FPDFPageObj_GetType(each.object) != c.FPDF_PAGEOBJ_FORM:
                yield each
                continue
            inner = _each(each.object, c.FPDFFormObj_CountObjects, c.FPDFFormObj_GetObject)
            here, within = each.to_mm @ self._matrix(each.object), self._clip(each)
            waiting += [_Shown(child, here, within, each.nested + 1) for child in inner][::-1]
        raise ValueError(f"holds more than {_MOST_OBJECTS} objects on a page: simplify it")

    def _matrix(self, each: Any) -> Matrix:
        found = self._c.FS_MATRIX()
        self._c.FPDFPageObj_GetMatrix(each, found)
        return np.array([[found.a, found.c, found.e], [found.b, found.d, found.f], [0, 0, 1]], float)

    def _path(self, shown: _Shown) -> None:
        each, fill, line = shown.object, ctypes.c_int(), ctypes.c_int()
        self._c.FPDFPath_GetDrawMode(each, fill, line)
        stroked = self._inked(each, self._c.FPDFPageObj_GetStrokeColor) if line.value else ()
        filled = self._inked(each, self._c.FPDFPageObj_GetFillColor) if fill.value else ()
        if not stroked and not filled:
            self._white += bool(line.value or fill.value)
            return
        own_to_mm = shown.to_mm @ self._matrix(each)
        scale = math.sqrt(abs(float(np.linalg.det(own_to_mm[:2, :2]))))
        dashes = [] if filled else [length * scale for length in self._dashes(each)]
        lines = [part for run in self._runs(each, own_to_mm, close=not stroked) for part in dashed(run, dashes)]
        for part in clipped(lines, *self._clip(shown)):
            self._collected.add(part, (stroked or filled)[0])

    def _inked(self, each: Any, colour_of: Callable[..., int]) -> tuple[Rgb, ...]:
        """Its colour where that is seen on white paper; one that is not told is taken for black ink."""
        red, green, blue, opacity = (ctypes.c_uint() for _ in range(4))
        if not colour_of(each, red, green, blue, opacity):
            return (BLACK,)
        colour = red.value, green.value, blue.value
        return (colour,) if opacity.value >= _SEEN_FROM and min(colour) < _WHITE_FROM else ()

    def _dashes(self, each: Any) -> list[float]:
        count = self._c.FPDFPageObj_GetDashCount(each)
        if count <= 0:
            return []
        found = (ctypes.c_float * count)()
        self._c.FPDFPageObj_GetDashArray(each, found, count)
        pattern = [float(value) for value in found]
        return pattern * (1 + count % 2) if min(pattern) >= 0 and sum(pattern) > 0 else []

    def _runs(self, each: Any, to_mm: Matrix, *, close: bool) -> list[Points]:
        c = self._c
        segments = range(c.FPDFPath_CountSegments(each))
        self._segments = checked_points(self._segments + len(segments))
        return _flat((self._segment(c.FPDFPath_GetPathSegment(each, index)) for index in segments), to_mm, close=close)

    def _segment(self, segment: Any) -> tuple[str, tuple[float, float], bool]:
        c = self._c
        x, y = ctypes.c_float(), ctypes.c_float()
        c.FPDFPathSegment_GetPoint(segment, x, y)
        kinds = {c.FPDF_SEGMENT_MOVETO: "move", c.FPDF_SEGMENT_BEZIERTO: "curve"}
        kind = kinds.get(c.FPDFPathSegment_GetType(segment), "line")
        return kind, (x.value, y.value), bool(c.FPDFPathSegment_GetClose(segment))

    def _clip(self, shown: _Shown) -> Box:
        """The box in mm that it is seen in: that of each path that it is clipped by, and of the form that it is in."""
        c = self._c
        clip = c.FPDFPageObj_GetClipPath(shown.object)
        box = shown.within
        for index in range(max(0, c.FPDFClipPath_CountPaths(clip)) if clip else 0):
            count = c.FPDFClipPath_CountPathSegments(clip, index)
            points = [self._segment(c.FPDFClipPath_GetPathSegment(clip, index, k))[1] for k in range(count)]
            if points:
                box = self._common(box, np.array(points) @ shown.to_mm[:2, :2].T + shown.to_mm[:2, 2])
        return box

    def _common(self, box: Box, clip: Points) -> Box:
        low, high = clip.min(axis=0), clip.max(axis=0)
        # The lines on a clip's own edge are seen by half of their width.
        low, high = np.maximum(box[0], low - FLAT_MM), np.minimum(box[1], high + FLAT_MM)
        return (low[0], low[1]), (high[0], high[1])


def _each(owner: Any, count: Callable[[Any], int], get: Callable[[Any, int], Any]) -> Iterator[Any]:
    return (get(owner, index) for index in range(max(0, count(owner))))


def _flat(segments: Iterator[tuple[str, tuple[float, float], bool]], to_mm: Matrix, *, close: bool) -> list[Points]:
    """The subpaths as points in mm; close: also those that the file leaves open."""
    runs: list[list[Points]] = []
    control: list[Points] = []
    for kind, point, closed in segments:
        placed = np.asarray(point, float) @ to_mm[:2, :2].T + to_mm[:2, 2]
        if kind == "move" or not runs:
            runs.append([placed[None]])
            continue
        if kind == "line":
            runs[-1].append(placed[None])
        else:
            control.append(placed)
        if len(control) == 3:
            runs[-1].append(chords_of_bezier(np.array([runs[-1][-1][-1], *control]), within=FLAT_MM))
            control = []
        if closed:
            runs[-1].append(runs[-1][0])
    lines = [np.concatenate([*run, run[0]] if close else run) for run in runs if len(run) > 1]
    return [line[np.r_[True, (np.diff(line, axis=0) != 0).any(axis=1)]] for line in lines]
