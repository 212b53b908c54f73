"""The way to a machine, put together: port or simulator, session, link."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Generic, TypeAlias, TypeVar

from daemon.errors import LinedrawError
from daemon.machine.link import Link, Promise, promise_nothing
from daemon.machine.recorder import Recorder
from daemon.machine.serial_port import Framing, open_serial
from daemon.machine.simulated import SimulatedTransport, way_to
from daemon.machine.transport import Transport
from daemon.shapes import Program, ProgramLine
from firmware_protocol.errors import ProtocolError
from firmware_protocol.ink import Polyline, Vector
from firmware_protocol.session import Ended, Event, Ready, Session, Status, Verdict
from firmware_protocol.simulator import Simulator

LISTEN_S = 0.05
"""Long enough for an idle controller's answer to `?`, short enough for a job that waits."""

POSITION_WITHIN_S = 3.0
"""A controller that is asked once a second has said by then where its pen is."""

PlaceMm: TypeAlias = tuple[float, float]
S = TypeVar("S", bound=Session)


@dataclass(frozen=True, slots=True)
class Conversation(Generic[S]):
    """How one kind of machine is spoken to.

    session: makes the session, given the time at which the port was opened. times: when each line of a program will
    have been drawn, in s from its start, as far as the session knows its machine; raises ProtocolError or ValueError
    for what the model does not know. check: what the machine says of itself, in lines for a person. lift: raises the
    pen where it stands; None where the machine cannot be asked to. moved: a line of a program, displaced by x and y in
    mm; None where programs cannot be displaced. home: begins homing between two jobs; None where a program does that.
    rests: why no job can be begun until the machine is homed or gets an origin; "" when one can. own_feed: why the
    machine cannot be made faster or slower from here, and what to do instead; "" where it can.
    """

    session: Callable[[float], S]
    times: Callable[[S, Sequence[str]], Sequence[float]]
    check: Callable[[S, Program], Sequence[str]]
    lift: Program | None = None
    moved: Callable[[str, PlaceMm], str] | None = None
    home: Callable[[S, float], None] | None = None
    rests: Callable[[S], str] = lambda session: ""
    own_feed: str = ""


@dataclass(frozen=True, slots=True)
class Record:
    """Where everything is written down (None: nowhere), the settings that stand at its beginning, and who is told of
    each turn of the loop (None: nobody)."""

    recorder: Recorder | None = None
    settings: dict[str, Any] = field(default_factory=dict)
    turned: Callable[[], None] | None = None


NO_RECORD = Record()


class OpenedMachine(Generic[S]):
    """A machine whose port is open. Only `stop`, `pause`, `resume` and `feed` may be called from other threads."""

    def __init__(
        self,
        transport: Transport,
        conversation: Conversation[S],
        *,
        heard: Callable[[Event], None],
        record: Record = NO_RECORD,
    ) -> None:
        self._transport, self._conversation = transport, conversation
        now = transport.now()
        self.session = conversation.session(now)
        self._heard = heard
        if record.recorder:
            record.recorder.opened(now, record.settings)
        self._link = Link(transport, self.session, heard=self._hear, recorder=record.recorder, turned=record.turned)
        self._corner_mm: PlaceMm = (0.0, 0.0)
        self._position_mm: Vector | None = None

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

    def draw(self, program: Program, promise: Promise = promise_nothing) -> Ended:
        """Send the program and wait for its end; see `Link.draw`. Raises MachineFault when it cannot be started."""
        return self._link.draw(self._displaced(program).lines, promise=promise)

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
        x_mm, y_mm = self._corner_mm
        return [[(x - x_mm, y - y_mm) for x, y in line] for line in transport.take_ink()]

    def position_mm(self) -> Vector | None:
        """Where the pen is, in the coordinates that programs speak before `count_from`; None when it is not said.

        Raises MachineFault as `listen` does.
        """
        self._position_mm = None
        until = self._transport.now() + POSITION_WITHIN_S
        while self._position_mm is None and self._transport.now() < until:
            self._link.listen(self._transport.now() + LISTEN_S)
        return self._position_mm

    def count_from(self, corner_mm: PlaceMm) -> None:
        """X0 Y0 of every program from now on lies here. Raises LinedrawError where programs cannot be displaced."""
        if self._conversation.moved is None:
            raise LinedrawError(f"{self.name} has its origin set at the control: set it there")
        self._corner_mm = corner_mm

    @property
    def rests(self) -> str:
        """Why no job can be begun, in a sentence; "" when one can."""
        return self._conversation.rests(self.session)

    def home(self, program: Program) -> Ended:
        """Find the machine's home, by the session itself or by this program. Raises NoMachine and MachineFault."""
        if self._conversation.home is None:
            return self.draw(program)
        begin = self._conversation.home
        self._link.home(lambda now: begin(self.session, now))
        return Ended(Verdict.FINISHED, 0, 0, position_known=True, pen_lifted=True, why="the machine is homed")

    def check(self, program: Program) -> Sequence[str]:
        """What the machine says of itself, and what `program` would want otherwise. Raises MachineFault."""
        at_mm = self.position_mm()
        place = "not said" if at_mm is None else "X{:.3f} Y{:.3f} Z{:.3f} mm".format(*at_mm)
        return [f"port: {self.name}", f"pen at: {place}", *self._conversation.check(self.session, program)]

    def lift(self) -> bool:
        """Raise the pen where it stands. False when it cannot be known to be up. Raises MachineFault."""
        lift = self._conversation.lift
        return lift is not None and self._link.draw(lift.lines).pen_lifted

    def pause(self, *, at_once: bool) -> None:
        """Stand still with the pen up, at the end of the stroke or at once. Raises LinedrawError where it cannot."""
        self._link.pause(at_once=at_once)

    def resume(self) -> None:
        """Go on after a pause. Raises LinedrawError where the machine cannot pause."""
        self._link.resume()

    def feed(self, percent: int) -> None:
        """Draw at so many percent of the program's feeds, until the job ends. Raises LinedrawError where it cannot."""
        if self._conversation.own_feed:
            raise LinedrawError(self._conversation.own_feed)
        self._link.feed(percent)

    def stop(self) -> None:
        """Hold at once, lift the pen, end the job. Returns at once."""
        self._link.stop()

    def close(self) -> None:
        """Give the port back."""
        self._link.close()

    def _displaced(self, program: Program) -> Program:
        moved = self._conversation.moved
        if moved is None or self._corner_mm == (0.0, 0.0):
            return program
        lines = (ProgramLine(moved(line.text, self._corner_mm), line.stroke) for line in program.lines)
        return replace(program, lines=tuple(lines))

    def _hear(self, event: Event) -> None:
        if isinstance(event, Status):
            self._position_mm = event.position_mm
        self._heard(event)


def open_machine(
    url: str,
    conversation: Conversation[S],
    *,
    framing: Framing,
    simulate: Callable[[], Simulator],
    heard: Callable[[Event], None],
    record: Record = NO_RECORD,
) -> OpenedMachine[S]:
    """Open the port and prepare the conversation; nothing has been said yet.

    url: serial://, tcp:// or sim://. simulate: makes the simulated machine of a sim://. heard: is told every event, in
    the drawing thread. Raises NoMachine, and SettingsError for a simulated machine that there is not.
    """
    transport = way_to(simulate(), url) if url.startswith("sim://") else open_serial(url, framing=framing)
    return OpenedMachine(transport, conversation, heard=heard, record=record)
