"""The settings of a crooked machine reach its program, and nothing else of a job."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

from daemon.config import GrblMachine, Options, Sheet, load_settings
from daemon.errors import OutOfReach
from daemon.jobs.correction import told
from daemon.jobs.planner import plan_picture
from daemon.shapes import Stroke, Toolpath

STAR = Path(__file__).parents[2] / "drawings" / "star.png"
LINE = Toolpath((Stroke(np.array([[10.0, 10.0], [90.0, 10.0]])),), np.eye(2, 3))


def planned(folder: Path, machine: str) -> tuple[float, str]:
    """How wide the program draws, in mm, and the drawing as people see it."""
    (folder / "job").mkdir(parents=True)
    (folder / "s.toml").write_text(f'[machines.m]\nurl = "sim://grbl"\n{machine}')
    settings = load_settings(Options(config=folder / "s.toml", state_dir=folder), environment={"HOME": str(folder)})
    plan_picture(STAR, folder / "job", settings, "m")
    program = (folder / "job" / "program.gcode").read_text()
    xs = [float(x) for x in re.findall(r"G[0-3] X(-?[\d.]+)", program)][:-1]
    return max(xs) - min(xs), (folder / "job" / "drawing.svg").read_text()


def test_a_machine_that_draws_too_long_is_told_less(tmp_path: Path) -> None:
    width_mm, picture = planned(tmp_path / "true", "")
    told_mm, same_picture = planned(tmp_path / "long", "scale_x = 1.25\n")
    assert told_mm == pytest.approx(width_mm / 1.25, abs=0.3)
    assert same_picture == picture
    assert "fidelity" in json.loads((tmp_path / "long" / "job" / "report.json").read_text())


def test_a_true_machine_is_told_the_toolpath_itself() -> None:
    assert told(LINE, Sheet(), GrblMachine()) is LINE


def test_a_correction_that_leads_out_of_reach_is_refused() -> None:
    machine = GrblMachine(scale_x=0.9, reach_mm=(95.0, 95.0))
    assert told(LINE, Sheet(), machine.model_copy(update={"scale_x": 0.96})).strokes[0].points[1][0] < 95
    with pytest.raises(OutOfReach):
        told(LINE, Sheet(), machine)


def test_a_homed_machine_is_corrected_about_the_sheets_corner() -> None:
    machine = GrblMachine(origin="homed", origin_mm=(10.0, 10.0), scale_x=0.8)
    assert told(LINE, Sheet(), machine).strokes[0].points.tolist() == [[10.0, 10.0], [pytest.approx(110.0), 10.0]]
