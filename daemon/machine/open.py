"""The way to a machine, put together: port or simulator, session, link."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

from daemon.machine.link import Link
from daemon.machine.serial_port import Framing, open_serial
from daemon.machine.simulated import SimulatedTransport, open_simulated
from daemon.machine.transport import Transport
from daemon.shapes import Program
from firmware_protocol.errors import ProtocolError
from firmware_protocol.ink import PenRule, Polyline
from firmware_protocol.session import Ended, Event, Ready, Session

LISTEN_S = 0.05
"""Long enough for an idle controller's answer to `?`, short enough for a job that waits."""

S = TypeVar("S", bound=Session)


@dataclass(frozen=True, slots=True)
class Conversation(Generic[S]):
    """How one kind of machine is spoken to.

    session: makes the session, given the time at which the port was opened. times: when each line of a program will
    have been drawn, in s from its start, as far as the session knows its machine; raises ProtocolError or ValueError
    for what the model does not know. sheet_mm: where the simulated machine's ink has the sheet's corner.
    """

    session: Callable[[float], S]
    times: Callable[[S, Sequence[str]], Sequence[float]]
    sheet_mm: tuple[float, float] = (0.0, 0.0)


class OpenedMachine(Generic[S]):
    """A machine whose port is open. Only `stop` may be called from another thread than the one that draws."""

    def __init__(self, transport: Transport, conversation: Conversation[S], *, heard: Callable[[Event], None]) -> None:
        self._transport, self._conversation = transport, conversation
        self.session = conversation.session(transport.now())
        self._link = Link(transport, self.session, heard=heard)
        self._polylines_taken = 0

    @property
    def name(self) -> str:
        """For people: the device path or URL."""
        return self._transport.name

    def now(self) -> float:
        """Seconds on the machine's clock: real for a port, simulated for a simulator."""
        return self._transport.now()

    def connect(self) -> Ready:
        """Wait until the machine takes a job. Raises NoMachine or MachineFault."""
        return self._link.connect()

    def draw(self, program: Program) -> Ended:
        """Send the program and wait for its end. Raises MachineFault when it cannot be started."""
        return self._link.draw(program.lines)

    def listen(self) -> None:
        """Hear what an idle machine said meanwhile. Raises MachineFault when it is gone or no longer ready."""
        self._link.listen(self._transport.now() + LISTEN_S)

    def line_times_s(self, program: Program) -> Sequence[float]:
        """When each line will have been drawn, in s from the start, by the machine's own speeds and accelerations.

        Empty for a program or for settings that the model does not know: a dialect of GRBL, for example.
        """
        try:
            return self._conversation.times(self.session, [line.text for line in program.lines])
        except (ProtocolError, ValueError):
            return []

    def take_ink(self) -> list[Polyline] | None:
        """What has been drawn since the last call, in mm from the sheet's corner; None on a machine of metal."""
        transport = self._transport
        if not isinstance(transport, SimulatedTransport):
            return None
        new, self._polylines_taken = transport.ink[self._polylines_taken :], len(transport.ink)
        x_mm, y_mm = self._conversation.sheet_mm
        return [[(x - x_mm, y - y_mm) for x, y in line] for line in new]

    def stop(self) -> None:
        """Hold at once, lift the pen, end the job. Returns at once."""
        self._link.stop()

    def close(self) -> None:
        """Give the port back."""
        self._link.close()


def open_machine(
    url: str,
    conversation: Conversation[S],
    *,
    framing: Framing,
    touches: PenRule | None,
    heard: Callable[[Event], None],
) -> OpenedMachine[S]:
    """Open the port and prepare the conversation; nothing has been said yet.

    url: serial://, tcp:// or sim://. touches: when the pen of a simulated GRBL is on the sheet. heard: is told every
    event, in the drawing thread. Raises NoMachine, and SettingsError as `check_url` does.
    """
    return OpenedMachine(_transport(url, framing, touches), conversation, heard=heard)


def check_url(url: str) -> None:
    """Raises SettingsError for a simulated machine that there is not; ports are looked for when they are opened."""
    if url.startswith("sim://"):
        open_simulated(url).close()


def _transport(url: str, framing: Framing, touches: PenRule | None) -> Transport:
    if url.startswith("sim://"):
        return open_simulated(url, pen=touches)
    return open_serial(url, framing=framing)
