"""A planner for the worker that understands no picture: zigzags that the picture's bytes choose, planned at once.

With it a kill finds the daemon, the worker and the machine at work every second or two: loading the network after each
kill takes longer than all the rest.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from pathlib import Path
from random import Random

import numpy as np

from daemon.config import Settings
from daemon.jobs.devices import program_of
from daemon.jobs.folder import write_durably
from daemon.jobs.sheet import box_origin_mm
from daemon.program.file import program_text
from daemon.shapes import Points, Stroke, Toolpath

_BAND_MM = 8.0


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
    progress("program")
    corner = np.array(box_origin_mm(settings.sheet, settings.machines[machine]))
    lines = zigzags(Random(hashlib.sha256(source.read_bytes()).hexdigest()))
    from_px = np.hstack([np.eye(2), corner[:, None]])
    toolpath = Toolpath(tuple(Stroke(line + corner) for line in lines), from_px, settings.machines[machine].park_mm)
    report = {"from_px": from_px.tolist(), "real_s": None}
    write_durably(folder / "strokes.json", json.dumps({"strokes": [line.tolist() for line in lines]}).encode())
    write_durably(folder / "report.json", json.dumps(report).encode())
    program = program_of(toolpath, settings.machines[machine], folder.name)
    write_durably(folder / "program.gcode", program_text(program).encode())
    planned()


def measure_ink(folder: Path, settings: Settings, machine: str) -> None:
    """Only asked for where the machine is simulated in the daemon itself."""


def zigzags(random: Random) -> list[Points]:
    """2 to 5 lines in mm, one above the other."""
    return [_zigzag(band, random) for band in range(random.randint(2, 5))]


def _zigzag(band: int, random: Random) -> Points:
    xs = sorted(random.sample(range(0, 40, 2), random.randint(3, 6)))
    return np.array([(x + random.random(), _BAND_MM * band + random.uniform(0, 5)) for x in xs])
