"""`linedrawd simulate grbl`: started by a command line, ended by a signal, its ink in a file."""

from __future__ import annotations

import argparse
import json
import os
import signal
import threading
from pathlib import Path

import pytest

from daemon.cli import simulate
from daemon.errors import DiskTrouble, SettingsError


def parse(*arguments: str) -> argparse.Namespace:
    parser = argparse.ArgumentParser()
    simulate.add_parser(parser.add_subparsers())
    return parser.parse_args(["simulate", "grbl", *arguments])


def stop_when(link: Path) -> None:
    """Send ourselves SIGTERM as soon as the pseudo terminal is there."""

    def wait() -> None:
        pause = threading.Event()
        while not link.is_symlink():
            pause.wait(0.005)
        os.kill(os.getpid(), signal.SIGTERM)

    threading.Thread(target=wait, daemon=True).start()


def test_sigterm_ends_it_cleanly_and_the_ink_is_written(tmp_path: Path) -> None:
    link, ink = tmp_path / "grbl", tmp_path / "ink.json"
    before = signal.getsignal(signal.SIGTERM)
    stop_when(link)
    assert simulate.run(parse("--pty", str(link), "--ink", str(ink))) == 0
    assert json.loads(ink.read_text()) == {"polylines_mm": []}
    assert not link.is_symlink()
    assert signal.getsignal(signal.SIGTERM) is before


def test_ink_that_cannot_be_written_is_said(tmp_path: Path) -> None:
    link = tmp_path / "grbl"
    stop_when(link)
    with pytest.raises(DiskTrouble, match="choose another place"):
        simulate.run(parse("--pty", str(link), "--ink", str(tmp_path / "none" / "ink.json")))


def test_a_machine_that_cannot_be_understood_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match="no option sped"):
        simulate.run(parse("--pty", str(tmp_path / "grbl"), "--url", "sim://grbl?sped=1"))


def test_help_teaches_with_an_example(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        parse("--help")
    assert "linedrawd simulate grbl --pty /tmp/plotter" in capsys.readouterr().out
