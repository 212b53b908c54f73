"""A planner for the worker that understands no picture: strokes as wide as the box, or as the picture's text says."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from daemon.config import Settings
from daemon.jobs.devices import program_of
from daemon.jobs.sheet import box_origin_mm, reach_low_mm, reach_mm
from daemon.jobs.wishes import settings_for
from daemon.program.file import program_text
from daemon.shapes import Stroke, Toolpath
from daemon.toolpath.reach import check_reach


def plan_picture(
    source: Path,
    folder: Path,
    settings: Settings,
    machine: str,
    *,
    name: str,
    progress: Callable[[str], None],
    planned: Callable[[], None],
) -> None:
    settings = settings_for(folder, settings, machine)
    own, text = settings.machines[machine], source.read_text()
    left, bottom = box_origin_mm(settings.sheet, own)
    right = left + (float(text) if text.isdecimal() else settings.sheet.box_mm[0])
    strokes = tuple(Stroke(np.array([[left, bottom + up], [right, bottom + up]])) for up in (0.0, 4.0))
    low_mm = reach_low_mm(settings.sheet, own)
    check_reach(strokes, reach_mm=reach_mm(own), reach_low_mm=low_mm, park_mm=own.park_mm)
    toolpath = Toolpath(strokes, np.eye(2, 3), own.park_mm)
    (folder / "program.gcode").write_text(program_text(program_of(toolpath, own, folder.name)))
    planned()


def measure_ink(folder: Path, settings: Settings, machine: str) -> None:
    """Nobody asks how well it was drawn."""
