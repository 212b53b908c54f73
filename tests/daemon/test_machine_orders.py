"""Orders for the machine, through the control socket of the running daemon and without one."""

from __future__ import annotations

import json
from pathlib import Path
from threading import Thread

import pytest

from daemon.cli.__main__ import main
from daemon.control import Order, give_order
from daemon.errors import LinedrawError
from tests.daemon.test_service import Daemon, ended, running, settings_of


def order(daemon: Daemon, name: str, **figures: float) -> str:
    return give_order(daemon.settings.paths.control, Order.model_validate({"order": name, **figures}))


def test_an_origin_that_was_jogged_to_is_kept_by_the_daemon(tmp_path: Path) -> None:
    with running(settings_of(tmp_path)) as daemon:
        assert order(daemon, "jog", x_mm=30, y_mm=20) == "the pen has moved by 30, 20 mm"
        assert order(daemon, "origin").startswith("the sheet's corner lies where the pen stands")
        assert "pen at: X30.000 Y20.000" in order(daemon, "check")
        daemon.drop("a.png")
        (job,) = daemon.wait_for(ended)
        ink = json.loads((daemon.folder(job) / "ink.json").read_text())["strokes"]
        assert order(daemon, "park") == "the pen is parked"
        assert "pen at: X30.000 Y20.000" in order(daemon, "check")
    assert next(line for line in ink if len(line) > 1) == [pytest.approx([1, 1]), pytest.approx([9, 1])]


def test_the_frame_of_the_box_is_travelled_where_nothing_is_planned(tmp_path: Path) -> None:
    with running(settings_of(tmp_path)) as daemon:
        assert order(daemon, "frame").endswith("x 25.0 to 89.0, y 25.0 to 89.0 mm")


def test_stop_is_heard_while_the_machine_obeys_an_order(tmp_path: Path) -> None:
    with running(settings_of(tmp_path, port="sim://grbl?speed=1")) as daemon:
        said: list[str] = []

        def lower() -> None:
            with pytest.raises(LinedrawError) as stopped:
                order(daemon, "pen down", seconds=300.0)
            said.append(str(stopped.value))

        check = order(daemon, "check")
        lowering = Thread(target=lower)
        lowering.start()
        while lowering.is_alive():
            order(daemon, "stop")
            lowering.join(0.2)
    assert "firmware: Grbl 1.1h" in check
    assert said[0].startswith("stopped on request")


def test_where_no_daemon_runs_the_port_is_opened_for_the_order(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    options = ["--device", "sim", "--state-dir", str(tmp_path / "state")]
    assert main(["machine", "check", *options]) == 0
    assert "firmware: Grbl 1.1h.20190825" in capsys.readouterr().out
    assert main(["machine", "jog", "3", "-4", *options]) == 0
    assert capsys.readouterr().out == "the pen has moved by 3, -4 mm\n"
    assert main(["machine", "pen", "down", "--seconds", "1", *options]) == 0
    assert main(["machine", "origin", *options]) == 1
    assert "start linedrawd first" in capsys.readouterr().err
    assert main(["machine", "home", *options]) == 1
    assert "say home = 'start'" in capsys.readouterr().err
    assert main(["machine", "jog", "1e9", "0", *options]) == 1
    assert main(["machine", "check", "--state-dir", str(tmp_path / "state")]) == 2
    assert "no machine is set" in capsys.readouterr().err


def test_the_feed_of_a_running_drawing_is_overridden_from_the_command_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["machine", "feed", "80", "--state-dir", str(tmp_path / "state")]
    with running(settings_of(tmp_path, port="sim://grbl?speed=1")) as daemon:
        assert main(command) != 0
        daemon.drop("a.png")
        while not daemon.parts.board.now.strokes_total:
            daemon.parts.desk.wait(0.02)
        assert main(command) == 0
        assert daemon.parts.board.now.feed_percent == 80
        daemon.order("stop")
        while daemon.parts.board.now.strokes_total:
            daemon.parts.desk.wait(0.02)
        assert daemon.parts.board.now.feed_percent == 100
    said = capsys.readouterr()
    assert "nothing is being drawn" in said.err
    assert "the rest of this drawing is drawn at 80 % of its speed" in said.out


def test_a_feed_needs_a_daemon_and_a_percentage_that_a_controller_takes(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for percent, why in (("80", "no daemon runs"), ("9", "say 10 to 200"), ("201", "say 10 to 200")):
        assert main(["machine", "feed", percent, "--state-dir", str(tmp_path)]) != 0
        assert why in capsys.readouterr().err
