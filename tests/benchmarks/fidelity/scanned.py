"""Scan-like pictures, A5 at 300 dpi: pencil, ball pen and marker on plain, ruled, squared and recycled paper."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from daemon.shapes import Map, Points
from tests.benchmarks.fidelity.known import Known
from tests.benchmarks.fidelity.subjects import subjects
from tests.benchmarks.fidelity.wear import Camera, Paper, Random, inked, light, pencilled, sheet_of, smooth, taken

SHAPE_PX = (2480, 1748)
PX_PER_MM = 300 / 25.4
_SKETCH_MM = 120.0
_FINER = 2


@dataclass(frozen=True, slots=True)
class Pen:
    """width_mm: of its line. dark: share of the light that it takes. grainy: whether it leaves the tooth white."""

    width_mm: float
    dark: float
    grainy: bool = False


PENS = {"pencil": Pen(0.6, 0.6, grainy=True), "ball pen": Pen(0.45, 0.85), "marker": Pen(2.0, 0.95)}
PAPERS = {"plain": Paper(0.96, 0.006), "ruled": Paper(0.95, 0.006), "squared": Paper(0.93, 0.008)}
PAPERS |= {"recycled": Paper(0.80, 0.02, fibres=900)}


def scans() -> list[Known]:
    """Forty, pens and papers in turn: ruled every 8 mm, squared every 5 mm, skewed by up to 1.5 degrees, JPEG of 90."""
    pens, papers = list(PENS), list(PAPERS)
    return [
        _scan(f"{name}, {pens[i % 3]}, {papers[i % 4]}", strokes, random, (PENS[pens[i % 3]], papers[i % 4]))
        for i, (name, strokes, random) in enumerate(subjects())
    ]


def _scan(name: str, subject: list[Points], random: Random, how: tuple[Pen, str]) -> Known:
    pen, paper = how
    corner = (np.array(SHAPE_PX[::-1]) - _SKETCH_MM * PX_PER_MM) / 2
    strokes = [points * _SKETCH_MM / 100 * PX_PER_MM + corner for points in subject]
    pen_px = pen.width_mm * PX_PER_MM
    ink = inked(strokes, SHAPE_PX, pen_px, finer=_FINER)
    page = sheet_of(SHAPE_PX, PAPERS[paper], random) * (1 - random.uniform(0.15, 0.35) * _ruling(paper, random))
    page *= 1 - pen.dark * (pencilled(ink, random) if pen.grainy else ink)
    page *= light(SHAPE_PX, random, darkest=0.95)
    given = taken(np.asarray(page, np.float32), Camera(0.6, 2.5, 90), random)
    return Known(name, strokes, max(SHAPE_PX), pen_px=pen_px, finer=_FINER, given=given)


def _ruling(paper: str, random: Random) -> Map:
    """The lines of the paper, 0.2 mm wide, a little skew: once for ruled, both ways for squared paper."""
    drawn = np.zeros(SHAPE_PX, np.uint8)
    pitch = {"ruled": 8.0, "squared": 5.0}.get(paper, 0.0) * PX_PER_MM
    slope, first = np.tan(np.radians(random.uniform(-1.5, 1.5))), random.uniform(0, 60)
    if pitch:
        for at in np.arange(first - pitch, SHAPE_PX[0] + pitch, pitch):
            _line(drawn, (0, at), (SHAPE_PX[1], at + slope * SHAPE_PX[1]))
    if paper == "squared":
        for at in np.arange(first - pitch, SHAPE_PX[1] + pitch, pitch):
            _line(drawn, (at, 0), (at - slope * SHAPE_PX[0], SHAPE_PX[0]))
    return smooth(drawn.astype(np.float32) / 255, 0.5)


def _line(drawn: np.ndarray, start: tuple[float, float], end: tuple[float, float]) -> None:
    fixed = [tuple(round(each * 16) for each in point) for point in (start, end)]
    cv2.line(drawn, fixed[0], fixed[1], 255, 2, cv2.LINE_AA, 4)
