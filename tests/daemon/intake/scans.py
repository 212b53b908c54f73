"""A scanner whose scanimage is a small program of ours."""

from __future__ import annotations

import json
import os
import sys
import threading
from pathlib import Path
from typing import Any

import pytest

from daemon.intake.scanimage import Scanimage
from daemon.intake.scanner import Scanner, Wanted
from tests.daemon.intake.files import tiff

PAGE = tiff(2, 2, bytes([0, 255, 255, 0]), order=">", more={282: (5, [300, 1]), 283: (5, [300, 1]), 296: (3, [2])})
ANY = Wanted()
_PROGRAM = Path(__file__).with_name("fake_scanimage.py")


class Fake:
    """What was made of a plan: `scanner` scans by it into `inbox`; `calls` are the arguments of every call."""

    def __init__(self, folder: Path, *turns: dict[str, Any], wanted: Wanted = ANY, **plan: Any) -> None:
        self.inbox, self._bin = folder / "inbox", folder / "bin"
        self.inbox.mkdir()
        self._bin.mkdir()
        (self._bin / "plan.json").write_text(json.dumps({"turns": turns, "page": PAGE.hex(), **plan}))
        program = self._bin / "scanimage"
        program.write_text(f"#!{sys.executable} -IS\n{_PROGRAM.read_text()}")
        program.chmod(0o755)
        self.waited = list[float]()
        self.scanimage = Scanimage(program=str(program), stop_within_s=0.05)
        self.scanner = Scanner(
            wanted, self.inbox, scanimage=self.scanimage, stamp=lambda: "20261124-125043", wait=self.waited.append
        )

    @property
    def calls(self) -> list[str]:
        noted = self._bin / "calls.txt"
        return noted.read_text().splitlines() if noted.exists() else []

    @property
    def pages(self) -> list[str]:
        return sorted(path.name for path in self.inbox.iterdir())

    def wait_for_call(self, call: str) -> None:
        """Until it has been noted, at most half a minute."""
        looks = 0
        while call not in self.calls:
            looks += 1
            assert looks < 3000, self.calls
            threading.Event().wait(0.01)


def fake_on_path(folder: Path, *turns: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> Fake:
    """The one that everybody finds."""
    made = Fake(folder, *turns)
    monkeypatch.setenv("PATH", f"{folder / 'bin'}:{os.environ['PATH']}")
    return made
