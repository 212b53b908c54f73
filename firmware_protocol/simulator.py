"""What every simulated machine offers: bytes and the time come in, bytes and ink come out; no clock of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from firmware_protocol.ink import Polyline


class Simulator(Protocol):
    """The counterpart of a `Session`: behaves like the machine, its faults included."""

    @property
    def now(self) -> float:
        """The latest time that it has been told."""

    @property
    def ink(self) -> Sequence[Polyline]:
        """What is on the sheet: polylines of (x, y) in mm, executed, not commanded."""

    def clear_sheet(self) -> None:
        """A new sheet lies under the pen: `ink` begins anew."""

    @property
    def unplugged(self) -> bool:
        """The way to it is cut: the host sees the end of the file."""

    def open(self, now: float) -> None:
        """The host opens the way to it, with all that this does to the machine."""

    def receive(self, data: bytes, now: float) -> None:
        """Bytes leave the host at `now`."""

    def advance(self, now: float) -> bytes:
        """Let the time pass up to `now`. Returns what has reached the host and was not returned before."""

    def next_time(self) -> float | None:
        """When something will next change or be said; None: nothing more until something is received."""


@runtime_checkable
class Eventful(Protocol):
    """A simulator that things can happen to while it runs."""

    def happen(self, sentence: str, now: float) -> None:
        """Something happens to the machine. Raises ValueError, naming all that can, when the sentence is not known."""


@dataclass(frozen=True, slots=True)
class Moment:
    """When a fault happens: `at_s` seconds after the port was opened, or right behind the `after_acks`-th
    acknowledgement, of a line or of a command for the queue. State one of them.
    """

    at_s: float | None = None
    after_acks: int | None = None

    def __post_init__(self) -> None:
        if (self.at_s is None) == (self.after_acks is None):
            raise ValueError(f"{type(self).__name__} needs one moment: state either at_s or after_acks")
