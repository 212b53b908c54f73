"""A planner for the worker that understands no picture: one drawing, in the language of whatever machine is set."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np

from daemon.config import Settings
from daemon.jobs.devices import program_of
from daemon.jobs.sheet import box_origin_mm
from daemon.program.file import program_text
from daemon.shapes import Stroke, Toolpath

_ANGLES = np.linspace(0, 2 * np.pi, 25)
STROKES_MM = (
    np.array([[2.0, 2.0], [40.0, 2.0], [40.0, 30.0]]),
    np.stack([20 + 10 * np.cos(_ANGLES), 15 + 10 * np.sin(_ANGLES)], axis=1),
    np.array([[50.0, 50.0], [5.5, 41.25]]),
)
"""In the box."""


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
    corner = np.array(box_origin_mm(settings.sheet, settings.machines[machine]))
    from_px = np.hstack([np.eye(2), corner[:, None]])
    toolpath = Toolpath(
        tuple(Stroke(points + corner) for points in STROKES_MM), from_px, settings.machines[machine].park_mm
    )
    strokes = {"strokes": [points.tolist() for points in STROKES_MM]}
    (folder / "strokes.json").write_text(json.dumps(strokes))
    (folder / "report.json").write_text(json.dumps({"from_px": from_px.tolist(), "real_s": None, "warnings": []}))
    (folder / "program.gcode").write_text(program_text(program_of(toolpath, settings.machines[machine], folder.name)))
    planned()


def measure_ink(folder: Path, settings: Settings, machine: str) -> None:
    """The test does."""
