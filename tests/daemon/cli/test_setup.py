"""`linedrawd setup`: questions, each an option as well; settings; frame and test card on a simulated machine."""

from __future__ import annotations

import io
import threading
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from daemon.cli import card, first_run
from daemon.cli.__main__ import main
from daemon.control import ControlServer
from firmware_protocol.grbl.simulator.simulator import GrblSimulator

QUICK = ["--no-frame", "--no-card"]
Run = Callable[..., int]


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("HOME", str(tmp_path))
    for name in ("XDG_CONFIG_HOME", "XDG_STATE_HOME", "XDG_RUNTIME_DIR"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(first_run, "adapters", tuple)
    return tmp_path / "linedrawd.toml"


@pytest.fixture
def setup(file: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    """Call it, with what a person types."""

    def call(*words: str, typed: str = "") -> int:
        monkeypatch.setattr("sys.stdin", io.StringIO(typed))
        return main(["setup", "--config", str(file), "--state-dir", str(file.parent / "state"), *words])

    return call


def written(file: Path) -> dict[str, Any]:
    return tomllib.loads(file.read_text())


def test_nothing_need_be_asked(file: Path, setup: Run, capsys: pytest.CaptureFixture[str]) -> None:
    assert setup("--device", "sim", "--paper", "A5", "--yes", *QUICK) == 0
    said = written(file)
    assert said["machines"]["plotter"]["url"] == "sim://grbl"
    assert said["sheet"] == {"box_mm": [118.0, 180.0], "box_origin_mm": [15.0, 15.0]}
    assert "linedrawd calibrate" in capsys.readouterr().out


def test_a_person_answers_one_question_after_the_other(file: Path, setup: Run) -> None:
    typed = "frbl\ngrbl\n/dev/ttyUSB3\nservo\n200\n800\nmuch\n300x200\nA4 landscape\nhomed\n-290x-190\n"
    assert setup(*QUICK, typed=typed) == 0
    said = written(file)["machines"]["plotter"]
    assert said == {
        "device": "grbl", "url": "serial:///dev/ttyUSB3", "reach_mm": [300.0, 200.0], "origin": "homed",
        "home": "start", "origin_mm": [-290.0, -190.0], "pen": {"kind": "servo", "up_s": 200.0, "down_s": 800.0},
    }  # fmt: skip
    assert written(file)["sheet"]["box_mm"] == [267.0, 180.0]


def test_each_question_is_an_option_as_well(file: Path, setup: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []
    monkeypatch.setattr(first_run, "_heard", lambda question: asked.append(question) or "")
    words = [
        "--device", "grbl", "--port", "sim://grbl", "--pen", "z", "--pen-up", "4", "--pen-down", "-1", "--reach",
        "100x100", "--paper", "90x90", "--origin", "homed", "--origin-mm=-95x-95", "--name", "left",
    ]  # fmt: skip
    assert setup(*words, *QUICK) == 0
    assert asked == []
    assert written(file)["machines"]["left"]["pen"] == {"kind": "z", "up_mm": 4.0, "down_mm": -1.0}
    assert written(file)["sheet"]["box_mm"] == [60.0, 60.0]


def test_a_file_that_is_there_is_changed_only_when_told_to(
    file: Path, setup: Run, capsys: pytest.CaptureFixture[str]
) -> None:
    before = '# mine\n[machines.left]\nurl = "auto"\ndraw_mm_s = 50\n\n[keep]\njobs_days = 3\n'
    file.write_text(before)
    assert setup("--device", "sim", "--yes", *QUICK) == 2
    assert setup("--device", "sim", *QUICK, typed="\n" * 20) == 2
    assert "--overwrite" in capsys.readouterr().err
    assert file.read_text() == before
    assert setup("--device", "sim", "--yes", "--overwrite", *QUICK) == 0
    said = written(file)
    assert (said["machines"]["left"]["draw_mm_s"], said["machines"]["left"]["url"]) == (50, "sim://grbl")
    assert (said["keep"], file.read_text().startswith("# mine\n")) == ({"jobs_days": 3}, True)
    assert file.with_name("linedrawd.toml.before").read_text() == before


def test_another_kind_of_machine_takes_over_nothing(file: Path, setup: Run) -> None:
    file.write_text('[machines.m]\ndevice = "grbl"\nmay_set = true\n[machines.m.pen]\nkind = "servo"\nup_s = 3\n')
    assert setup("--device", "dobot", "--port", "sim://dobot", "--yes", "--overwrite", *QUICK) == 0
    assert written(file)["machines"]["m"] == {
        "device": "dobot", "url": "sim://dobot", "pen": {"kind": "z", "up_mm": 10.0, "down_mm": 0.0},
    }  # fmt: skip


def test_a_second_machine_leaves_the_sheet_of_the_first_alone(file: Path, setup: Run) -> None:
    file.write_text('[machines.left]\nurl = "/dev/ttyUSB7"\n[sheet]\nbox_mm = [50, 50]\n')
    words = ["--device", "sim", "--name", "right", "--paper", "A5", "--yes", "--overwrite", *QUICK]
    assert setup(*words) == 0
    said = written(file)
    assert (said["sheet"], said["machines"]["right"]["box_mm"]) == ({"box_mm": [50, 50]}, [118.0, 180.0])


def test_settings_that_contradict_each_other_leave_the_file_as_it_was(file: Path, setup: Run) -> None:
    file.write_text("[machines.m]\n")
    words = ["--device", "sim", "--pen-up", "0", "--pen-down", "3", "--yes", "--overwrite", *QUICK]
    assert setup(*words) == 2
    assert file.read_text() == "[machines.m]\n"
    assert [path.name for path in file.parent.iterdir()] == [file.name]


def test_a_sheet_without_room_is_refused(file: Path, setup: Run) -> None:
    assert setup("--device", "sim", "--paper", "30x200", "--yes", *QUICK) == 2
    assert not file.exists()


def test_the_frame_is_gone_around_with_the_pen_up_and_the_card_is_drawn(
    file: Path, setup: Run, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    lines: list[bytes] = []
    receive = GrblSimulator.receive
    monkeypatch.setattr(
        GrblSimulator, "receive", lambda self, data, now: (lines.append(data), receive(self, data, now))
    )
    assert setup("--device", "sim", "--paper", "100x100", "--yes", "--no-card") == 0
    around = b"".join(lines)
    assert b"X85.000 Y85.000" in around
    assert b"Z0" not in around
    assert setup("--device", "sim", "--paper", "100x100", "--yes", "--overwrite", "--no-frame") == 0
    assert b"Z0.000" in b"".join(lines)
    assert "the test card is drawn" in capsys.readouterr().out


def test_a_frame_beside_the_sheet_ends_it_before_the_card(
    file: Path, setup: Run, capsys: pytest.CaptureFixture[str]
) -> None:
    typed = "\n" * 5 + "y\nn\n"
    assert setup("--device", "sim", "--paper", "100x100", typed=typed) == 1
    said = capsys.readouterr().out
    assert "move the sheet" in said
    assert "the test card" not in said


def test_the_machine_of_a_running_daemon_is_left_to_it(
    file: Path, setup: Run, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(card, "opened", None)
    socket = file.parent / "state" / "run" / "control.sock"
    socket.parent.mkdir(parents=True)
    server = ControlServer(socket, lambda order: "linedrawd runs")
    thread = threading.Thread(target=server.run)
    thread.start()
    try:
        assert setup("--device", "sim", "--yes") == 3
    finally:
        server.stop()
        thread.join()
    assert "sudo systemctl stop linedrawd" in capsys.readouterr().err
