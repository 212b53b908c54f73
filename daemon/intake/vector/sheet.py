"""A page of lines as the other rooms see it: its drawing, its graph, and the picture that it is compared with."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np

from daemon.colours import ONE_PEN, Pens
from daemon.intake.vector.common import Vectors
from daemon.intake.vector.overlaps import drawn_once
from daemon.shapes import Drawing, Edge, Grey, LineGraph, PageImage, Points, Stroke

_PX_PER_MM = 10.0
_LEAST_PX, _MOST_PX = 1000, 4000
"""Of the picture's longer side."""
LINE_WIDTH_PX, _THICKNESS = 5.5, 4
"""What OpenCV draws with this thickness, antialiased, is so wide: ink above half darkness, by its area."""
_SUBPIXEL_BITS = 4


@dataclass(frozen=True, slots=True, eq=False)
class VectorPage:
    """page: all lines of the file, inked with a pen of LINE_WIDTH_PX. drawing: each line once, in px of the page.

    graph: an edge for each stroke of the drawing.
    """

    page: PageImage
    drawing: Drawing
    graph: LineGraph


def as_page(vectors: Vectors, *, sha256: str, pens: Pens = ONE_PEN) -> VectorPage:
    """The page of these lines, inked before overlapping lines are taken off, so that a lost line shows.

    The page has px_per_mm where the file says how large it is. sha256: of the file. pens: each line is drawn with the
    one whose colour is nearest to its own; what a pen that is left out would draw is not on the page either.
    """
    by_pen = pens.sorted(vectors.lines, vectors.colours)
    scale = _px_per_mm(vectors)
    width_px, height_px = (max(1, math.ceil(side * scale)) for side in (vectors.width_mm, vectors.height_mm))
    stated = scale if vectors.sized else None
    page = PageImage(
        grey=_inked([line * scale - 0.5 for lines in by_pen.values() for line in lines], width_px, height_px),
        to_given=np.eye(3),
        given_width_px=width_px,
        given_height_px=height_px,
        sha256=sha256,
        line_width_px=LINE_WIDTH_PX,
        px_per_mm=stated,
        warnings=vectors.warnings,
    )
    strokes = tuple(Stroke(line * scale - 0.5, pen) for pen, lines in by_pen.items() for line in drawn_once(lines))
    return VectorPage(page, Drawing(strokes, width_px, height_px, stated), _graph(strokes))


def _px_per_mm(vectors: Vectors) -> float:
    longer_mm = max(vectors.width_mm, vectors.height_mm)
    return min(max(_PX_PER_MM, _LEAST_PX / longer_mm), _MOST_PX / longer_mm)


def _inked(lines: list[Points], width_px: int, height_px: int) -> Grey:
    grey = np.full((height_px, width_px), 255, np.uint8)
    for line in lines:
        fixed = np.rint(line * (1 << _SUBPIXEL_BITS)).astype(np.int32)
        if len(line) == 1:
            radius = round(LINE_WIDTH_PX / 2 * (1 << _SUBPIXEL_BITS))
            cv2.circle(grey, fixed[0].tolist(), radius, 0, -1, cv2.LINE_AA, _SUBPIXEL_BITS)
        else:
            cv2.polylines(grey, [fixed], False, 0, _THICKNESS, cv2.LINE_AA, _SUBPIXEL_BITS)
    return grey


def _graph(strokes: tuple[Stroke, ...]) -> LineGraph:
    ends = [stroke.points[[0, -1]] for stroke in strokes]
    vertices, index = np.unique(np.concatenate([np.empty((0, 2)), *ends]).round(3), axis=0, return_inverse=True)
    pairs = index.reshape(-1, 2).tolist()
    edges = (Edge(a, b, stroke.points, 1.0, 1.0) for (a, b), stroke in zip(pairs, strokes, strict=True))
    return LineGraph(np.asarray(vertices, float), tuple(edges))
