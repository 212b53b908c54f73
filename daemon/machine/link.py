"""The one loop that moves bytes and time between a session and a transport."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Protocol, TypeAlias, runtime_checkable

from daemon.errors import LinedrawError, MachineFault, NoMachine
from daemon.machine.recorder import Kind, Recorder
from daemon.machine.transport import Transport
from firmware_protocol.errors import LocalProtocolError
from firmware_protocol.session import (
    AdjustableSession,
    Ended,
    Event,
    JobLine,
    NotReady,
    PausableSession,
    Paused,
    Ready,
    ResumableSession,
    Session,
)

LIFT_WITHIN_S = 30.0
"""For an interrupted job to slow down and lift its pen."""
TURN_S = 5.0


Promise: TypeAlias = Callable[[int, int], int]
"""Called with how many strokes may be touched by what is sent next, and how many are certainly drawn.

Returns how many strokes are promised from now on, at least the first figure. Raises LinedrawError when it cannot.
"""


def promise_nothing(touched: int, certain: int) -> int:
    """For what leaves no stroke that anybody must know of."""
    return touched


@runtime_checkable
class _Resumable(ResumableSession, Protocol):
    """Asked of a session before it is told to go on."""


@runtime_checkable
class _Pausable(PausableSession, Protocol):
    """Asked of a session before it is paused."""


@runtime_checkable
class _Adjustable(AdjustableSession, Protocol):
    """Asked of a session before its feeds are overridden."""


def obey(session: Session, kind: Kind, value: int | None, now: float) -> None:
    """Ask a session that can for what a person wants in the middle of a job. Raises LocalProtocolError."""
    if kind == "pause" and isinstance(session, _Pausable):
        session.pause(now, at_once=bool(value))
    elif kind == "resume" and isinstance(session, _Resumable):
        session.resume(now)
    elif kind == "feed" and isinstance(session, _Adjustable) and value is not None:
        session.set_feed_percent(value, now)


class Link:
    """One session on one transport, driven by the thread that calls; only `stop`, `pause`, `resume`, `feed` and `wake`
    come from others.

    heard: is given every event, in order, in the calling thread; it must not call back.
    recorder: writes everything down. turned: called at each turn of the loop, at least every TURN_S.
    A link whose job ended by a fault is over: close it and make a new one.
    """

    def __init__(
        self,
        transport: Transport,
        session: Session,
        *,
        heard: Callable[[Event], None],
        recorder: Recorder | None = None,
        turned: Callable[[], None] | None = None,
    ) -> None:
        self._transport = transport
        self._session = session
        self._heard = heard
        self._recorder = recorder
        self._turned = turned
        self._stop_asked = threading.Event()
        self._woken = threading.Event()
        self._wishes: deque[tuple[Kind, int | None]] = deque()
        self._promise: Promise = promise_nothing
        self._promised, self._unpromised = 0, ""

    def connect(self) -> Ready:
        """Wait until the machine takes a job.

        Raises NoMachine when what answers takes none, or `stop` was called; MachineFault when it is unplugged.
        """
        for event in self._events(until=None):
            if isinstance(event, Ready):
                return event
            if isinstance(event, NotReady):
                raise NoMachine(f"{self._transport.name}: {event.why}")
            if event is None and self._stop_asked.is_set():
                self._stop_asked.clear()
                raise NoMachine(f"{self._transport.name}: stopped before the machine answered: start again")
        raise AssertionError("without a time limit the events do not end")

    def draw(self, lines: Sequence[JobLine], *, promise: Promise = promise_nothing) -> Ended:
        """Send a job and wait for its end, whatever it is; an unplugged machine is an end too.

        Before a byte of a stroke is sent for which nothing has been promised, `promise` is called; where it fails the
        job is stopped, pen up, and its error is the reason.

        A `stop` that was asked for before is obeyed before a line is sent. KeyboardInterrupt stops the job, waits
        until the pen is up, and is raised again; a second one gives up waiting. Raises MachineFault when no job can be
        started, or an interrupted one does not end.
        """
        now = self._transport.now()
        if self._recorder:
            self._recorder.started(now, lines)
        try:
            self._session.start(lines, now)
        except LocalProtocolError as fault:
            raise MachineFault(f"{self._transport.name}: {fault}") from fault
        self._promise, self._unpromised = promise, ""
        self._promised = next((line.stroke for line in lines if line.stroke is not None), 0)
        try:
            return self._until_ended(until=None)
        except KeyboardInterrupt:
            self._stop_asked.set()
            self._until_ended(until=self._transport.now() + LIFT_WITHIN_S)
            raise
        finally:
            self._stop_asked.clear()
            self._wishes.clear()
            self._promise = promise_nothing

    def listen(self, until_s: float | None) -> None:
        """Between jobs: wait until the transport's time `until_s` (None: for ever) or until `wake` or `stop`.

        Raises MachineFault when the machine restarts, alarms, falls silent or is unplugged meanwhile.
        """
        for event in self._events(until=until_s):
            if isinstance(event, NotReady):
                raise MachineFault(f"{self._transport.name}: {event.why}")
            if self._woken.is_set() or self._stop_asked.is_set():
                break
        self._woken.clear()
        self._stop_asked.clear()

    def wake(self) -> None:
        """Make `listen` return. Callable from any thread."""
        self._woken.set()
        self._transport.wake()

    def home(self, begin: Callable[[float], None]) -> Ready:
        """Have the session find the machine's home, by its own way `begin`. Raises as `connect` does."""
        now = self._transport.now()
        self._record(now, "home")
        begin(now)
        return self.connect()

    def stop(self) -> None:
        """End the drawing that is under way, pen up. Callable from any thread, returns at once."""
        self._stop_asked.set()
        self._transport.wake()

    def pause(self, *, at_once: bool) -> None:
        """Stand still with the pen up; `Paused` is heard then. Raises LinedrawError where the session cannot."""
        self._check(isinstance(self._session, _Pausable))
        self._wish("pause", at_once)

    def resume(self) -> None:
        """Go on, if it stands still. Raises LinedrawError where the session cannot."""
        self._check(isinstance(self._session, _Resumable))
        self._wish("resume")

    def feed(self, percent: int) -> None:
        """Draw at so many percent of the program's feeds, until the job ends. Raises LinedrawError where it cannot."""
        if not isinstance(self._session, _Adjustable):
            raise LinedrawError(f"{self._transport.name} cannot be made faster or slower from here")
        self._wish("feed", percent)

    def _check(self, can: bool) -> None:
        if not can:
            raise LinedrawError(f"{self._transport.name} cannot be paused from here: use the machine's own feed hold")

    def _wish(self, kind: Kind, value: int | None = None) -> None:
        self._wishes.append((kind, value))
        self._transport.wake()

    def close(self) -> None:
        """Give the port back."""
        self._transport.close()

    def _until_ended(self, *, until: float | None) -> Ended:
        try:
            for event in self._events(until=until):
                if isinstance(event, Ended):
                    return self._as_promised(event) if self._unpromised else event
                if event is None:
                    self._do_what_was_asked()
        except MachineFault:
            return self._ended_by_unplugging()
        raise MachineFault(f"{self._transport.name} did not lift the pen in time: look at the machine")

    def _do_what_was_asked(self) -> None:
        now = self._transport.now()
        while self._wishes:
            kind, value = self._wishes.popleft()
            self._record(now, kind, value)
            # What stands still no longer, or never did, has nothing to go on with.
            with suppress(LocalProtocolError):
                obey(self._session, kind, value, now)
        if self._stop_asked.is_set():
            self._record(now, "stop")
            self._session.stop(now)

    def _record(self, now: float, kind: Kind, value: int | None = None) -> None:
        if self._recorder:
            self._recorder.asked(now, kind, value)

    def _ended_by_unplugging(self) -> Ended:
        now = self._transport.now()
        self._record(now, "unplugged")
        for event in self._session.unplugged(now):
            self._heard(event)
            if isinstance(event, Ended):
                return event
        raise AssertionError("a job that runs has an end")

    def _events(self, *, until: float | None) -> Iterator[Event | None]:
        """Every event, and None before anything is sent: the moment to look at what other threads have asked for."""
        # What came while nobody listened is heard before anything is judged to be late.
        data = self._transport.read(self._transport.now())
        while True:
            yield None
            if self._turned:
                self._turned()
            now = self._transport.now()
            events = [*self._session.receive(data, now), *self._session.expire(now)]
            self._promise_strokes(now, stands=any(isinstance(event, Paused) for event in events))
            said = self._session.data_to_send(now)
            if self._recorder:
                self._recorder.turned(now, data, said, events)
            fault = self._write(said)
            for event in events:
                self._heard(event)
                yield event
            if fault is not None:
                raise fault
            if until is not None and now >= until:
                return
            data = self._transport.read(self._wait_until(until))

    def _promise_strokes(self, now: float, *, stands: bool) -> None:
        """What may come onto the sheet is written down before it can; where the pen stands, what certainly has, too."""
        touched = self._session.strokes_touched
        more = touched > self._promised
        if self._unpromised or not (more or stands):
            return
        try:
            self._promised = max(self._promised, self._promise(touched, self._session.strokes_certain))
        except LinedrawError as error:
            if not more:
                return
            self._unpromised = str(error)
            self._record(now, "stop")
            self._session.stop(now)

    def _as_promised(self, ended: Ended) -> Ended:
        """Nothing beyond the promise was sent, whatever the session was about to do."""
        possible = min(ended.strokes_possible, self._promised)
        return replace(ended, why=self._unpromised, strokes_possible=possible)

    def _write(self, data: bytes) -> MachineFault | None:
        """The fault is raised later: what the machine has said before it was unplugged comes first."""
        try:
            self._transport.write(data)
        except MachineFault as fault:
            return fault
        return None

    def _wait_until(self, until: float | None) -> float | None:
        next_turn = self._transport.now() + TURN_S if self._turned else None
        times = [at for at in (until, self._session.deadline(), next_turn) if at is not None]
        return min(times, default=None)
