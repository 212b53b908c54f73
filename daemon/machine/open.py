"""The way to a machine, put together: port or simulator, session, link."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Literal

from daemon.machine.link import Link
from daemon.machine.serial_port import open_serial
from daemon.machine.simulated import SimulatedTransport, open_simulated, simulator_of
from daemon.machine.transport import Transport
from daemon.shapes import Program
from firmware_protocol.errors import ProtocolError
from firmware_protocol.grbl.session import GrblSession
from firmware_protocol.grbl.simulator.planner import line_times_s
from firmware_protocol.ink import PenRule, Polyline
from firmware_protocol.session import Ended, Event, Ready

LISTEN_S = 0.05
"""Long enough for an idle controller's answer to `?`, short enough for a job that waits."""


class OpenedMachine:
    """A GRBL controller whose port is open. Only `stop` may be called from another thread than the one that draws."""

    def __init__(self, transport: Transport, session: GrblSession, link: Link) -> None:
        self._transport, self._session, self._link = transport, session, link
        self._polylines_taken = 0

    @property
    def name(self) -> str:
        """For people: the device path or URL."""
        return self._transport.name

    def now(self) -> float:
        """Seconds on the machine's clock: real for a port, simulated for a simulator."""
        return self._transport.now()

    def connect(self) -> Ready:
        """Wait until the controller has introduced itself. Raises NoMachine or MachineFault."""
        return self._link.connect()

    def draw(self, program: Program) -> Ended:
        """Stream the program and wait for its end. Raises MachineFault when it cannot be started."""
        return self._link.draw(program.lines)

    def listen(self) -> None:
        """Hear what an idle controller said meanwhile. Raises MachineFault when it is gone or no longer ready."""
        self._link.listen(self._transport.now() + LISTEN_S)

    def line_times_s(self, program: Program) -> list[float]:
        """When each line will have been drawn, in s from the start, by the controller's own speeds and accelerations.

        Empty for a program or for settings that the model does not know: a dialect of GRBL, for example.
        """
        try:
            return line_times_s([line.text for line in program.lines], self._session.settings)
        except (ProtocolError, ValueError):
            return []

    def take_ink(self) -> list[Polyline] | None:
        """What has been drawn since the last call, polylines in mm; None on a machine that is not simulated."""
        if not isinstance(self._transport, SimulatedTransport):
            return None
        ink = self._transport.ink
        new, self._polylines_taken = ink[self._polylines_taken :], len(ink)
        return new

    def stop(self) -> None:
        """Hold at once, lift the pen, end the job. Returns at once."""
        self._link.stop()

    def close(self) -> None:
        """Give the port back."""
        self._link.close()


def open_machine(
    url: str,
    *,
    baud: int,
    flow: Literal["count", "line"],
    lift: Sequence[str],
    lift_after_restart: bool,
    home: bool,
    touches: PenRule,
    heard: Callable[[Event], None],
) -> OpenedMachine:
    """Open the port and prepare the conversation; nothing has been said yet.

    url: serial://, tcp:// or sim://. lift: lines that raise the pen.
    touches: when the pen of a simulated machine is on the sheet. heard: is told every event, in the drawing thread.
    Raises NoMachine, and SettingsError as `check_url` does.
    """
    transport = _transport(url, baud, touches)
    session = GrblSession(now=transport.now(), flow=flow, lift=lift, lift_after_restart=lift_after_restart, home=home)
    return OpenedMachine(transport, session, Link(transport, session, heard=heard))


def check_url(url: str) -> None:
    """Raises SettingsError for a simulated machine that there is not; ports are looked for when they are opened."""
    if url.startswith("sim://"):
        simulator_of(url)


def _transport(url: str, baud: int, touches: PenRule) -> Transport:
    if url.startswith("sim://"):
        return open_simulated(url, pen=touches)
    return open_serial(url, baud=baud)
