"""A simulated plotter on a pseudo terminal that notes when lines come, and when its planner runs dry."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from daemon.machine.pseudo_terminal import serve
from daemon.machine.simulated import simulator_of
from firmware_protocol.grbl.simulator.simulator import GrblSimulator
from firmware_protocol.ink import Polyline

_URL = "sim://grbl?" + "&".join(
    f"{base + axis}={value}" for base, value in ((100, 40), (110, 9000), (120, 3000)) for axis in range(3)
)
_DRAWS = (b"G1", b"G2 ", b"G2X", b"G3")


class Wire:
    """A simulator that is listened to; everything else it leaves to the simulator."""

    def __init__(self, simulator: GrblSimulator) -> None:
        self._simulator = simulator
        self.line_at_s: float | None = None
        """When the first draw move since `await_line` came, on the clock of the wall."""
        self.late_s: list[float] = []
        """For each answer that was followed by bytes: how long after it they came, s."""
        self.held_at_s: float | None = None
        """When it was first told to hold, on the clock that only goes forward."""
        self._answered_s: float | None = None
        self._awaited = False

    def await_line(self) -> None:
        self.line_at_s, self._awaited = None, True

    @property
    def now(self) -> float:
        return self._simulator.now

    @property
    def dry(self) -> int:
        """How often the pen has stood on the sheet for want of a line."""
        return self._simulator.stood_on_sheet

    @property
    def ink(self) -> Sequence[Polyline]:
        return self._simulator.ink

    @property
    def unplugged(self) -> bool:
        return self._simulator.unplugged

    def clear_sheet(self) -> None:
        self._simulator.clear_sheet()

    def open(self, now: float) -> None:
        self._simulator.open(now)

    def next_time(self) -> float | None:
        return self._simulator.next_time()

    def receive(self, data: bytes, now: float) -> None:
        if self._awaited and any(word in data for word in _DRAWS):
            self.line_at_s, self._awaited = time.time(), False
        if b"!" in data:
            self.held_at_s = self.held_at_s or time.monotonic()
        if data.strip(b"?") and self._answered_s is not None:
            self.late_s.append(time.monotonic() - self._answered_s)
            self._answered_s = None
        self._simulator.receive(data, now)

    def advance(self, now: float) -> bytes:
        said = self._simulator.advance(now)
        if b"ok" in said and self._answered_s is None:
            self._answered_s = time.monotonic()
        return said


@contextmanager
def served(link: Path) -> Iterator[Wire]:
    """The plotter at the symbolic link, in a thread of this process."""
    wire = Wire(simulator_of(_URL))
    stop_fd, stop = os.pipe()
    thread = threading.Thread(target=serve, args=(wire, link), kwargs={"stop_fd": stop_fd})
    thread.start()
    try:
        yield wire
    finally:
        os.write(stop, b"!")
        thread.join()
        os.close(stop)
        os.close(stop_fd)
