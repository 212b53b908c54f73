"""The pictures in a job's folder: preview.png, explain.png, drawing.svg, preview.html."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from daemon.config import Settings
from daemon.homography import through
from daemon.jobs.folder import number_of, write_all_durably
from daemon.jobs.sheet import box_origin_mm
from daemon.program.svg import write_svg
from daemon.report import canvas
from daemon.report.explain import explain
from daemon.report.preview import preview
from daemon.report.preview_html import PenLook, Told, preview_html
from daemon.shapes import Drawing, LineGraph, PageImage, Points, Program, Segmentation, Toolpath
from daemon.toolpath.place import invert, place


def write_pictures(
    folder: Path,
    settings: Settings,
    toolpath: Toolpath,
    about: Told,
    *,
    pages: tuple[PageImage, PageImage],
    understood: tuple[PageImage, Segmentation | None, LineGraph, Drawing],
) -> None:
    """about: what is known of it beside its page.

    pages: as it was given, and put right. understood: the page as it was read, and what came of it."""
    page = understood[0]
    told = replace(about, warnings=page.warnings, steps=[step.words for step in page.steps])
    told = replace(told, approve=_approval_of(folder, settings))
    told = replace(told, pens=[PenLook(*pen) for pen in toolpath.pens] or told.pens)
    (machine,) = settings.machines.values()
    box_mm, corner_mm = settings.sheet.box_mm, box_origin_mm(settings.sheet, machine)
    sheet = preview(toolpath, box_mm=box_mm, box_origin_mm=corner_mm, seconds=told.seconds)
    svg = write_svg(toolpath, size_mm=box_mm, corner_mm=corner_mm)
    lines = on_picture(toolpath, pages[1])
    html = preview_html(pages[0].grey, lines, toolpath, box_mm=box_mm, box_origin_mm=corner_mm, told=told)
    files = {"preview.png": canvas.png(sheet), "explain.png": canvas.png(explain(*understood, name=told.name))}
    write_all_durably(folder, files | {"drawing.svg": svg.encode(), "preview.html": html.encode()})


def on_picture(toolpath: Toolpath, readable: PageImage) -> list[Points]:
    """The strokes of a toolpath, each (N, 2) in px of the given picture. readable: the page that was put right."""
    back = invert(toolpath.from_px)
    return [through(readable.to_given, place(stroke.points, back)) for stroke in toolpath.strokes]


def strokes_s(program: Program, times_s: Sequence[float]) -> list[tuple[float, float]]:
    """For each stroke when the pen has travelled to it and when it is lifted again, in s; none where nobody knows.

    times_s: when each line of the program will have been drawn. The first line of a stroke is the travel to it.
    """
    found: dict[int, tuple[float, float]] = {}
    for line, end_s in zip(program.lines, times_s, strict=False):
        if line.stroke is not None:
            found[line.stroke] = (found.get(line.stroke, (end_s, end_s))[0], end_s)
    return [found[stroke] for stroke in sorted(found)]


def _approval_of(folder: Path, settings: Settings) -> str:
    """The order by which a person has the job in this folder drawn; "" where it is drawn without."""
    number = number_of(folder.name)
    return f"linedrawd approve {number}" if settings.intake.approve and number else ""
