"""What the loop needs of a way to a machine: bytes, a clock, and a way to be woken."""

from __future__ import annotations

from typing import Protocol


class Transport(Protocol):
    """An open way to one machine. Time is the transport's own: real for a port, simulated for a simulator."""

    @property
    def name(self) -> str:
        """For people: the device path or URL."""

    def now(self) -> float:
        """Seconds on this transport's clock; never goes back."""

    def read(self, until: float | None) -> bytes:
        """Wait for bytes until the time `until` (None: as long as it takes) or until woken, and return them.

        Empty when the time has come or `wake` was called. Raises MachineFault when the machine has been unplugged.
        """

    def write(self, data: bytes) -> None:
        """Hand all of `data` to the machine. Raises MachineFault when the machine has been unplugged."""

    def wake(self) -> None:
        """Make a `read` that waits in another thread return at once. The only call allowed from another thread."""

    def close(self) -> None:
        """Give the port back. Safe to call twice."""
