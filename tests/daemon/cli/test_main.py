"""What a person types: what is done, what is said, and which exit code says how it went."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import daemon.jobs.pool
from daemon.cli.__main__ import main
from tests.daemon.jobs.test_pool import PLANNER


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Nobody's settings, and the second planner in place of the network."""
    monkeypatch.setenv("HOME", str(tmp_path))
    for name in ("XDG_CONFIG_HOME", "XDG_STATE_HOME", "XDG_RUNTIME_DIR", "STATE_DIRECTORY", "LOGS_DIRECTORY"):
        monkeypatch.delenv(name, raising=False)
    before = signal.getsignal(signal.SIGTERM)
    monkeypatch.setattr(daemon.jobs.pool, "PLANNER", PLANNER)
    yield tmp_path
    signal.signal(signal.SIGTERM, before)


def picture(folder: Path, text: str = "good", name: str = "house.png") -> str:
    (folder / name).write_text(text)
    return str(folder / name)


def state(folder: Path) -> list[str]:
    return ["--state-dir", str(folder / "state")]


def test_a_picture_is_drawn_now(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["draw", picture(home), "--device", "sim", *state(home)]) == 0
    assert capsys.readouterr().out == "000001-house: all 2 strokes are drawn\n"
    assert (home / "house.png").exists()
    assert (home / "state" / "jobs" / "000001-house" / "ink.json").exists()


def test_jobs_are_told_as_json(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main(["draw", picture(home, name='my "house" é.png'), "--device", "sim", *state(home)])
    main(["draw", picture(home, "bad", "bad.png"), "--device", "sim", *state(home)])
    capsys.readouterr()
    assert main(["jobs", "--json", *state(home)]) == 0
    drawn, failed = json.loads(capsys.readouterr().out)
    assert (drawn["id"], drawn["state"], drawn["strokes"]) == ("000001-my-house-e", "done", 2)
    assert drawn["name"].endswith('my "house" é.png')
    assert drawn["words"].startswith("all 2 strokes are drawn")
    assert drawn["real_s"] > 0
    assert (failed["state"], "strokes" in failed) == ("failed", False)


def test_jobs_lists_what_was_done_without_a_daemon(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main(["draw", picture(home, name='my "house" é.png'), "--device", "sim", *state(home)])
    main(["draw", picture(home, "bad", "bad.png"), "--device", "sim", *state(home)])
    capsys.readouterr()
    assert main(["jobs", *state(home)]) == 0
    first, second = capsys.readouterr().out.splitlines()
    assert first.split()[:2] == ["000001-my-house-e", "done"]
    assert r'"my \"house\" é.png"  all 2 strokes are drawn' in first
    assert second.split()[:2] == ["000002-bad", "failed"]
    assert second.endswith("bad.png  bad.png is no picture: drop another")


@pytest.mark.parametrize(
    ("text", "port", "code", "sentence"),
    [
        ("bad", "sim://grbl", 1, "house.png is no picture: drop another"),
        ("good", "/dev/does-not-exist", 3, "/dev/does-not-exist"),
        ("good", "sim://grbl?unplug=1", 4, "of 2 strokes"),
        ("good", "sim://grbl?nonsense=1", 2, "there is no option nonsense"),
        ("good", "usb", 2, "'usb' is no way to a machine"),
    ],
)
def test_a_drawing_that_fails_says_why_and_how(
    home: Path, capsys: pytest.CaptureFixture[str], text: str, port: str, code: int, sentence: str
) -> None:
    assert main(["draw", picture(home, text), "--device", "grbl", "--port", port, *state(home)]) == code
    assert sentence in capsys.readouterr().err


def test_a_picture_without_a_machine_is_not_drawn_later(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main(["draw", picture(home), "--device", "grbl", "--port", "/dev/does-not-exist", *state(home)])
    main(["draw", picture(home, name="other.png"), "--device", "sim", *state(home)])
    main(["jobs", *state(home)])
    assert [line.split()[1] for line in capsys.readouterr().out.splitlines()[1:]] == ["cancelled", "done"]


def test_a_picture_that_is_not_there_is_named(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["draw", str(home / "none.png"), "--device", "sim", *state(home)]) == 1
    assert "give the path of a picture" in capsys.readouterr().err


def test_pictures_are_planned_into_a_folder_each_and_some_may_fail(
    home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (home / "other").mkdir()
    pictures = [picture(home), picture(home, "bad", "bad.png"), str(home / "none.png"), picture(home / "other")]
    assert main(["plan", *pictures, "-o", str(home / "plans")]) == 1
    said = capsys.readouterr()
    assert [line.rpartition("/")[2] for line in said.out.splitlines()] == ["house", "house-2"]
    assert said.err.splitlines()[:2] == [
        f"{home}/house.png: warning: the ink is very faint",
        f"{home}/bad.png is no picture: drop another",
    ]
    assert "none.png: there is no such file" in said.err
    assert json.loads((home / "plans" / "house" / "strokes.json").read_text())["machine"] == "plotter"
    assert (home / "plans" / "house-2" / "program.gcode").exists()


def test_all_planned_is_success_and_leaves_no_state_folder(home: Path) -> None:
    assert main(["plan", picture(home), "-o", str(home / "plans")]) == 0
    assert {path.name for path in home.iterdir()} == {"house.png", "plans"}


@pytest.mark.parametrize("order", [["next"], ["stop"], ["go"], ["pause"], ["resume"], ["cancel", "1"]])
def test_an_order_without_a_daemon_fails_with_a_sentence(
    home: Path, capsys: pytest.CaptureFixture[str], order: list[str]
) -> None:
    assert main([*order, *state(home)]) == 1
    assert "no daemon answers" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ([], "no machine is set: give --device grbl"),
        (["--device", "emco"], "device emco is not found by itself: say its url"),
        (["--config", "/does/not/exist.toml", "--device", "sim"], "/does/not/exist.toml cannot be read"),
    ],
)
def test_wrong_settings_are_exit_code_2(
    capsys: pytest.CaptureFixture[str], arguments: list[str], sentence: str
) -> None:
    assert main(arguments) == 2
    assert sentence in capsys.readouterr().err


@pytest.mark.parametrize(
    "command",
    [
        "plan",
        "draw",
        "next",
        "stop",
        "go",
        "cancel",
        "pause",
        "resume",
        "machine",
        "status",
        "jobs",
        "models",
        "simulate",
    ],
)
def test_help_teaches_with_an_example(capsys: pytest.CaptureFixture[str], command: str) -> None:
    with pytest.raises(SystemExit) as left:
        main([command, "--help"])
    assert left.value.code == 0
    assert f"  linedrawd {command}" in capsys.readouterr().out


def test_the_shipped_network_is_shown_with_its_manifest(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["models"]) == 0
    said = capsys.readouterr().out
    assert "  labels: background, lines, corners\n" in said
    assert "  sha256: " in said


def test_the_daemon_runs_until_it_is_told_to_end_and_its_status_outlives_it(
    home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = [sys.executable, "-m", "daemon.cli", "--device", "sim", "-v", *state(home)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env=os.environ) as process:
        assert process.stderr is not None
        ready = next((line for line in process.stderr if "the machine is ready" in line), "")
        codes = [main(["stop", *state(home)]), main(["status", *state(home)])]
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=20)
    assert ready
    assert codes == [0, 0]
    assert f"pid            {process.pid}" in capsys.readouterr().out
    assert process.returncode == 0
    assert main(["status", *state(home)]) == 1
    said = capsys.readouterr().out
    assert "no daemon runs" in said
    assert "held           a person stopped the machine" in said


SIGNALLED = """
import os, sys
import daemon.jobs.pool
from daemon.cli.__main__ import main
from daemon.status import StatusBoard

change, sent = StatusBoard.change_machine, []

def change_and_signal(board, machine, **values):
    change(board, machine, **values)
    if values.get("percent") and not sent:
        sent.append(os.kill(os.getpid(), NUMBER))

StatusBoard.change_machine = change_and_signal
daemon.jobs.pool.PLANNER = PLANNER
sys.exit(main())
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_stops_a_drawing_with_the_pen_up(home: Path, number: signal.Signals) -> None:
    """It comes when the controller has taken the first line."""
    program = SIGNALLED.replace("NUMBER", str(int(number))).replace("= PLANNER", f"= {PLANNER!r}")
    arguments = ["draw", picture(home), "-v", "--port", "sim://grbl?speed=1", *state(home)]
    command = [sys.executable, "-c", program, *arguments]
    ran = subprocess.run(command, check=False, capture_output=True, text=True, timeout=30)
    assert ran.returncode == 1
    assert "state=cancelled" in ran.stderr
    assert "the pen is up" in ran.stderr
