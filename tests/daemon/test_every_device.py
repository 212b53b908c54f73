"""Every device draws a picture through the daemon, on its simulated counterpart; its ink is what was planned."""

from __future__ import annotations

import json
import shutil
from itertools import pairwise
from pathlib import Path
from threading import Event
from typing import Any

import numpy as np
import pytest

from daemon.config import Settings
from daemon.jobs.journal import Job
from daemon.jobs.states import State
from daemon.shapes import Points
from daemon.toolpath.place import place
from tests.daemon.test_service import Daemon, ended, loaded, running

HOUSE = Path(__file__).parents[1] / "drawings" / "house.png"
PLANNED = "tests.daemon.planned"

HOMED = """
url = "sim://grbl?22=1&23=3&130=300&131=300&132=50&switches=-300:-300:0"
pen = {up_mm = -7, down_mm = -12}
home = "job"
origin_mm = [-290, -290]
reach_mm = [300, 300]
"""


def settings_of(root: Path, text: str, **options: str) -> Settings:
    return loaded(root, f"[machines.left]\n{text}\n", **options)


def between(line: Points, step_mm: float = 0.2) -> Points:
    """The line's points and enough others to leave no gap."""
    parts = [np.linspace(a, b, max(2, int(np.hypot(*(b - a)) / step_mm) + 2)) for a, b in pairwise(line)]
    return np.concatenate([line[:1], *parts])


def farthest_mm(lines: list[Points], others: list[Points]) -> float:
    """How far a point of the lines lies from the nearest of the others."""
    points, near = (np.concatenate([between(line) for line in each]) for each in (lines, others))
    return max(float(np.hypot(*(near - point).T).min()) for point in points)


def drawn(daemon: Daemon) -> Job:
    shutil.copyfile(HOUSE, daemon.settings.paths.inbox / "house.png")
    (job,) = daemon.wait_for(ended, within_s=180.0)
    assert job.state is State.DONE, job.words
    return job


def check_ink(folder: Path) -> dict[str, Any]:
    """Dots left out: a pen that stands on the sheet when its machine is switched on makes one."""
    ink = [np.array(line, float) for line in json.loads((folder / "ink.json").read_text())["strokes"] if len(line) > 1]
    report: dict[str, Any] = json.loads((folder / "report.json").read_text())
    strokes = json.loads((folder / "strokes.json").read_text())["strokes"]
    planned = [place(np.array(line, float), np.array(report["from_px"])) for line in strokes]
    assert len(ink) == len(planned) > 0
    assert farthest_mm(ink, planned) < 0.15
    assert farthest_mm(planned, ink) < 0.15
    return report


@pytest.mark.parametrize("device", ["grbl", "emco", "dobot"])
def test_a_picture_is_understood_and_drawn_by(device: str, tmp_path: Path) -> None:
    settings = settings_of(tmp_path, "", device=device, port=f"sim://{device}")
    with running(settings, planner=None) as daemon:
        report = check_ink(daemon.folder(drawn(daemon)))
    assert report["fidelity_of"] == "executed"
    assert report["fidelity"]["f1"] > 0.98


@pytest.mark.parametrize(
    "text",
    [
        "dry_run = true\nmay_set = true\nurl = 'sim://grbl?10=1'\npen = {kind = 'servo', down_s = 700}",
        HOMED,
        "device = 'emco'\nurl = 'sim://emco'\ndialect = 'fanuc'\nlink = 'blocks'\npreset = '8N1'",
        "device = 'emco'\nurl = 'sim://emco?buffer=1024'\nlink = 'blocks'\nack = 'ok'\nnak = 'again'",
        "device = 'emco'\nurl = 'sim://emco?start_s=30'\nbaud = 300",
        "device = 'dobot'\nurl = 'sim://dobot'\nstraight = 'PTP'",
        "device = 'dobot'\nurl = 'sim://dobot?first_index=2&left_bytes=8'\nhome = 'job'\nsheet_origin_mm = [195, -60]",
    ],
)
def test_a_drawing_is_drawn_with_these_settings(text: str, tmp_path: Path) -> None:
    with running(settings_of(tmp_path, text), planner=PLANNED) as daemon:
        check_ink(daemon.folder(drawn(daemon)))


def test_an_emco_behind_a_folder_gets_a_whole_program_and_its_end_is_an_estimate(tmp_path: Path) -> None:
    (tmp_path / "share").mkdir()
    text = f"device = 'emco'\ndialect = 'fanuc'\nurl = 'file://{tmp_path}/share'"
    with running(settings_of(tmp_path, text), planner=PLANNED) as daemon:
        station, sent = daemon.parts.desk.stations["left"], Event()
        show = station.show

        def show_and_tell(**values: object) -> None:
            show(**values)
            if str(values.get("words")).startswith("everything has been sent"):
                sent.set()

        station.show = show_and_tell
        (daemon.settings.paths.inbox / "house.png").write_text("a picture")
        assert sent.wait(20)
        (file,) = (tmp_path / "share").iterdir()
        lines = file.read_text().splitlines()
        daemon.order("stop")
        (job,) = daemon.wait_for(ended)
    assert (file.name, lines[:2], lines[-2:]) == ("O0001.NC", ["%", "O0001"], ["M30", "%"])
    assert "feed hold and RESET" in job.words
    assert list((tmp_path / "share").iterdir()) == []
