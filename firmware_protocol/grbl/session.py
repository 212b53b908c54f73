"""The sender's side of a conversation with a GRBL 1.1 controller, from the banner to the last answer."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Literal

from firmware_protocol.errors import RemoteProtocolError
from firmware_protocol.grbl import flow as flows
from firmware_protocol.grbl import replies, sentences
from firmware_protocol.grbl.controller import Controller
from firmware_protocol.grbl.conversation import Conversation
from firmware_protocol.grbl.findings import findings, needs_of
from firmware_protocol.grbl.habits import ASK, RESET, USUAL_POLL_S, Habits, Patience
from firmware_protocol.grbl.job import Job
from firmware_protocol.grbl.states import POLLED, RUNNING, SENDING, TRANSITIONS, Signal, State
from firmware_protocol.grbl.watch import Watch
from firmware_protocol.lines import LineReader
from firmware_protocol.session import Event, Finding, JobLine

BOOT_S = 2.0
"""A boot loader is deaf for up to 2 s after the port was opened; what is said to it earlier is lost."""
PATIENCE_S = 1.5
"""Then `?` is asked, and a controller that has not answered after this long is reset."""


USUAL_PATIENCE = Patience()

_BRIEF = (
    State.RESETTING,
    State.RESTARTED,
    State.EMPTYING,
    State.ASKING,
    State.PLACING,
    State.SETTING,
    State.LEAVING,
    State.SWITCHING,
    State.RELEASING,
)
"""States that last well below a second."""


class GrblSession:
    """`firmware_protocol.session.Session` for GRBL 1.1.

    now: the time at which the port was opened. flow: "count" fills the controller's buffer by counting characters,
    "line" waits for each answer (for clones that lose bytes). lift: G-code lines that raise the pen from wherever it
    is, in a controller that has just been reset; they also end every job, so that `pen_lifted` is known. home: run
    `$H` at start-up, which also opens the homing lock; `$X` is never sent. may_set: settings that a job wants otherwise
    are written, only where the value differs, one at a time, and read back. dry_run: every job is first run in check
    mode, without motion. Once `patience` has the motors switched off, the place of the pen is unknown and no job is
    taken until `home` or `set_origin`.
    After NotReady, and after every verdict but FINISHED, STOPPED and REJECTED with a known position, the session is
    over: open the port again. Methods: Grbl 1.1 interface document (character counting, real-time commands).
    """

    def __init__(
        self,
        *,
        now: float,
        flow: Literal["count", "line"] = "count",
        lift: Sequence[str] = (),
        lift_after_restart: bool = True,
        home: bool = False,
        may_set: bool = False,
        dry_run: bool = False,
        patience: Patience = USUAL_PATIENCE,
    ) -> None:
        """Raises LocalProtocolError when a lift line is one that no controller takes."""
        flows.check(lift, buffer_bytes=Controller().buffer_bytes)
        habits = Habits(flow == "count", tuple(lift), lift_after_restart, home, may_set, dry_run)
        self._patience, silent_s = patience, patience.silent_after_s
        self._limits_s = dict.fromkeys(_BRIEF, silent_s) | {State.HOMING: patience.home_within_s}
        self._limits_s |= dict.fromkeys((State.WAITING, State.GREETED), patience.banner_within_s)
        self._homing_since: float | None = None
        self._knocks = [(now + BOOT_S, ASK), (now + BOOT_S + PATIENCE_S, RESET)]
        self._watch = Watch(now=now, silent_after_s=silent_s)
        self._lines = LineReader()
        self._talk = Conversation(habits, self._watch, now=now)

    @property
    def state(self) -> State:
        """Where the conversation stands."""
        return self._talk.state

    @property
    def firmware(self) -> str | None:
        """What the controller calls itself; None until something has said that it is GRBL."""
        return self._talk.controller.firmware

    @property
    def settings(self) -> dict[int, float]:
        """The controller's `$` settings by number, complete once Ready has been said."""
        return self._talk.controller.settings

    def receive(self, data: bytes, now: float) -> list[Event]:
        """See `Session.receive`. Never raises: lines without an end are an event too."""
        self._talk.now = now
        try:
            for line in self._lines.feed(data):
                self._talk.hear(replies.parse(line))
        except RemoteProtocolError as fault:
            self._talk.go(Signal.SILENCE, sentences.noise(str(fault)))
        return self._told()

    def expire(self, now: float) -> list[Event]:
        """See `Session.expire`."""
        self._talk.now = now
        for at, what in self._limits():
            if now >= at:
                what()
                break
        return self._told()

    def deadline(self) -> float | None:
        """See `Session.deadline`."""
        talk = self._talk
        if talk.events or talk.urgent:
            return talk.now
        times = [at for at, _ in self._knocks[:1] if talk.state is State.WAITING]
        times += [at for at, _ in self._limits()]
        if self._asking:
            times.append(self._watch.ask_at)
        return min(times, default=None)

    def data_to_send(self, now: float) -> bytes:
        """See `Session.data_to_send`."""
        talk = self._talk
        talk.now = now
        data, talk.urgent = talk.urgent, b""
        if talk.state is State.WAITING:
            data += self._knock(now)
        if self._asking:
            data += self._watch.ask(now)
        if talk.state in SENDING:
            data += talk.flow.take()
        if talk.state in RUNNING:
            data += talk.feed.step(now)
        if not talk.flow.homing:
            self._homing_since = None
        elif self._homing_since is None:
            self._homing_since = now
        return data

    def start(self, job: Sequence[JobLine], now: float) -> None:
        """See `Session.start`. `$` lines may stand only before the first G-code line; strokes never fall.

        Raises LocalProtocolError when the machine is not ready or cannot take one of the lines.
        """
        self._talk.now = now
        self._talk.begin(job)

    def stop(self, now: float) -> None:
        """See `Session.stop`; without a job, and while one is already ending, it changes nothing.

        A feed hold has no effect while the machine homes: there the controller is reset and forgets its position.
        """
        self._talk.now = now
        self._talk.stop()

    def pause(self, now: float, *, at_once: bool = False) -> None:
        """See `PausableSession.pause`; without a job that moves, and while it homes, it changes nothing.

        Behind the stroke: of the last line that was sent. At once: feed hold, reset, lift; going on begins a little
        before the cut. Raises LocalProtocolError when a pause at once is wanted without lines that raise the pen.
        """
        self._talk.now = now
        self._talk.pause(at_once=at_once)

    def resume(self, now: float) -> None:
        """See `PausableSession.resume`."""
        self._talk.now = now
        self._talk.resume()

    def set_feed_percent(self, percent: int, now: float) -> None:
        """See `AdjustableSession.set_feed_percent`; it takes up to some seconds, and moves by G0 stay as they are."""
        self._talk.now = now
        self._talk.feed.want(percent)

    def home(self, now: float) -> None:
        """Find the home with `$H` between two jobs; `Ready` is said at its end. Raises LocalProtocolError."""
        self._talk.now = now
        self._talk.home()

    def set_origin(self, now: float) -> None:
        """The pen stands over X0 Y0: store that (G54), then say `Ready`. Raises LocalProtocolError within a job."""
        self._talk.now = now
        self._talk.place()

    def findings(self, job: Sequence[JobLine] = ()) -> list[Finding]:
        """What the machine has otherwise than `job` wants it; complete once Ready has been said. Changes nothing.

        Raises LocalProtocolError for a line that the controller cannot take.
        """
        talk = self._talk
        controller = talk.controller
        path = Job(job, lift=talk.habits.lift, controller=controller, counting=talk.habits.counting).leg.path
        needs = needs_of(path, offset_mm=controller.offset_mm, firmware=self.firmware or "", letters=controller.letters)
        return findings(controller.settings, needs)

    def unplugged(self, now: float) -> list[Event]:
        """See `Session.unplugged`."""
        self._talk.now = now
        self._talk.go(Signal.UNPLUG, sentences.UNPLUGGED)
        return self._told()

    @property
    def strokes_touched(self) -> int:
        """See `Session.strokes_touched`."""
        talk = self._talk
        if talk.job is None:
            return 0
        return talk.job.touched(next_too=talk.state in SENDING and talk.flow is talk.job.leg.flow)

    @property
    def strokes_certain(self) -> int:
        """See `Session.strokes_certain`."""
        return 0 if self._talk.job is None else self._talk.job.certain

    @property
    def _asking(self) -> bool:
        return self._talk.state in POLLED and not self._talk.flow.homing

    def _limits(self) -> Iterator[tuple[float, Callable[[], None]]]:
        """When something has lasted too long, and what follows."""
        talk, watch, patience = self._talk, self._watch, self._patience
        if (limit_s := self._limits_s.get(talk.state)) is not None:
            yield talk.since + limit_s, lambda: talk.too_late(limit_s)
        if self._homing_since is not None and talk.state is not State.HOMING:
            yield self._homing_since + patience.home_within_s, lambda: talk.too_late(patience.home_within_s)
        if talk.state is State.READY and patience.motors_off_after_min is not None:
            yield talk.since + 60 * patience.motors_off_after_min, talk.rest
        if self._asking and (silent_at := watch.silent_at) is not None:
            yield silent_at, lambda: talk.go(Signal.SILENCE, sentences.silent(patience.silent_after_s))
        if (talk.state, Signal.STUCK) in TRANSITIONS and not talk.flow.homing:
            stuck_at = watch.stuck_at(dwell_s=talk.flow.dwell_s)
            yield from [] if stuck_at is None else [(stuck_at, self._stuck)]

    def _stuck(self) -> None:
        number, text = self._talk.named(self._talk.flow.answered)
        self._talk.go(Signal.STUCK, sentences.stuck(self._patience.silent_after_s, number, text))

    def _knock(self, now: float) -> bytes:
        """`?`, then a reset; a controller that answered but moves is asked again until it stands."""
        if not self._knocks or now < self._knocks[0][0]:
            return b""
        _, what = self._knocks.pop(0)
        if not self._talk.found:
            return what
        self._knocks = [(now + USUAL_POLL_S, ASK)]
        return ASK

    def _told(self) -> list[Event]:
        events, self._talk.events = self._talk.events, []
        return events
