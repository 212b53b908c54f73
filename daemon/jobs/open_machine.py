"""What drawing and machine orders need of a machine whose port is open."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol, TypeAlias

from daemon.machine.link import Promise, promise_nothing
from daemon.shapes import Program
from firmware_protocol.ink import Vector
from firmware_protocol.session import Ended, Event, Ready

InkMm: TypeAlias = Sequence[Sequence[tuple[float, float]]]
Open: TypeAlias = Callable[[Callable[[Event], None], bool], "OpenMachine"]
"""Opens the way to the machine; is given whom to tell what is heard, and whether nothing may move by itself."""


class OpenMachine(Protocol):
    """A machine whose port is open. Only `stop`, `pause`, `resume` and `feed` may be called from other threads."""

    @property
    def name(self) -> str:
        """For people: the device path or URL."""

    def now(self) -> float:
        """Seconds on the machine's clock: real for a port, simulated for a simulator."""

    def connect(self) -> Ready:
        """Wait until it has introduced itself. Raises NoMachine or MachineFault."""

    def draw(self, program: Program, promise: Promise = promise_nothing) -> Ended:
        """Stream the program; returns when the job is over, however it ended. promise: see `Link.draw`."""

    def listen(self) -> None:
        """Hear what came meanwhile. Raises MachineFault when the machine is no longer there or not ready."""

    def line_times_s(self, program: Program) -> Sequence[float]:
        """When each line of the program will have been drawn, in seconds from its start."""

    def take_ink(self) -> InkMm | None:
        """What the last job has drawn, where the machine is simulated."""

    def position_mm(self) -> Vector | None:
        """Where the pen is, in the coordinates of its programs; None when the machine does not say."""

    def count_from(self, corner_mm: tuple[float, float]) -> None:
        """X0 Y0 of every program from now on lies here, until the port is closed."""

    @property
    def rests(self) -> str:
        """Why no job can be begun until the machine is homed or gets an origin; "" when one can."""

    def home(self, program: Program) -> Ended:
        """Find the machine's home, by this program where the session cannot do it."""

    def check(self, program: Program) -> Sequence[str]:
        """What the machine says of itself, and what this program would want otherwise: lines for a person."""

    def lift(self) -> bool:
        """Raise the pen where it stands. False when it cannot be known to be up."""

    def pause(self, *, at_once: bool) -> None:
        """Stand still with the pen up, at the end of the stroke or at once. Raises LinedrawError where it cannot."""

    def resume(self) -> None:
        """Go on with the job. Raises LinedrawError where the machine cannot pause."""

    def feed(self, percent: int) -> None:
        """Draw at so many percent of the program's feeds, until the job ends. Raises LinedrawError where it cannot."""

    def stop(self) -> None:
        """Hold at once, lift the pen, end the job."""

    def close(self) -> None: ...
