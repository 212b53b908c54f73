"""Drives a session by what a controller says and when, as in a play."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from firmware_protocol.grbl.habits import Patience
from firmware_protocol.grbl.session import GrblSession
from firmware_protocol.session import Ended, Event, Status

BANNER = "Grbl 1.1h ['$' for help]"
UNLOCK = "[MSG:'$H'|'$X' to unlock]"
IDLE = "<Idle|MPos:0.000,0.000,0.000|FS:0,0>"
DONE = "<Idle|MPos:4.000,0.000,5.000|FS:0,0>"
"""Where `two_strokes` and the lift end."""
RUN = "<Run|MPos:1.000,0.000,0.000|FS:500,0>"
HELD = "<Hold:0|MPos:8.800,0.000,0.000|FS:0,0>"
ALARM = "<Alarm|MPos:0.000,0.000,0.000|FS:0,0>"
INFO = ("[VER:1.1h.20190825:]", "[OPT:V,15,128]", "ok")
SETTINGS = ("$1=255", "$13=0", "$110=500.000", "ok")
LIFT = ("G90 G21", "G0 Z5")
BARRIER = b"G4 P0.01\n"


@dataclass(frozen=True, slots=True)
class Line:
    """One line of a job."""

    text: str
    stroke: int | None = None


class Play:
    """A session, its clock, and all that it has said and told so far."""

    def __init__(self, **options: Any) -> None:
        self.now = 100.0
        waits = {name: options.pop(name) for name in list(options) if name in Patience.__dataclass_fields__}
        self.session = GrblSession(now=self.now, patience=Patience(**{"silent_after_s": 5.0} | waits), **options)
        self.sent = b""
        self.events: list[Event] = []

    def say(self, *lines: str) -> bytes:
        """The controller says lines; returns what the session then sends."""
        return self.hear("".join(f"{line}\r\n" for line in lines).encode("latin-1"))

    def hear(self, data: bytes) -> bytes:
        self.events += self.session.receive(data, self.now)
        return self.send()

    def wait(self, seconds: float) -> bytes:
        """Time passes as the loop lets it: from one deadline to the next; returns what was sent meanwhile."""
        until, sent = self.now + seconds, b""
        while True:
            deadline = self.session.deadline()
            self.now = until if deadline is None else min(until, max(self.now, deadline))
            self.events += self.session.expire(self.now)
            sent += self.send()
            if self.now >= until:
                return sent

    def send(self) -> bytes:
        data = self.session.data_to_send(self.now)
        self.sent += data
        return data

    def start(self, *lines: Line) -> bytes:
        self.session.start(lines, self.now)
        return self.send()

    def stop(self) -> bytes:
        self.session.stop(self.now)
        self.events += self.session.expire(self.now)
        return self.send()

    @property
    def ended(self) -> Ended:
        """The one end of the job."""
        (end,) = [event for event in self.events if isinstance(event, Ended)]
        return end

    @property
    def told(self) -> Sequence[Event]:
        """All events but the status reports."""
        return [event for event in self.events if not isinstance(event, Status)]


def ready(**options: Any) -> Play:
    """A controller that has introduced itself."""
    play = Play(**options)
    for lines in ((BANNER,), (IDLE,), INFO, SETTINGS):
        play.say(*lines)
    play.events.clear()
    return play


def drawing(*lines: Line, **options: Any) -> Play:
    """A job whose first lines have been sent; two strokes of two lines when none is given."""
    play = ready(**{"lift": LIFT} | options)
    play.start(*(lines or two_strokes()))
    return play


def two_strokes() -> tuple[Line, ...]:
    return Line("G1X1F500", 0), Line("X2", 0), Line("X3", 1), Line("X4", 1)
