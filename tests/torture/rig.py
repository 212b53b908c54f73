"""The bench: each simulated machine in a process of its own, the daemon in another, and what they have left."""

from __future__ import annotations

import json
import os
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from daemon.control import Order, give_order
from daemon.errors import LinedrawError
from daemon.machine.simulator_control import tell
from tests.torture.sheet import Line

LOOK_EVERY_S = 0.02
READY_WITHIN_S = 60.0
ENDS_WITHIN_S = 40.0
GONE_WITHIN_S = 10.0
"""How long the children of a killed daemon may live on a busy computer."""
PEN_TOUCHES_MM = -7.99
_TO_SHEET_MM = 90.0
"""The sheet's coordinates begin where the machine was switched on; homed, it counts from the end of its travel."""
_SETTINGS = {22: 1, 23: 3, 24: 3000, 25: 9000, 26: 5, 100: 80, 101: 80, 110: 30000, 111: 30000, 112: 9000,
             120: 3000, 121: 3000, 122: 3000, 130: 100, 131: 100, 132: 50}  # fmt: skip
_URL = f"sim://grbl?switches=-10:-10:0&pen_z={PEN_TOUCHES_MM}&" + "&".join(f"{n}={v}" for n, v in _SETTINGS.items())
_TOML = """
[intake]
settle_s = 0.02
[sheet]
box_mm = [40, 40]
box_origin_mm = [5, 5]
"""
_MACHINE_TOML = """
[machines.{name}]
device = "grbl"
url = "serial://{port}"
home = "start"
origin_mm = [-95, -95]
reach_mm = [100, 100]
draw_mm_s = 100
pen = {{up_mm = -4, down_mm = -8, plunge_mm_s = 150}}
sheet = "feed"
"""
_MARK = "LINEDRAWD_TORTURE"


class Stuck(Exception):
    """Something has not come in time; what, says the message."""


@dataclass(frozen=True, slots=True)
class Sheet:
    """What the machine has left: lines in mm as programs count them, and whether the pen is off the sheet."""

    lines: list[Line]
    pen_up: bool


def await_(what: str, seen: Callable[[], bool], *, within_s: float) -> None:
    """Look until it is so. Raises Stuck."""
    give_up = time.monotonic() + within_s
    while not seen():
        if time.monotonic() > give_up:
            raise Stuck(f"{what} within {within_s:g} s")
        time.sleep(LOOK_EVERY_S)


class Machine:
    """A simulated GRBL on a pseudo terminal. It keeps its ink until `close`."""

    def __init__(self, folder: Path, name: str) -> None:
        self.name, self.port, self._ink = name, folder / name, folder / f"ink-{name}.json"
        command = [linedrawd(), "simulate", "grbl", "--url", _URL, "--pty", self.port]
        self._process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
        await_("the machine is there", lambda: self.port.exists() or not self._runs, within_s=READY_WITHIN_S)
        if not self._runs:
            raise Stuck(f"the simulated machine ended with code {self._process.returncode}")

    @property
    def _runs(self) -> bool:
        return self._process.poll() is None

    def happen(self, sentence: str) -> None:
        tell(self.port, sentence)

    def sheet(self) -> Sheet:
        self.happen(f"ink to {self._ink}")
        said = json.loads(self._ink.read_text())
        lines = [np.array(line, float).reshape(-1, 2) - _TO_SHEET_MM for line in said["polylines_mm"]]
        return Sheet(lines, said["pen_mm"][2] > PEN_TOUCHES_MM)

    def close(self) -> None:
        self._process.terminate()
        self._process.wait(ENDS_WITHIN_S)


class Daemon:
    """The daemon, on a state folder that outlives it. whole: `linedrawd` with its own planner, else a quick one."""

    def __init__(self, folder: Path, machines: Sequence[Machine], *, whole: bool) -> None:
        self._whole, self._recorded = whole, len(machines) == 1
        self.state, self._said, self._config = folder / "state", folder / "linedrawd.txt", folder / "linedrawd.toml"
        self._mark = f"{_MARK}={folder}"
        sections = [_MACHINE_TOML.format(name=machine.name, port=machine.port) for machine in machines]
        self._config.write_text("".join([_TOML, *sections]))
        self.inbox, self.jobs, self.journal = (self.state / name for name in ("inbox", "jobs", "journal.sqlite"))
        self.inbox.mkdir(parents=True)
        self._process: subprocess.Popen[bytes] | None = None
        self._starts = 0

    @property
    def pid(self) -> int:
        assert self._process is not None
        return self._process.pid

    @property
    def runs(self) -> bool:
        return self._process is not None and self._process.poll() is None

    def start(self) -> None:
        """Start it; it may not be ready yet."""
        name, _, value = self._mark.partition("=")
        self._starts += 1
        record = [self._said.with_name(f"start-{self._starts}.record")] if self._recorded else []
        command: list[str | Path] = [sys.executable, "-m", "tests.torture.daemon", self._config, self.state, *record]
        if self._whole:
            command = [linedrawd(), "--config", self._config, "--state-dir", self.state]
            command += ["--record", *record] if record else []
        with self._said.open("ab") as said:
            self._process = subprocess.Popen(command, stdout=said, stderr=said, env=os.environ | {name: value})

    def await_ready(self) -> None:
        """Until it takes orders. Raises Stuck."""
        await_("the daemon answers", lambda: not self.runs or self.order("ping") is not None, within_s=READY_WITHIN_S)
        if not self.runs:
            raise Stuck(f"the daemon ended by itself with code {self.code()}: see {self._said}")

    def order(self, name: str, machine: str = "") -> str | None:
        """What it answers; None when it refuses or does not answer."""
        order = Order.model_validate({"order": name, "machine": machine})
        try:
            return give_order(self.state / "run" / "control.sock", order)
        except LinedrawError:
            return None

    def signal(self, number: signal.Signals) -> None:
        if self._process is not None:
            self._process.send_signal(number)

    def code(self) -> int:
        """Of its end. Raises Stuck when it does not come."""
        assert self._process is not None
        try:
            return self._process.wait(ENDS_WITHIN_S)
        except subprocess.TimeoutExpired:
            raise Stuck(f"the daemon ends within {ENDS_WITHIN_S:g} s") from None

    def children(self) -> list[int]:
        """Every process of it but itself."""
        return [pid for pid in self.family() if pid != self.pid]

    def family(self) -> list[int]:
        """Every process that it or a daemon before it on this folder has started and that still runs."""
        mark, found = self._mark.encode(), []
        for path in Path("/proc").glob("[0-9]*/environ"):
            try:
                if mark in path.read_bytes().split(b"\0"):
                    found.append(int(path.parent.name))
            except OSError:
                continue  # It has just ended, or it is somebody else's.
        return found

    def fill_the_disk(self, *, full: bool) -> None:
        """No file of it grows any more, as on a full disk; or may again."""
        for pid in self.family():
            try:
                hard = resource.prlimit(pid, resource.RLIMIT_FSIZE)[1]
                resource.prlimit(pid, resource.RLIMIT_FSIZE, (0 if full else hard, hard))
            except ProcessLookupError:
                continue

    def status(self) -> dict[str, Any]:
        try:
            told: dict[str, Any] = json.loads((self.state / "run" / "status.json").read_text())
        except (OSError, ValueError):
            return {}
        return told


def linedrawd() -> Path:
    return Path(sys.executable).with_name("linedrawd")
