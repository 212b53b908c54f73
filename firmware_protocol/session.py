"""What every session offers: bytes and the time come in, events and bytes go out. No port, no clock, no thread.

The one loop that moves bytes (`daemon/machine/link.py`) does, again and again:

    events = session.receive(data, now)      # what the machine said
    events += session.expire(now)            # what it should have said by now
    port.write(session.data_to_send(now))    # what we have to say
    wait until session.deadline() or data
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Literal, Protocol, TypeAlias


class Verdict(Enum):
    """How a job ended. `FINISHED` is said only when the last ink is on the paper."""

    FINISHED = "finished"
    STOPPED = "stopped"
    REJECTED = "rejected"
    ALARM = "alarm"
    RESTARTED = "restarted"
    SILENT = "silent"
    ASTRAY = "astray"
    UNPLUGGED = "unplugged"


@dataclass(frozen=True, slots=True)
class Ready:
    """The machine has introduced itself and takes a job."""

    firmware: str
    buffer_bytes: int


@dataclass(frozen=True, slots=True)
class NotReady:
    """Something answers, but it takes no job: `why` says what, and what to do."""

    why: str


@dataclass(frozen=True, slots=True)
class Accepted:
    """The machine has acknowledged line `line` (0-based) of the job: parsed and planned, not yet drawn."""

    line: int


@dataclass(frozen=True, slots=True)
class Status:
    """A status report: the controller's own word for its state, and where the pen is."""

    state: str
    position_mm: tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Sent:
    """The whole job has been handed over to a machine that does not say when it has drawn it.

    drawn_in_s: how long that will take from now on, by the time model.
    """

    drawn_in_s: float


@dataclass(frozen=True, slots=True)
class Finding:
    """Something about the machine that a drawing wants otherwise.

    about: what was looked at, such as "$13" or "travel". command: the line that mends it; "" where none does.
    blocks: the drawing would come out wrong, so it is not begun.
    """

    about: str
    why: str
    command: str = ""
    blocks: bool = False


@dataclass(frozen=True, slots=True)
class Found:
    """A finding about the job that is being begun; `mended`: the session has set it right, as it is allowed to.

    What was found about the job before and does not keep this one from being drawn is not told again.
    """

    finding: Finding
    mended: bool = False


@dataclass(frozen=True, slots=True)
class Paused:
    """The machine stands with the pen up, the job goes on with `resume`. stroke: the one that is drawn next.

    None: no stroke is left. at_mm: where the running stroke was cut; None after a whole one. change: the program wants
    another pen here, and the machine is parked; also: what a person does at the machine beside that, in words.
    """

    stroke: int | None
    at_mm: tuple[float, float] | None = None
    change: bool = False
    also: str = ""


@dataclass(frozen=True, slots=True)
class Waiting:
    """The machine waits for a person: `why` says what happened, and what to press.

    cause: what has stopped the pen on its way, its feed hold or its door, or motors without current; "" where nothing
    was moving.
    """

    why: str
    cause: Literal["hold", "door", "sleep", ""] = ""


@dataclass(frozen=True, slots=True)
class Resumed:
    """The machine goes on with the job, after `Paused` or `Waiting`."""


@dataclass(frozen=True, slots=True)
class Ended:
    """The job is over, once and for ever: no line of it is sent after this event.

    strokes_certain: the first n strokes are certainly drawn whole. strokes_possible: not one stroke after the first n
    has been touched. position_known: the machine still knows where its pen is. pen_lifted: the pen is known to be up.
    why: a sentence that says what happened, where (line, its text) and what to do.
    estimated: the machine has not said so, the end was computed by the time model.
    """

    verdict: Verdict
    strokes_certain: int
    strokes_possible: int
    position_known: bool
    pen_lifted: bool
    why: str
    estimated: bool = False


Event: TypeAlias = Ready | NotReady | Accepted | Status | Sent | Ended | Found | Paused | Waiting | Resumed


class JobLine(Protocol):
    """One line of a job and the stroke it belongs to (None: before the first or after the last)."""

    @property
    def text(self) -> str: ...

    @property
    def stroke(self) -> int | None: ...


class Session(Protocol):
    """One conversation with one machine, from opening the port to closing it."""

    def receive(self, data: bytes, now: float) -> list[Event]:
        """Take what came from the machine, however it is chunked. Noise raises nothing but ProtocolError."""

    def expire(self, now: float) -> list[Event]:
        """What follows from silence: call it when `deadline()` has come."""

    def deadline(self) -> float | None:
        """When `expire` or `data_to_send` wants to be called again even if nothing comes; None: only on data."""

    def data_to_send(self, now: float) -> bytes:
        """What is to be written now; empty when nothing may be."""

    def start(self, job: Sequence[JobLine], now: float) -> None:
        """Begin a job. Raises LocalProtocolError when the machine is not ready for one."""

    def stop(self, now: float) -> None:
        """Stop at once without losing the position, lift the pen, end the job with `Ended(STOPPED)`."""

    def unplugged(self, now: float) -> list[Event]:
        """The port is gone: what that means for the job."""

    @property
    def strokes_touched(self) -> int:
        """No stroke of the running job from this number on was handed out, or will be by the next `data_to_send`.

        Whoever must write down what may be on the sheet asks before each `data_to_send`. 0 without a job.
        """

    @property
    def strokes_certain(self) -> int:
        """The first n strokes of the running job are certainly drawn, as far as is known now. 0 without a job."""


class ResumableSession(Session, Protocol):
    """A session that stands still where its job wants another pen, and goes on."""

    def resume(self, now: float) -> None:
        """Go on after `Paused`, or tell a machine that is `Waiting` to. Raises LocalProtocolError when neither is."""


class PausableSession(ResumableSession, Protocol):
    """A session that can also stand still anywhere else in the middle of a job."""

    def pause(self, now: float, *, at_once: bool = False) -> None:
        """Stand still with the pen up, at the end of the running stroke or at once; `Paused` is said when it does."""


class AdjustableSession(Session, Protocol):
    """A session that can draw faster or slower in the middle of a job."""

    def set_feed_percent(self, percent: int, now: float) -> None:
        """Draw the rest of the running job at so many percent of its feeds; the next job begins with 100.

        Raises ValueError outside 10 to 200.
        """
