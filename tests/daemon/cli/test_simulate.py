"""`linedrawd simulate grbl`: started by a command line, ended by a signal, its ink in a file."""

from __future__ import annotations

import argparse
import json
import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from daemon.cli import simulate
from daemon.cli.__main__ import main
from daemon.errors import DiskTrouble, MachineFault, SettingsError
from daemon.machine.pseudo_terminal import serve
from firmware_protocol.grbl.simulator.events import SENTENCES
from firmware_protocol.grbl.simulator.simulator import GrblSimulator


def parse(*arguments: str, machine: str = "grbl") -> argparse.Namespace:
    parser = argparse.ArgumentParser()
    simulate.add_parser(parser.add_subparsers())
    return parser.parse_args(["simulate", machine, *arguments])


def stop_when(link: Path) -> None:
    """Send ourselves SIGTERM as soon as the pseudo terminal is there."""

    def wait() -> None:
        pause = threading.Event()
        while not link.is_symlink():
            pause.wait(0.005)
        os.kill(os.getpid(), signal.SIGTERM)

    threading.Thread(target=wait, daemon=True).start()


@pytest.mark.parametrize("machine", ["grbl", "emco", "dobot"])
def test_sigterm_ends_it_cleanly_and_the_ink_is_written(machine: str, tmp_path: Path) -> None:
    link, ink = tmp_path / "grbl", tmp_path / "ink.json"
    before = signal.getsignal(signal.SIGTERM)
    stop_when(link)
    assert simulate.run(parse("--pty", str(link), "--ink", str(ink), machine=machine)) == 0
    assert json.loads(ink.read_text())["polylines_mm"] == []
    assert not link.is_symlink()
    assert signal.getsignal(signal.SIGTERM) is before


def test_ink_that_cannot_be_written_is_said(tmp_path: Path) -> None:
    link = tmp_path / "grbl"
    stop_when(link)
    with pytest.raises(DiskTrouble, match="choose another place"):
        simulate.run(parse("--pty", str(link), "--ink", str(tmp_path / "none" / "ink.json")))


@pytest.mark.parametrize(
    ("machine", "url", "why"),
    [
        ("grbl", "sim://grbl?sped=1", "no option sped"),
        ("emco", "sim://emco?sped=1", "sped.*: write for example dialect=fanuc"),
        ("dobot", "sim://dobot?sped=1", "sped.*: write for example depth=32"),
        ("dobot", "sim://grbl", "no simulated dobot: write sim://dobot"),
    ],
)
def test_a_machine_that_cannot_be_understood_is_refused(machine: str, url: str, why: str, tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match=why):
        simulate.run(parse("--pty", str(tmp_path / machine), "--url", url, machine=machine))


def test_help_teaches_with_an_example(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        parse("--help")
    assert "linedrawd simulate grbl --pty /tmp/plotter" in capsys.readouterr().out


def test_an_event_is_told_in_words_with_or_without_quotes(tmp_path: Path) -> None:
    link = tmp_path / "grbl"
    stop_fd, stop = os.pipe()
    simulator = GrblSimulator()
    thread = threading.Thread(target=serve, args=(simulator, link), kwargs={"stop_fd": stop_fd})
    thread.start()
    try:
        pause = threading.Event()
        while not link.is_symlink():
            pause.wait(0.005)
        assert main(["simulate", "ctl", str(link), "unplug"]) == 0
        assert simulator.unplugged
        assert main(["simulate", "ctl", str(link), "plug", "in"]) == 0
        assert not simulator.unplugged
        assert main(["simulate", "ctl", str(link), "switch x closes at -4.000 mm"]) == 0
        assert main(["simulate", "ctl", str(link), "explode"]) == MachineFault.exit_code
        assert main(["simulate", "ctl", str(link), f"ink to {tmp_path / 'ink.json'}"]) == 0
        assert json.loads((tmp_path / "ink.json").read_text()) == {"polylines_mm": [], "pen_mm": [0, 0, 0]}
        assert (
            main(["simulate", "ctl", str(link), f"ink to {tmp_path / 'none' / 'ink.json'}"]) == MachineFault.exit_code
        )
    finally:
        os.write(stop, b"!")
        thread.join(5)
        os.close(stop)
        os.close(stop_fd)


def test_the_event_command_loads_no_settings_and_no_arrays() -> None:
    program = (
        "import sys; from daemon.cli.__main__ import main; main(['simulate', 'ctl', '/nowhere/grbl', 'hang']); "
        "print({'pydantic', 'serial', 'numpy', 'daemon.service'} & set(sys.modules))"
    )
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert found.stdout == "set()\n"
    assert "no simulated machine listens beside /nowhere/grbl" in found.stderr


def test_the_help_of_an_event_names_all_events(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["simulate", "ctl", "--help"])
    told = " ".join(capsys.readouterr().out.split())
    plain = {"slow usb T ms": "slow usb 16 ms", "flip byte [N] [bits B]": "flip byte [N] [bits 0x01]"}
    assert [sentence for sentence in SENTENCES if plain.get(sentence, sentence) not in told] == []
