"""CPU milliseconds of each stage of planning, on one thread, for pages of 256, 512 and 1024 px."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import cv2

from daemon.graph.interpret import interpret
from daemon.graph.strokes import strokes
from daemon.intake.decode import decode
from daemon.page.prepare import prepare
from daemon.program.gcode import ZPen, write_gcode
from daemon.report import canvas
from daemon.report.explain import explain
from daemon.report.fidelity import fidelity
from daemon.report.preview import preview
from daemon.toolpath.place import Layout
from daemon.toolpath.plan import plan_toolpath
from daemon.vision.segmenter import Segmenter
from firmware_protocol.grbl.simulator.planner import line_times_s
from tests.benchmarks.pages import SIDES_PX, page

ROUNDS = 3
_BOX_MM = (64.0, 64.0)
_CORNER_MM = (25.0, 25.0)

Value = TypeVar("Value")


class Stopwatch:
    """The least CPU milliseconds that each named stage took in several rounds."""

    def __init__(self) -> None:
        self.ms: dict[str, float] = {}

    def __call__(self, stage: str, work: Callable[[], Value]) -> Value:
        started = time.process_time()
        value = work()
        took = (time.process_time() - started) * 1000
        self.ms[stage] = min(took, self.ms.get(stage, took))
        return value


def show() -> None:
    """Print the table."""
    cv2.setNumThreads(1)
    segmenter = Segmenter(threads=1)
    found: dict[int, tuple[dict[str, float], str]] = {side: measure(side, segmenter) for side in SIDES_PX}
    print(f"CPU ms of each stage, one thread, least of {ROUNDS} rounds; one sketch repeated 1, 4 and 16 times")
    print(f"{'':12}" + "".join(f"{side:>8} px" for side in SIDES_PX) + f"{'share':>9}{'1024 : 256':>13}")
    totals = [sum(found[side][0].values()) for side in SIDES_PX]
    for stage in found[SIDES_PX[0]][0]:
        row(stage, [found[side][0][stage] for side in SIDES_PX], totals[-1])
    row("all", totals, totals[-1])
    for side in SIDES_PX:
        print(f"{side:>5} px: {found[side][1]}")


def row(stage: str, ms: list[float], total_ms: float) -> None:
    figures = "".join(f"{each:>11.1f}" for each in ms)
    print(f"{stage:12}{figures}{ms[-1] / total_ms:>8.0%}{ms[-1] / max(ms[0], 0.01):>12.1f}")


def measure(side_px: int, segmenter: Segmenter) -> tuple[dict[str, float], str]:
    """The milliseconds of each stage, and in words what came of the page."""
    watch, said = Stopwatch(), ""
    with tempfile.TemporaryDirectory() as folder:
        picture = Path(folder) / "page.png"
        cv2.imwrite(str(picture), page(side_px))
        for _ in range(ROUNDS):
            said = planned(picture, segmenter, watch)
    return watch.ms, said


def planned(picture: Path, segmenter: Segmenter, watch: Stopwatch) -> str:
    given = watch("decode", lambda: decode(picture))
    page = watch("page", lambda: prepare(given))
    segmentation = watch("vision", lambda: segmenter.segment(page))
    graph = watch("graph", lambda: interpret(page, segmentation))
    height, width = page.grey.shape
    drawing = watch("strokes", lambda: strokes(graph, width_px=width, height_px=height))
    toolpath = watch("toolpath", lambda: plan_toolpath(drawing, layout=Layout(_BOX_MM, _CORNER_MM)))
    program = watch("program", lambda: write_gcode(toolpath, pen=ZPen(up_mm=5, down_mm=0), draw_mm_s=20))
    times_s = watch("estimate", lambda: line_times_s([line.text for line in program.lines]))
    lines = [stroke.points for stroke in drawing.strokes]
    found = watch("fidelity", lambda: fidelity(page, lines, line_width_px=page.line_width_px or 1.0))
    watch("explain", lambda: canvas.png(explain(page, segmentation, graph, drawing, name="page.png")))
    watch("preview", lambda: canvas.png(preview(toolpath, box_mm=_BOX_MM, box_origin_mm=_CORNER_MM)))
    return (
        f"{len(graph.vertices)} vertices, {len(graph.edges)} edges, {len(drawing.strokes)} strokes, "
        f"{len(program.lines)} lines, {times_s[-1]:.0f} s on the plotter, "
        f"planned f1 {found.f1:.4f}, iou {found.iou:.3f}"
    )
