"""`linedrawd doctor`: it looks, says what to do, and leaves machine and daemon alone."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from daemon.cli import doctor
from daemon.cli.__main__ import main
from daemon.control import ControlServer, Order
from daemon.errors import LinedrawError
from firmware_protocol.grbl.simulator.simulator import GrblSimulator

Obey = Callable[[Order], str]


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Nobody's settings, and no daemon of the service."""
    monkeypatch.setenv("HOME", str(tmp_path))
    for name in ("XDG_CONFIG_HOME", "XDG_STATE_HOME", "XDG_RUNTIME_DIR", "STATE_DIRECTORY", "RUNTIME_DIRECTORY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(doctor, "_SERVICE", tmp_path / "service.sock")
    monkeypatch.setattr(doctor.usb, "look", list)
    return tmp_path


@contextmanager
def answering(path: Path, obey: Obey) -> Iterator[None]:
    """A daemon's control socket."""
    path.parent.mkdir(parents=True, exist_ok=True)
    server = ControlServer(path, obey)
    thread = threading.Thread(target=server.run)
    thread.start()
    try:
        yield
    finally:
        server.stop()
        thread.join()


def told(capsys: pytest.CaptureFixture[str]) -> dict[str, tuple[str, str]]:
    """State and words by name; of several with one name the last."""
    return {each["name"]: (each["state"], each["words"]) for each in json.loads(capsys.readouterr().out)}


def asked(home: Path, *words: str) -> int:
    return main(["doctor", "--json", "--state-dir", str(home / "state"), *words])


def test_a_simulated_machine_is_well(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert asked(home, "--device", "sim") == 0
    found = told(capsys)
    assert {"settings", "state", "inbox", "disk", "clock", "memory", "network", "scanner", "daemon"} <= found.keys()
    assert found["plotter answers"] == ("ok", "Grbl 1.1h.20190825, pen at X0.000 Y0.000 Z0.000 mm")
    assert found["plotter limits"][0] == "ok"
    assert list(home.iterdir()) == []


def test_nothing_moves_on_a_machine_that_homes_at_its_start(
    home: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    heard: list[bytes] = []
    receive = GrblSimulator.receive
    monkeypatch.setattr(
        GrblSimulator, "receive", lambda self, data, now: (heard.append(data), receive(self, data, now))
    )
    (home / "s.toml").write_text('[machines.m]\nurl = "sim://grbl?22=1&switches=0:0:0"\nhome = "start"\n')
    assert asked(home, "--config", str(home / "s.toml")) == 0
    said = b"".join(heard)
    assert "locked until linedrawd homes it" in told(capsys)["m answers"][1]
    assert b"?" in said
    assert not any(word in said for word in (b"$H", b"G0", b"G1", b"$J"))


def test_wrong_settings_are_said_and_the_rest_is_looked_at(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (home / "s.toml").write_text("[sheet]\nbocks_mm = 3\n")
    assert asked(home, "--config", str(home / "s.toml")) == 1
    found = told(capsys)
    assert found["settings"][0] == "wrong"
    assert "did you mean box_mm" in found["settings"][1]
    assert "memory" in found


def test_a_machine_that_does_not_answer_is_wrong(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert asked(home, "--device", "grbl", "--port", str(home / "ttyUSB0")) == 1
    found = told(capsys)
    assert found["plotter port"][0] == "wrong"
    assert found["plotter answers"][0] == "wrong"


@pytest.mark.parametrize(
    ("machine", "sheet"),
    [
        ('url = "sim://grbl"', "box_mm = [190, 100]"),
        ('device = "dobot"\nurl = "sim://dobot"', "box_mm = [300, 300]"),
    ],
)
def test_a_box_beyond_the_reach_is_wrong(
    home: Path, capsys: pytest.CaptureFixture[str], machine: str, sheet: str
) -> None:
    (home / "s.toml").write_text(f"[machines.m]\n{machine}\n[sheet]\n{sheet}\n")
    assert asked(home, "--config", str(home / "s.toml")) == 1
    assert told(capsys)["m limits"][0] == "wrong"


def test_a_scanner_that_is_set_and_not_there_is_wrong(
    home: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(home))
    assert asked(home, "--device", "sim", "--scanner", "sane") == 1
    assert told(capsys)["scanner"][0] == "wrong"


def test_the_running_daemon_is_asked_and_its_port_left_alone(
    home: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(doctor, "opened", None)
    orders: list[str] = []

    def obey(order: Order) -> str:
        orders.append(order.order)
        return "port: /dev/ttyUSB7\nfirmware: Grbl 1.1h\n$130=10\n$131=200" if order.order == "check" else "it runs"

    with answering(home / "state" / "run" / "control.sock", obey):
        assert asked(home, "--device", "grbl") == 1
    found = told(capsys)
    assert orders == ["ping", "check"]
    assert found["plotter answers"][0] == "ok"
    assert found["plotter limits"][1].startswith("X goes 10 mm by its $130")


def test_a_machine_that_draws_is_not_asked(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = home / "state" / "run"
    run.mkdir(parents=True)
    (run / "status.json").write_text(json.dumps({"machines": {"plotter": {"job": "000001-house"}}}))
    with answering(run / "control.sock", _only_ping):
        assert asked(home, "--device", "grbl") == 0
    assert "it draws 000001-house" in told(capsys)["plotter answers"][1]


def _only_ping(order: Order) -> str:
    if order.order != "ping":
        raise LinedrawError("it draws")
    return "linedrawd runs"


def test_a_daemon_of_the_service_beside_this_one_is_told(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with answering(home / "service.sock", lambda order: "linedrawd runs"):
        assert asked(home, "--device", "sim") == 1
    assert "sudo systemctl stop linedrawd" in told(capsys)["daemon"][1]


def test_a_person_reads_a_line_each(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["doctor", "--state-dir", str(home / "state"), "--device", "sim"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert all(line.startswith(("ok ", "better ")) for line in lines)
    assert lines[0].startswith("ok     settings         no file")
