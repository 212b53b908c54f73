"""Lines a second into the simulated GRBL over a pseudo terminal at real wire speed, and what sending them costs."""

from __future__ import annotations

import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from daemon.machine.link import Link
from daemon.machine.serial_port import open_serial
from daemon.shapes import ProgramLine
from firmware_protocol.grbl.session import GrblSession

LINES = 3000
_LIFT = ("G90 G21", "G0 Z5")
# A brisk machine: on one that accelerates slowly its motion is the limit, not the wire.
_MACHINE = "sim://grbl?110=6000&111=6000&120=500&121=500"
_READY_WITHIN_S = 10.0


def show() -> None:
    """Print a line for each kind of program."""
    print(f"{LINES} lines into the simulated GRBL, 115200 baud, real time")
    print(f"{'':22}{'lines/s':>9}{'CPU share':>11}{'CPU us/line':>13}   ended")
    moving = [f"G1 X{10 + i / 100:.3f} Y{20 + i / 200:.3f}" for i in range(LINES - 1)]
    programs = {"with motion": ["G21 G90 F1200", *moving], "without motion": ["G21 G90 G1 F1200 S123"] * LINES}
    with controller() as port:
        for name, lines in programs.items():
            print(f"{name:22}{sent(port, lines)}", flush=True)


def sent(port: Path, lines: list[str]) -> str:
    """Stream the lines once; the figures in words."""
    transport = open_serial(f"serial://{port}")
    link = Link(transport, GrblSession(now=transport.now(), lift=_LIFT), heard=lambda event: None)
    try:
        link.connect()
        wall_s, cpu_s = time.perf_counter(), time.process_time()
        ended = link.draw([ProgramLine(line) for line in lines])
        wall_s, cpu_s = time.perf_counter() - wall_s, time.process_time() - cpu_s
    finally:
        link.close()
    rate = f"{len(lines) / wall_s:>9.0f}{cpu_s / wall_s:>11.1%}{cpu_s / len(lines) * 1e6:>13.0f}"
    return f"{rate}   {ended.verdict.value} after {wall_s:.1f} s"


@contextmanager
def controller() -> Iterator[Path]:
    """`linedrawd simulate grbl` in a process of its own; the path of its pseudo terminal."""
    with tempfile.TemporaryDirectory() as folder:
        port = Path(folder) / "grbl"
        command = [
            str(Path(sys.executable).with_name("linedrawd")),
            "simulate",
            "grbl",
            "--url",
            _MACHINE,
            "--pty",
            str(port),
        ]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
        try:
            wait_for(port, process)
            yield port
        finally:
            process.send_signal(signal.SIGTERM)
            process.wait(10)


def wait_for(port: Path, process: subprocess.Popen[bytes]) -> None:
    give_up = time.monotonic() + _READY_WITHIN_S
    while not port.exists():
        if process.poll() is not None or time.monotonic() > give_up:
            raise SystemExit(f"the simulated controller does not start (code {process.poll()}): run make test")
        time.sleep(0.05)
