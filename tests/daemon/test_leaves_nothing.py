"""A real run, network included, leaves files in its own folders and nowhere else."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import daemon

ROOT = Path(daemon.__file__).parent.parent
PICTURE = ROOT / "tests" / "drawings" / "star.png"


def run_until_drawn(state_dir: Path, *, home: Path, temporary: Path, here: Path) -> str:
    """The daemon on what lies in its inbox, until one job is done or anything goes wrong; returns what it said last."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("XDG_", "ORT_"))}
    environment = kept | {"HOME": str(home), "TMPDIR": str(temporary), "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-m", "daemon.cli", "--device", "sim", "-v", "--state-dir", str(state_dir)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, cwd=here, env=environment) as process:
        assert process.stderr is not None
        said = next((line for line in process.stderr if "state=done" in line or " ERROR " in line), "nothing")
        process.terminate()
        process.stderr.read()
    assert process.returncode == 0
    return said


def test_a_run_leaves_no_file_outside_its_folders(tmp_path: Path) -> None:
    state_dir = tmp_path / "state"
    home, temporary, here = (tmp_path / name for name in ("home", "tmp", "here"))
    for folder in (home, temporary, here, state_dir / "inbox"):
        folder.mkdir(parents=True)
    (state_dir / "inbox" / PICTURE.name).write_bytes(PICTURE.read_bytes())
    assert "all 5 strokes are drawn" in run_until_drawn(state_dir, home=home, temporary=temporary, here=here)
    assert [path for folder in (home, temporary, here) for path in folder.rglob("*")] == []
    left = {path.relative_to(state_dir).as_posix() for path in state_dir.rglob("*")}
    assert {path for path in left if not path.startswith("jobs/000001-star/")} == {
        "inbox", "jobs", "jobs/000001-star", "journal.sqlite", "lock", "log", "log/linedrawd.log", "pen-plotter.json",
        "run", "run/status.json",
    }  # fmt: skip
    assert {path.rpartition("/")[2] for path in left if path.startswith("jobs/000001-star/")} == {
        "source.png", "strokes.json", "drawing.svg", "program.gcode", "preview.png", "preview.html", "explain.png",
        "report.json", "arrival.json", "job.json", "job.log", "ink.json",
    }  # fmt: skip
