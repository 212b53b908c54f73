"""`linedrawd report JOB`: a zip with what there is about a job."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path

import pytest

from daemon.cli import doctor
from daemon.cli.__main__ import main


@pytest.fixture
def state(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A state folder with two jobs; this is also where the command is called."""
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.delenv("XDG_CONFIG_HOME", raising=False)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(doctor, "_SERVICE", tmp_path / "service.sock")
    # Whoever opened the port would reset a controller that may stand in the middle of a drawing.
    monkeypatch.setattr(doctor, "opened", None)
    job = tmp_path / "state" / "jobs" / "000012-house"
    for folder in (job, job.with_name("000013-cat"), tmp_path / "state" / "log"):
        folder.mkdir(parents=True)
    for name in ("source.png", "preview.png", "program.gcode", "job.log", "job.json", "report.json"):
        (job / name).write_text(name)
    (tmp_path / "state" / "log" / "linedrawd.log").write_text("started url=tcp://me:hunter2@plotter:23\n")
    (job / "job.log").write_text("the machine is ready port=tcp://me:hunter2@plotter:23\n")
    (job / "job.json").write_text('{"words": "no machine at tcp://me:hunter2@plotter:23"}')
    (tmp_path / "s.toml").write_text('[machines.m]\nurl = "tcp://me:hunter2@plotter:23"\n')
    (tmp_path / "plotter.txt").write_text('0.0 open {"machine": {"url": "tcp://me:hunter2@plotter:23"}}\n')
    return tmp_path


def bundle_of(state: Path, *words: str) -> dict[str, bytes]:
    assert main(["report", "12", "--state-dir", str(state / "state"), "--config", str(state / "s.toml"), *words]) == 0
    with zipfile.ZipFile(state / "linedrawd-report-000012-house.zip") as read:
        return {name: read.read(name) for name in read.namelist()}


def test_everything_about_the_job_is_in_it_and_told(state: Path, capsys: pytest.CaptureFixture[str]) -> None:
    parts = bundle_of(state, "--recording", str(state / "plotter.txt"))
    assert parts.keys() == {
        "about.txt", "settings.toml", "doctor.txt", "linedrawd.log", "recording.txt", "000012-house/source.png",
        "000012-house/preview.png", "000012-house/program.gcode", "000012-house/job.log", "000012-house/job.json",
        "000012-house/report.json",
    }  # fmt: skip
    said = capsys.readouterr().out
    assert all(name in said for name in parts)
    assert "Look into it before you send it" in said
    assert b"onnxruntime 1" in parts["about.txt"]
    assert b"ok     memory" in parts["doctor.txt"]


@pytest.mark.parametrize(("name", "there"), [("plotter.txt", True), ("gone.txt", False), ("", False)])
def test_the_recording_that_the_daemon_writes_is_in_it(state: Path, name: str, there: bool) -> None:
    (state / "state" / "run").mkdir()
    recording = str(state / name) if name else ""
    (state / "state" / "run" / "status.json").write_text(json.dumps({"recording": recording}))
    assert ("recording.txt" in bundle_of(state)) is there
    (state / "linedrawd-report-000012-house.zip").unlink()
    assert "recording.txt" not in bundle_of(state, "--without-picture")


def test_no_secret_is_in_it(state: Path) -> None:
    assert not any(b"hunter2" in part for part in bundle_of(state, "--recording", str(state / "plotter.txt")).values())


def test_the_picture_may_be_left_out(state: Path) -> None:
    names = {name.rpartition("/")[2] for name in bundle_of(state, "--without-picture")}
    assert names.isdisjoint({"source.png", "preview.png", "program.gcode"})
    assert {"job.log", "job.json", "report.json"} <= names


def test_a_job_that_there_is_not_is_refused(state: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["report", "14", "--state-dir", str(state / "state")]) == 1
    assert "`linedrawd jobs` lists them" in capsys.readouterr().err
    assert list(state.glob("*.zip")) == []
