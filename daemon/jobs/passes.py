"""The pens of a drawing that is under way, one after the other: which one is in, and what each has left."""

from __future__ import annotations

from collections.abc import Callable

from daemon.jobs.open_machine import InkMm
from daemon.jobs.station import Station
from daemon.shapes import Program
from firmware_protocol.session import Event, Paused


class Passes:
    """Tells at the station which pen must be in, from the first one on.

    take_ink: what a simulated machine has drawn since the last call; None on one of metal.
    """

    def __init__(self, station: Station, job_id: str, program: Program, take_ink: Callable[[], InkMm | None]) -> None:
        self._station, self._program, self._take_ink = station, program, take_ink
        self._ink: list[InkMm | None] = []
        self._pens: list[str] = []
        self._put_in(next((line.stroke for line in program.lines if line.stroke is not None), 0))
        if station.pen_in:
            station.say(f"the {station.pen_in} pen draws first", job=job_id)

    def hear(self, event: Event) -> None:
        if isinstance(event, Paused) and event.change and event.stroke is not None:
            self._keep()
            self._put_in(event.stroke)

    def ink(self) -> tuple[InkMm | None, list[str]]:
        """All that a simulated machine has drawn, and with which pen each line of it; no pens where none has a name."""
        self._keep()
        simulated = [ink for ink in self._ink if ink is not None]
        return ([line for ink in simulated for line in ink] if simulated else None), self._pens

    def _put_in(self, stroke: int) -> None:
        self._station.pen_in = self._program.pen_of(stroke)
        self._station.show(pen_in=self._station.pen_in)

    def _keep(self) -> None:
        ink, pen = self._take_ink(), self._station.pen_in
        self._ink.append(ink)
        self._pens += [pen] * len(ink or ()) if pen else []
