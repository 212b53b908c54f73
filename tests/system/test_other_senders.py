"""Senders that other people wrote draw a page on the simulated controller, each in a virtual environment of its own."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import venv
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from threading import Event

import pytest

pytestmark = pytest.mark.system

BRISK = "sim://grbl?1=255&110=6000&111=6000&112=6000&120=500&121=500&122=500"
SQUARES = [[(x, x), (x + 10, x), (x + 10, x + 10), (x, x + 10), (x, x)] for x in (5, 20, 35)]

SENDERS = {
    "pygrbl-streamer": """
import sys
from pygrbl_streamer import GrblStreamer
with GrblStreamer(sys.argv[1], auto_unlock=False) as sender:
    sys.exit(0 if sender.send_file(sys.argv[2]) else 1)
""",
    "grbl-streamer": """
import sys, threading
from grbl_streamer import GrblStreamer
boots, running, parked = threading.Semaphore(0), threading.Event(), threading.Event()
def told(event, *data):
    if event == "on_boot":
        boots.release()
    if event == "on_stateupdate" and data[0] == "Run":
        running.set()
    if event == "on_stateupdate" and data[:2] == ("Idle", (0.0, 0.0, 5.0)) and running.is_set():
        parked.set()
sender = GrblStreamer(told)
sender.setup_logging()
sender.cnect(sys.argv[1], 115200)
boots.acquire(timeout=10)
threading.Event().wait(2)  # a job that begins among the answers to its own start-up lines overruns the controller
sender.poll_start()
sender.load_file(sys.argv[2])
sender.job_run()
drawn = parked.wait(60)
sender.poll_stop()
sender.disconnect()
sys.exit(0 if drawn else 1)
""",
    # Its core is free of Qt; the controller's `ok` of the last line comes before the last motion has ended.
    "plotdeck": """
import sys, threading
from plotdeck.core.controller import MachineController
connected, over, parked, ends = threading.Event(), threading.Event(), threading.Event(), []
controller = MachineController()
controller.on_connected = lambda version: connected.set()
controller.on_job_finished = lambda reason: (ends.append(reason), over.set())
def told(status):
    if over.is_set() and status.state.startswith("Idle"):
        parked.set()
controller.on_status = told
controller.connect(sys.argv[1])
assert connected.wait(10)
threading.Event().wait(3)  # its own empty lines are answered before the job begins, or count as the job's
assert controller.run_text(open(sys.argv[2]).read())
assert over.wait(60)
drawn = ends == ["completed"] and parked.wait(10)
controller.disconnect()
sys.exit(0 if drawn else 1)
""",
    "gantrix": """
import sys
from gantrix.transport import GrblTransport
with GrblTransport(sys.argv[1]) as transport:
    for line in open(sys.argv[2]):
        transport.send(line)
""",
    "grbl-link": """
import sys, threading, serial
from grbl_link.grbl_link import Grbl
from grbl_link.messages import ResponseMessage, WelcomeMessage
lines = open(sys.argv[2]).read().splitlines()
greeted, drawn, answers = threading.Event(), threading.Event(), []
def told(message):
    if isinstance(message, WelcomeMessage):
        greeted.set()
    if isinstance(message, ResponseMessage):
        answers.append(message)
    if len(answers) == len(lines):
        drawn.set()
grbl = Grbl(serial.Serial(sys.argv[1], 115200, timeout=1))
grbl.protocol.add_message_handler(told)
assert greeted.wait(10)
for line in lines:
    grbl.send(line)
whole = drawn.wait(60)
grbl.stop()
sys.exit(0 if whole else 1)
""",
}
ALONE = {"plotdeck", "grbl-link"}
"""Installed without what they ask for: windows, and a command line, which the parts that are used here do without."""


def page() -> str:
    """Three squares with the pen on Z, and back to the start."""
    lines = ["G21", "G90", "G0 Z5"]
    for square in SQUARES:
        lines += [f"G0 X{square[0][0]} Y{square[0][1]}", "G1 Z0 F1500"]
        lines += [f"G1 X{x} Y{y} F3000" for x, y in square[1:]]
        lines += ["G0 Z5"]
    return "\n".join([*lines, "G0 X0 Y0", "G4 P0.01"]) + "\n"


class Plotter:
    """A simulator in a process of its own."""

    def __init__(self, folder: Path, *, fault: str = "") -> None:
        self.link, self._ink = folder / "grbl", folder / "ink.json"
        command = [sys.executable, "-m", "daemon.cli", "simulate", "grbl", "--url", BRISK + fault]
        self._process = subprocess.Popen([*command, "--pty", str(self.link), "--ink", str(self._ink)])
        while self._process.poll() is None and not self.link.exists():
            Event().wait(0.05)

    def drawn(self) -> list[list[tuple[float, float]]]:
        """Switch it off, and say what is on its sheet."""
        self._process.send_signal(signal.SIGTERM)
        assert self._process.wait(10) == 0
        return [[(x, y) for x, y in line] for line in json.loads(self._ink.read_text())["polylines_mm"]]

    def kill(self) -> None:
        self._process.kill()
        self._process.wait()


@pytest.fixture
def plotter(tmp_path: Path) -> Iterator[Plotter]:
    running = Plotter(tmp_path)
    yield running
    running.kill()


@pytest.fixture(scope="module")
def python_with(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """The Python of a virtual environment that holds a package, from the index that pip is set up for."""
    return cache(lambda package: installed(package, tmp_path_factory.mktemp(package)))


def installed(package: str, folder: Path) -> Path:
    venv.create(folder, with_pip=True)
    python = folder / "bin" / "python"
    alone = ["--no-deps"] if package in ALONE else []
    subprocess.run([python, "-m", "pip", "install", "--quiet", *alone, package, "pyserial"], check=True, timeout=300)
    return python


@pytest.mark.parametrize("package", list(SENDERS))
def test_a_page_is_drawn_whole(
    package: str, plotter: Plotter, python_with: Callable[[str], Path], tmp_path: Path
) -> None:
    program = tmp_path / "page.gcode"
    program.write_text(page())
    python = python_with(package)
    subprocess.run([python, "-c", SENDERS[package], plotter.link, program], check=True, timeout=120)
    assert plotter.drawn() == SQUARES


@pytest.mark.parametrize("package", ["pygrbl-streamer", "plotdeck"])
def test_a_sender_that_looks_for_it_notices_a_pulled_cable(
    package: str, python_with: Callable[[str], Path], tmp_path: Path
) -> None:
    program = tmp_path / "page.gcode"
    program.write_text(page())
    python = python_with(package)
    plotter = Plotter(tmp_path, fault="&unplug=@20")
    try:
        sent = subprocess.run([python, "-c", SENDERS[package], plotter.link, program], check=False, timeout=120)
        assert sent.returncode == 1
        assert not plotter.link.exists()
        whole = [line for line in plotter.drawn() if len(line) == len(SQUARES[0])]
        assert whole == SQUARES[: len(whole)]
        assert len(whole) < len(SQUARES)
    finally:
        plotter.kill()
