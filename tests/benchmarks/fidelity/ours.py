"""What linedrawd makes of a picture: the stages of planning up to strokes in px of the given picture."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TypeVar

import cv2

from daemon.graph.interpret import interpret
from daemon.graph.strokes import strokes
from daemon.intake.decode import decode
from daemon.jobs.planner import drawing_on_given
from daemon.page.prepare import prepare
from daemon.report import canvas
from daemon.report.explain import explain
from daemon.shapes import Drawing, Grey, LineGraph, PageImage, Points, Segmentation
from daemon.toolpath.order import order
from daemon.toolpath.rejoin import rejoined
from daemon.vision.segmenter import Segmenter

Value = TypeVar("Value")
_HOME = (0.0, 0.0)


@dataclass(frozen=True, slots=True, eq=False)
class Understood:
    """strokes: in px of the given picture, in drawing order. The rest is in px of the page."""

    strokes: list[Points]
    page: PageImage
    segmentation: Segmentation
    graph: LineGraph
    on_page: Drawing
    cpu_ms: float
    network_cpu_ms: float
    """The part of cpu_ms that the network took."""


def understood(grey: Grey) -> Understood:
    """Decode, prepare, segment, interpret, strokes, back to the given picture. The order is not in the time."""
    with tempfile.TemporaryDirectory() as folder:
        picture = Path(folder) / "picture.png"
        cv2.imwrite(str(picture), grey)
        page, page_ms = _timed(lambda: prepare(decode(picture)))
    segmentation, network_ms = _timed(lambda: _segmenter().segment(page))
    graph, graph_ms = _timed(lambda: interpret(page, segmentation))
    on_page, strokes_ms = _timed(lambda: strokes(graph, width_px=page.grey.shape[1], height_px=page.grey.shape[0]))
    drawing, back_ms = _timed(lambda: drawing_on_given(on_page, page))
    tour = rejoined(order(drawing.strokes, start_mm=_HOME, end_mm=_HOME), start_mm=_HOME, end_mm=_HOME)
    cpu_ms = page_ms + network_ms + graph_ms + strokes_ms + back_ms
    return Understood([stroke.points for stroke in tour], page, segmentation, graph, on_page, cpu_ms, network_ms)


def explained(seen: Understood, name: str) -> bytes:
    """The job's explain picture, as PNG."""
    return canvas.png(explain(seen.page, seen.segmentation, seen.graph, seen.on_page, name=name))


@lru_cache(maxsize=1)
def _segmenter() -> Segmenter:
    return Segmenter(threads=1)


def _timed(work: Callable[[], Value]) -> tuple[Value, float]:
    began = time.process_time()
    value = work()
    return value, (time.process_time() - began) * 1000
