"""The sender's side of a conversation with a GRBL 1.1 controller, from the banner to the last answer."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from firmware_protocol.errors import RemoteProtocolError
from firmware_protocol.grbl import flow as flows
from firmware_protocol.grbl import replies, sentences
from firmware_protocol.grbl.controller import Controller
from firmware_protocol.grbl.conversation import RESET, USUAL_POLL_S, Conversation, Habits
from firmware_protocol.grbl.states import POLLED, SENDING, Signal, State
from firmware_protocol.grbl.watch import Watch
from firmware_protocol.lines import LineReader
from firmware_protocol.session import Event, JobLine

ASK = b"?"

BOOT_S = 2.0
"""A boot loader is deaf for up to 2 s after the port was opened; what is said to it earlier is lost."""
PATIENCE_S = 1.5
"""Then `?` is asked, and a controller that has not answered after this long is reset."""


class GrblSession:
    """`firmware_protocol.session.Session` for GRBL 1.1.

    now: the time at which the port was opened. flow: "count" fills the controller's buffer by counting characters,
    "line" waits for each answer (for clones that lose bytes). lift: G-code lines that raise the pen from wherever it
    is, in a controller that has just been reset; they also end every job, so that `pen_lifted` is known. home: run
    `$H` at start-up, which also opens the homing lock; `$X` is never sent.
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
        silent_after_s: float = 5.0,
        banner_within_s: float = 6.0,
        home_within_s: float = 300.0,
    ) -> None:
        """Raises LocalProtocolError when a lift line is one that no controller takes."""
        flows.check(lift, buffer_bytes=Controller().buffer_bytes)
        habits = Habits(flow == "count", tuple(lift), lift_after_restart, home)
        self._silent_after_s = silent_after_s
        self._limits_s = dict.fromkeys((State.RESETTING, State.RESTARTED, State.EMPTYING, State.ASKING), silent_after_s)
        self._limits_s |= dict.fromkeys((State.WAITING, State.GREETED), banner_within_s) | {State.HOMING: home_within_s}
        self._knocks = [(now + BOOT_S, ASK), (now + BOOT_S + PATIENCE_S, RESET)]
        self._watch = Watch(now=now, silent_after_s=silent_after_s)
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
        talk, limit_s = self._talk, self._limits_s.get(self._talk.state)
        talk.now = now
        if limit_s is not None and now >= talk.since + limit_s:
            talk.too_late(limit_s)
        elif self._asking and self._watch.silent(now):
            talk.go(Signal.SILENCE, sentences.silent(self._silent_after_s))
        elif self._asking and self._watch.doubtful and self._watch.stuck(now, dwell_s=talk.flow.dwell_s):
            line = talk.flow.answered
            talk.go(Signal.STUCK, sentences.stuck(self._silent_after_s, line + 1, talk.flow.text(line)))
        return self._told()

    def deadline(self) -> float | None:
        """See `Session.deadline`."""
        talk = self._talk
        if talk.events or talk.urgent:
            return talk.now
        times = [at for at, _ in self._knocks[:1] if talk.state is State.WAITING]
        if talk.state in self._limits_s:
            times.append(talk.since + self._limits_s[talk.state])
        if self._asking:
            times.append(self._watch.deadline())
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
        if self._talk.flow.homing:
            self._talk.go(Signal.ABORT, sentences.STOPPED_HOMING)
        else:
            self._talk.go(Signal.STOP, sentences.STOPPED)

    def unplugged(self, now: float) -> list[Event]:
        """See `Session.unplugged`."""
        self._talk.now = now
        self._talk.go(Signal.UNPLUG, sentences.UNPLUGGED)
        return self._told()

    @property
    def _asking(self) -> bool:
        return self._talk.state in POLLED and not self._talk.flow.homing

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
