"""The order of the rooms: from a picture file to a job's folder, and from drawn ink to its measure.

Runs in the worker process only. Writes strokes.json, drawing.svg, program.gcode, preview.png, preview.html,
explain.png and report.json.
"""

from __future__ import annotations

import json
import resource
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import TypeAlias

import numpy as np

from daemon.config import GrblMachine, Machine, Settings
from daemon.errors import LinedrawError
from daemon.graph.interpret import interpret, interpret_with_reasons
from daemon.graph.strokes import strokes
from daemon.graph.verdicts import as_json
from daemon.homography import through
from daemon.intake.picture import open_picture
from daemon.intake.scanner import is_scan
from daemon.intake.vector.sheet import VectorPage
from daemon.jobs.arrival import page_in
from daemon.jobs.correction import told
from daemon.jobs.devices import program_of, times_of
from daemon.jobs.folder import source_of, write_all_durably, write_durably
from daemon.jobs.pens import pens_of
from daemon.jobs.pictures import strokes_s, write_pictures
from daemon.jobs.sheet import box_origin_mm, reach_low_mm, reach_mm
from daemon.jobs.wishes import settings_for
from daemon.page.back import given_px
from daemon.page.colours import by_pen
from daemon.page.fills import Fill
from daemon.page.hatch import Hatch
from daemon.page.prepare import fit, put_right
from daemon.program.file import program_text
from daemon.report.fidelity import Fidelity, fidelity
from daemon.report.preview_html import Told
from daemon.report.report import executed_report, from_json, planned_report, to_json
from daemon.shapes import (
    Affine,
    Drawing,
    Homography,
    LineGraph,
    NamedPen,
    PageImage,
    Points,
    Segmentation,
    Stroke,
    Toolpath,
)
from daemon.toolpath.place import Layout, invert, place, placement
from daemon.toolpath.plan import Precision, plan_toolpath
from daemon.vision.segmenter import Segmenter

Progress: TypeAlias = Callable[[str], None]

_ERROR_PX = 0.25
"""Of the page as it is read: how far simplification may lead a line aside, whatever error_mm says."""


def _silent(stage: str = "") -> None:
    """Tells nobody."""


def plan_picture(
    source: Path,
    folder: Path,
    settings: Settings,
    machine: str,
    *,
    name: str = "",
    progress: Progress = _silent,
    planned: Callable[[], None] = _silent,
) -> None:
    """Plan one picture for one machine and fill its folder. Raises LinedrawError; a failed plan leaves no program.

    name: what people call the picture, if not by the path of `source`. planned: called as soon as the program can be
    drawn; the pictures of the plan, and how well it fits the page, come behind it.
    """
    stages, name, settings = Stages(progress), name or str(source), settings_for(folder, settings, machine)
    with stages("decode"):
        given = _opened(source, folder, settings, name)
    sized = isinstance(given, VectorPage) or is_scan(Path(name).name)
    seen = _known(given) if isinstance(given, VectorPage) else _read(given, folder, settings, stages, sized=sized)
    readable, page = seen.readable, seen.page
    with stages("toolpath"):
        toolpath = _toolpath(seen, settings, settings.machines[machine], sized=sized)
    with stages("program"):
        told_to_it = told(toolpath, settings.sheet, settings.machines[machine])
        program = program_of(told_to_it, settings.machines[machine], folder.name)
        times_s = times_of(program, settings.machines[machine])
        estimated_s = next(reversed(times_s), 0.0)
    width_px = _width_px(page, readable)
    report = planned_report(
        (readable, page), seen.graph, toolpath, None,
        line_width_px=width_px, estimated_s=estimated_s, stage_s=stages.seconds, peak_memory_mb=_peak_memory_mb(),
    )  # fmt: skip
    # The program comes last: a folder that holds one can be drawn.
    files = {"strokes.json": _strokes_json(seen.drawing), "report.json": to_json(report).encode()}
    write_all_durably(folder, files | {"program.gcode": program_text(program).encode()})
    planned()
    with stages("report"):
        about = Told(Path(name).name, machine, estimated_s, strokes_s(program, times_s))
        pages = given.page if isinstance(given, VectorPage) else given, readable
        understood = page, seen.segmentation, seen.graph, seen.on_page
        write_pictures(folder, settings, toolpath, about, pages=pages, understood=understood)
        # What was understood is large and not asked for again, and the measure needs its room.
        del given, seen, page, pages, understood
        found = _fidelity_mm(readable, [s.points for s in toolpath.strokes], toolpath.from_px, width_px)
    report = replace(report, fidelity=found, stage_s=stages.seconds, peak_memory_mb=_peak_memory_mb())
    write_durably(folder / "report.json", to_json(report).encode())


def measure_ink(folder: Path, settings: Settings, machine: str) -> None:
    """Compare the ink of a simulated machine (ink.json) with the given picture and write it into report.json."""
    ink = json.loads((folder / "ink.json").read_text())
    planned = from_json((folder / "report.json").read_text())
    source = source_of(folder)
    if source is None:
        raise LinedrawError(f"the picture has gone from {folder}: nothing to compare the ink with")
    given = _opened(source, folder, settings, str(source))
    readable = given.page if isinstance(given, VectorPage) else put_right(given)
    drawn = [np.array(stroke, float).reshape(-1, 2) for stroke in ink["strokes"]]
    found = _fidelity_mm(readable, drawn, np.array(planned.from_px), planned.line_width_px)
    executed = executed_report(planned, found, real_s=planned.real_s or 0.0)
    write_durably(folder / "report.json", to_json(executed).encode())


@dataclass(frozen=True, slots=True, eq=False)
class Understood:
    """readable: the page put right, in whose px `upright` is. page: as it is read, in px of which are the maps, the
    graph and `on_page`. drawing: in px of the given picture. segmentation: None where nothing had to be seen.
    """

    readable: PageImage
    page: PageImage
    segmentation: Segmentation | None
    graph: LineGraph
    on_page: Drawing
    upright: Drawing
    drawing: Drawing


class Stages:
    """Times each stage and tells its name when it begins."""

    def __init__(self, progress: Progress) -> None:
        self._progress = progress
        self.seconds: dict[str, float] = {}

    @contextmanager
    def __call__(self, name: str) -> Iterator[None]:
        self._progress(name)
        began = time.perf_counter()
        yield
        self.seconds[name] = time.perf_counter() - began


@lru_cache(maxsize=1)
def segmenter(network: str, threads: int) -> Segmenter:
    """Loaded once for all pictures of this process."""
    return Segmenter(network, threads=threads)


def _opened(source: Path, folder: Path, settings: Settings, name: str) -> PageImage | VectorPage:
    most, page = settings.intake.max_megapixels, page_in(folder)
    return open_picture(source, max_megapixels=most, name=name, page=page, pens=pens_of(settings.pens))


def _known(given: VectorPage) -> Understood:
    """A vector file says itself what is drawn."""
    page, drawing = given.page, given.drawing
    return Understood(page, page, None, given.graph, drawing, drawing, drawing)


def _read(given: PageImage, folder: Path, settings: Settings, stages: Stages, *, sized: bool) -> Understood:
    with stages("page"):
        readable = put_right(given)
        page = fit(readable, fill=_fill(readable, settings, sized=sized), merge=settings.planning.merge)
    with stages("vision"):
        segmentation = segmenter(settings.planning.network, settings.planning.threads).segment(page)
    with stages("graph"):
        graph = _graph(page, segmentation, folder, settings)
        on_page = by_pen(_strokes(graph, page, settings), page, graph.vertices, pens_of(settings.pens))
        drawing, upright = drawing_on_given(on_page, page), drawing_on_readable(on_page, page, readable)
    return Understood(readable, page, segmentation, graph, on_page, upright, drawing)


def _fill(readable: PageImage, settings: Settings, *, sized: bool) -> Fill:
    """What becomes of filled areas; a hatch as it comes to lie on paper."""
    planning = settings.planning
    if planning.fill != "hatch":
        return planning.fill
    (machine,) = settings.machines.values()
    height_px, width_px = readable.grey.shape
    layout = _layout(readable, settings, machine, sized=sized)
    from_px = placement(width_px, height_px, layout, px_per_mm=readable.px_per_mm)
    px_per_mm = 1 / float(np.hypot(*from_px[:, 0]))
    return Hatch(planning.hatch_spacing_mm * px_per_mm, planning.hatch_angle_deg, planning.hatch_cross)


def drawing_on_given(drawing: Drawing, page: PageImage) -> Drawing:
    """The same strokes in px of the given picture, however its sheet lies in it."""
    size_px = page.given_width_px, page.given_height_px
    return Drawing(_moved(drawing, page.to_given), *size_px, page.px_per_mm)


def drawing_on_readable(drawing: Drawing, page: PageImage, readable: PageImage) -> Drawing:
    """The same strokes in px of the page that was put right, before it was scaled: as they are drawn and measured."""
    height_px, width_px = readable.grey.shape
    back = np.linalg.inv(readable.to_given) @ page.to_given
    return Drawing(_moved(drawing, back), width_px, height_px, readable.px_per_mm)


def _width_px(page: PageImage, readable: PageImage) -> float:
    """Full width of the lines on the page put right; 1 where it holds none."""
    return max(1.0, (page.line_width_px or 0.0) * given_px(page) / given_px(readable))


def _moved(drawing: Drawing, to: Homography) -> tuple[Stroke, ...]:
    return tuple(replace(stroke, points=through(to, stroke.points)) for stroke in drawing.strokes)


def _graph(page: PageImage, segmentation: Segmentation, folder: Path, settings: Settings) -> LineGraph:
    """The graph of a page, and explain.json where it is asked for: the paper's own form has no rules to explain."""
    if settings.planning.graph == "paper" or not settings.planning.explain:
        return interpret(page, segmentation, mode=settings.planning.graph)
    graph, reasons = interpret_with_reasons(page, segmentation)
    write_durably(folder / "explain.json", json.dumps(as_json(graph, reasons())).encode())
    return graph


def _strokes(graph: LineGraph, page: PageImage, settings: Settings) -> Drawing:
    height_px, width_px = page.grey.shape
    as_in_paper = settings.planning.graph == "paper"
    drawing = strokes(graph, width_px=width_px, height_px=height_px, mode="paper" if as_in_paper else "fewest")
    return replace(drawing, strokes=(*drawing.strokes, *map(Stroke, page.hatching + page.fills * as_in_paper)))


def _layout(page: PageImage, settings: Settings, machine: Machine, *, sized: bool) -> Layout:
    """sized: as large as the picture says, where it does and the settings leave it open."""
    sheet = settings.sheet
    true_size = sheet.size == "true" or (sheet.size == "auto" and sized and page.px_per_mm is not None)
    corner_mm = box_origin_mm(sheet, machine)
    return Layout(sheet.box_mm, corner_mm, sheet.margin_mm, sheet.rotate, sheet.mirror, true_size)


def _toolpath(seen: Understood, settings: Settings, machine: Machine, *, sized: bool) -> Toolpath:
    sheet = settings.sheet
    # Only where lines were seen in pixels do these limit how exactly they are known.
    error_px = np.inf if seen.segmentation is None else _ERROR_PX * given_px(seen.page) / given_px(seen.readable)
    toolpath = plan_toolpath(
        seen.upright,
        layout=_layout(seen.page, settings, machine, sized=sized),
        precision=Precision(sheet.error_mm, error_px, machine.resolution_mm, _curve_mm(settings, machine)),
        start_mm=machine.park_mm,
        park_mm=machine.park_mm,
        reach_mm=reach_mm(machine),
        reach_low_mm=reach_low_mm(sheet, machine),
        rejoin=settings.planning.graph != "paper",
    )
    return replace(toolpath, pens=tuple(NamedPen(*pen) for pen in settings.pens.colours.items()))


def _curve_mm(settings: Settings, machine: Machine) -> float:
    """0 in the paper's own forms, which know no arcs."""
    paper_program = isinstance(machine, GrblMachine) and machine.dialect == "paper"
    return 0.0 if paper_program or settings.planning.graph == "paper" else settings.sheet.curve_tolerance_mm


def _fidelity_mm(readable: PageImage, drawn_mm: list[Points], from_px: Affine, width_px: float) -> Fidelity:
    """Of lines in machine mm, against the page that was put right, in its pixels before it was scaled."""
    back = invert(from_px)
    return fidelity(readable, [place(line, back) for line in drawn_mm], line_width_px=width_px)


def _strokes_json(drawing: Drawing) -> bytes:
    size = {"width_px": drawing.width_px, "height_px": drawing.height_px, "px_per_mm": drawing.px_per_mm}
    return json.dumps({**size, "strokes": [_rounded(stroke) for stroke in drawing.strokes]}).encode()


def _rounded(stroke: Stroke) -> list[list[float]]:
    rounded: list[list[float]] = np.round(stroke.points, 3).tolist()
    return rounded


def _peak_memory_mb() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
