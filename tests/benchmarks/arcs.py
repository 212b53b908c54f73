"""What arcs save: program lines, and seconds on the simulated plotter, against polylines within the same error.

    python -m tests.benchmarks arcs

Our own drawings and the set of curves, in a box of 64 mm, each planned both ways; the set of curves once more without
the four that are mostly straight lines. Hausdorff: between the arcs and the lines as they were traced. CPU: of ordering
and fitting.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from daemon.intake.decode import decode
from daemon.program.gcode import ZPen, write_gcode
from daemon.shapes import Drawing, Grey, Points, Stroke, Toolpath
from daemon.toolpath.curves import points_of
from daemon.toolpath.place import place
from daemon.toolpath.plan import Precision, plan_toolpath
from firmware_protocol.grbl.simulator.planner import line_times_s
from tests.benchmarks.fidelity.curves import curves
from tests.benchmarks.fidelity.ours import understood
from tests.daemon.toolpath.strokes import hausdorff_mm
from tests.drawings.make import SHEETS

STRAIGHT = {"house", "star", "gear 12", "gear 8"}
"""Of the set of curves: these would take as many moves if there were no arcs."""
DRAWINGS = Path(__file__).parents[1] / "drawings"
ERROR_MM, RESOLUTION_MM = 0.05, 0.02
PEN, DRAW_MM_S = ZPen(), 40.0
STOCK: dict[int, float] = {}
"""The controller's defaults: 500 mm/min and 10 mm/s2."""
BRISK = {110: 6000.0, 111: 6000.0, 112: 3000.0, 120: 500.0, 121: 500.0, 122: 500.0}


@dataclass(frozen=True, slots=True)
class Figures:
    """As pieces and as arcs: moves, pen down; lines of the program; seconds on a stock and a brisk plotter; of CPU."""

    moves: tuple[float, float]
    lines: tuple[float, float]
    stock_s: tuple[float, float]
    brisk_s: tuple[float, float]
    cpu_s: tuple[float, float]
    hausdorff_mm: float


def show() -> None:
    """Print a line a drawing and one for each set."""
    print(f"pieces and arcs, both within {ERROR_MM} mm; s at {DRAW_MM_S:g} mm/s, stock (10 mm/s2), brisk (500 mm/s2)")
    print(
        f"{'':22}{'moves':>11}{'':6}{'lines':>11}{'':6}{'stock s':>15}{'brisk s':>15}{'CPU s':>15}{'Hausdorff mm':>14}"
    )
    for name, drawings in (("curves", _curves()), ("drawings", _drawings())):
        rows = {}
        for title, grey in drawings:
            rows[title] = figures(grey)
            _print(title, rows[title])
        _print(f"{name}, all", _sum(list(rows.values())))
        if rows.keys() & STRAIGHT:
            _print(f"{name}, curved ones", _sum([rows[title] for title in rows if title not in STRAIGHT]))


def figures(grey: Grey) -> Figures:
    """Of one picture."""
    height_px, width_px = grey.shape
    drawing = Drawing(tuple(map(Stroke, understood(grey).strokes)), width_px, height_px)
    error = Precision(ERROR_MM, np.inf, RESOLUTION_MM)
    begun_s = time.process_time()
    pieces = plan_toolpath(drawing, precision=error, rejoin=False)
    between_s = time.process_time()
    arcs = plan_toolpath(drawing, precision=Precision(ERROR_MM, np.inf, RESOLUTION_MM, ERROR_MM), rejoin=False)
    ended_s = time.process_time()
    programs = [
        [line.text for line in write_gcode(each, pen=PEN, draw_mm_s=DRAW_MM_S).lines] for each in (pieces, arcs)
    ]
    return Figures(
        (sum(len(stroke.points) - 1 for stroke in pieces.strokes), sum(len(s.moves or ()) for s in arcs.strokes)),
        (len(programs[0]), len(programs[1])),
        (line_times_s(programs[0], STOCK)[-1], line_times_s(programs[1], STOCK)[-1]),
        (line_times_s(programs[0], BRISK)[-1], line_times_s(programs[1], BRISK)[-1]),
        (between_s - begun_s, ended_s - between_s),
        _off_mm(drawing, arcs),
    )


def _off_mm(drawing: Drawing, arcs: Toolpath) -> float:
    """How far arcs and traced lines are apart at most, stroke by stroke; which is which is told by their ends."""
    traced = [place(stroke.points, arcs.from_px) for stroke in drawing.strokes]
    found = []
    for stroke in arcs.strokes:
        line = points_of(stroke.points[0], stroke.moves, chord_mm=1e-3) if stroke.moves else stroke.points
        found.append(min(hausdorff_mm(line, other) for other in traced if _may_be(other, stroke)))
    return max(found, default=0.0)


def _may_be(traced: Points, stroke: Stroke) -> bool:
    """A closed one may begin at any of its points."""
    nearest = np.hypot(*(traced[:, None] - stroke.points[[0, -1]]).T).min(axis=1)
    return bool((nearest < 1e-6).all())


def _curves() -> Iterator[tuple[str, Grey]]:
    for known in curves():
        yield known.name, known.grey


def _drawings() -> Iterator[tuple[str, Grey]]:
    for sheet in SHEETS:
        yield sheet.file, decode(DRAWINGS / sheet.file).grey


def _sum(rows: list[Figures]) -> Figures:
    def both(pairs: Iterable[tuple[float, float]]) -> tuple[float, float]:
        pieces, arcs = zip(*pairs, strict=True)
        return sum(pieces), sum(arcs)

    return Figures(
        both(row.moves for row in rows),
        both(row.lines for row in rows),
        both(row.stock_s for row in rows),
        both(row.brisk_s for row in rows),
        both(row.cpu_s for row in rows),
        max(row.hausdorff_mm for row in rows),
    )


def _print(title: str, row: Figures) -> None:
    counts = "".join(f"{a:6.0f}{b:5.0f}{a / max(b, 1):5.1f}x" for a, b in (row.moves, row.lines))
    times = "".join(f"{a:8.1f}{b:7.1f}" for a, b in (row.stock_s, row.brisk_s))
    cpu = f"{row.cpu_s[0]:8.2f}{row.cpu_s[1]:7.2f}"
    print(f"{title:22}{counts}{times}{cpu}{row.hausdorff_mm:14.3f}", flush=True)
