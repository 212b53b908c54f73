"""Lines a second into the simulated GRBL over a pseudo terminal at real wire speed, and what sending them costs.

On a machine that is busy otherwise the figures are those of its scheduler: run it under `chrt -r 10`.
"""

from __future__ import annotations

import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from math import cos, sin
from pathlib import Path
from typing import NamedTuple

from daemon.machine.link import Link
from daemon.machine.serial_port import open_serial
from daemon.machine.simulated import SimulatedTransport, simulator_of
from daemon.machine.transport import Transport
from daemon.shapes import ProgramLine
from firmware_protocol.grbl.session import GrblSession
from firmware_protocol.session import Accepted, Event

LINES = 3000
BYTES_S = 11520
_LIFT = ("G90 G21", "G0 Z5")
# A machine so brisk, with so few steps, that neither its motion nor its step interrupts are the limit.
_MACHINE = "sim://grbl?1=255&" + "&".join(
    f"{base + axis}={value}" for base, value in ((100, 40), (110, 30000), (120, 5000)) for axis in range(3)
)
_READY_WITHIN_S = 10.0


class Moment(NamedTuple):
    """A point of time: on the transport's clock, on the wall, and the processor's time of this process until then."""

    clock_s: float
    wall_s: float
    cpu_s: float


def show() -> None:
    """Print a line for check mode and one for motion, with what they would be if the host took no time."""
    lines = program()
    bytes_a_line = sum(len(line.text) + 1 for line in lines) / len(lines)
    print(f"{LINES} lines of {bytes_a_line:.1f} bytes into the simulated GRBL, 115200 baud, real time")
    print(f"the wire takes {BYTES_S / bytes_a_line:.0f} lines/s; then the simulated chip limits: see its own column")
    print(f"{'':22}{'lines/s':>9}{'chip':>9}{'CPU share':>11}{'CPU us/line':>13}")
    alone = moments(SimulatedTransport(simulator_of(_MACHINE)), lines)
    with controller() as port:
        served = moments(open_serial(f"serial://{port}"), lines)
    for name, first in (("check mode ($C)", 0), ("with motion", 1)):
        (begin, end), (free_begin, free_end) = served[first : first + 2], alone[first : first + 2]
        wall_s, cpu_s = end.wall_s - begin.wall_s, end.cpu_s - begin.cpu_s
        free = LINES / (free_end.clock_s - free_begin.clock_s)
        print(f"{name:22}{LINES / wall_s:>9.0f}{free:>9.0f}{cpu_s / wall_s:>11.1%}{cpu_s / LINES * 1e6:>13.0f}")


def program(lines: int = LINES) -> list[ProgramLine]:
    """Turns of a circle in moves of 0.05 mm."""
    angles = [step * 0.05 / 8 for step in range(lines - 1)]
    moves = [f"G1X{15 + 8 * cos(angle):.3f}Y{15 + 8 * sin(angle):.3f}" for angle in angles]
    return [ProgramLine("G90G21F30000"), *map(ProgramLine, moves)]


def moments(transport: Transport, lines: list[ProgramLine]) -> list[Moment]:
    """Draw the lines once, in check mode first: the start, the first line accepted in earnest, and the last."""
    seen: list[Moment] = []

    def heard(event: Event) -> None:
        if isinstance(event, Accepted) and event.line in (0, len(lines) - 1):
            seen.append(moment())

    def moment() -> Moment:
        return Moment(transport.now(), time.perf_counter(), time.process_time())

    link = Link(transport, GrblSession(now=transport.now(), lift=_LIFT, dry_run=True), heard=heard)
    try:
        link.connect()
        start = moment()
        link.draw(lines)
    finally:
        link.close()
    return [start, *seen]


@contextmanager
def controller() -> Iterator[Path]:
    """`linedrawd simulate grbl` in a process of its own; the path of its pseudo terminal."""
    with tempfile.TemporaryDirectory() as folder:
        port = Path(folder) / "grbl"
        linedrawd = Path(sys.executable).with_name("linedrawd")
        command = [linedrawd, "simulate", "grbl", "--url", _MACHINE, "--pty", port]
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
