"""Any bytes at all, as what a machine says to its session."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field

from firmware_protocol.errors import LocalProtocolError
from firmware_protocol.session import Ended, Event, JobLine, Paused, Ready, Session
from firmware_protocol.simulator import Simulator

_CONTROL_BYTES = 4
"""At the head of an input: size of the chunks, time between them, and when the job is stopped and paused."""
_TURNS_WITHOUT_TIME = 100
_DEADLINES = 60


class Broken(Exception):
    """A session has broken its promise."""


@dataclass(frozen=True, slots=True)
class Line:
    """A line of a job."""

    text: str
    stroke: int | None = None


@dataclass
class Conversation:
    """One session, from opening to unplugging, and what it has said."""

    session: Session
    job: Sequence[JobLine]
    now: float = 0.0
    started: bool = False
    ends: list[Ended] = field(default_factory=list)

    def run(self, data: bytes) -> None:
        """Raises Broken, or whatever a session should not raise."""
        head, said = data[:_CONTROL_BYTES].ljust(_CONTROL_BYTES, b"\x10"), data[_CONTROL_BYTES:]
        size, gap_s = 1 + head[0] % 64, head[1] / 100
        chunks = [said[at : at + size] for at in range(0, len(said), size)]
        for number, chunk in enumerate(chunks):
            self._ask(number, stop_at=head[2], pause_at=head[3])
            self._turn(chunk)
            self.now += gap_s
            self._catch_up()
        for _ in range(_DEADLINES):
            at = self.session.deadline()
            if at is None:
                break
            self.now = max(self.now, at)
            self._turn(b"")
        self._hear(self.session.unplugged(self.now))
        if self.started and len(self.ends) != 1:
            raise Broken(f"the job has ended {len(self.ends)} times: {self.ends}")

    def _ask(self, number: int, *, stop_at: int, pause_at: int) -> None:
        if not self.started or self.ends:
            return
        with suppress(LocalProtocolError):
            if number == stop_at:
                self.session.stop(self.now)
            elif number == pause_at and hasattr(self.session, "pause"):
                self.session.pause(self.now, at_once=bool(pause_at % 2))

    def _catch_up(self) -> None:
        """A session that wants to be called now, again and again, would keep its loop from ever waiting."""
        for _ in range(_TURNS_WITHOUT_TIME):
            at = self.session.deadline()
            if at is None or at > self.now:
                return
            self._turn(b"")
        raise Broken(f"the session wants to be called at {at} and again, it is {self.now}")

    def _turn(self, heard: bytes) -> None:
        self._hear(self.session.receive(heard, self.now))
        self._hear(self.session.expire(self.now))
        self.session.data_to_send(self.now)

    def _hear(self, events: list[Event]) -> None:
        for event in events:
            if isinstance(event, Ready) and not self.started:
                with suppress(LocalProtocolError):
                    self.session.start(self.job, self.now)
                    self.started = True
            elif isinstance(event, Paused):
                with suppress(LocalProtocolError):
                    self.session.resume(self.now)  # type: ignore[attr-defined]
            elif isinstance(event, Ended):
                self._check(event)
                self.ends.append(event)

    def _check(self, ended: Ended) -> None:
        strokes = len({line.stroke for line in self.job} - {None})
        if not 0 <= ended.strokes_certain <= ended.strokes_possible <= strokes:
            raise Broken(f"of {strokes} strokes: {ended}")


def said_by(simulator: Simulator, session: Session, job: Sequence[JobLine], *, size: int = 17) -> bytes:
    """What a simulated machine says in a whole job, as an input to begin from that comes `size` bytes at a time."""
    simulator.open(0.0)
    said, now, started = b"", 0.0, False
    while now < 600.0:
        heard = simulator.advance(now)
        said += heard
        events = [*session.receive(heard, now), *session.expire(now)]
        if any(isinstance(event, Ended) for event in events):
            break
        if not started and any(isinstance(event, Ready) for event in events):
            session.start(job, now)
            started = True
        simulator.receive(session.data_to_send(now), now)
        times = [at for at in (simulator.next_time(), session.deadline()) if at is not None]
        now = max(now + 1e-6, min(times, default=now + 1.0))
    return bytes((size - 1, 2, 255, 255)) + said


def conversation(session: Callable[[], Session], job: Sequence[JobLine]) -> Callable[[bytes], None]:
    """Takes one input."""
    return lambda data: Conversation(session(), job).run(data)
