"""The pens of a drawing that is under way, one after the other: which one is in, and what each has left."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from daemon.jobs.open_machine import InkMm
from daemon.jobs.station import Station
from daemon.shapes import Program, ProgramLine
from firmware_protocol.pens import PEN_CHANGE, is_pen_change
from firmware_protocol.session import Ended, Event, Paused, Resumed, Verdict


def with_its_pen(left: Program, whole: Program, *, pen_in: str | None, goes_on: bool) -> Program:
    """What is left of the whole program, begun by a pen change where another pen may be in than its first.

    pen_in: see `Station`. Where nobody has said anything yet, the first pen of a drawing is in, as a person drops the
    picture then; goes_on: not so that of one that goes on with a drawing.
    """
    first = _first_stroke(left)
    if left.pen_of(first) in ("", pen_in) or (pen_in is None and not goes_on):
        return left
    begins = next((number for number, line in enumerate(left.lines) if line.stroke is not None), len(left.lines))
    return replace(left, lines=(*left.lines[:begins], *_change_before(whole, first), *left.lines[begins:]))


def _change_before(whole: Program, stroke: int) -> Sequence[ProgramLine]:
    """Park and stop, as the program does it before the pen of this stroke; the first one is put in where it stands."""
    begins = max((first for first in whole.passes if first <= stroke), default=0)
    stops = [line.stroke == begins - 1 and is_pen_change(line.text) for line in whole.lines]
    stop = stops.index(True) if any(stops) else None
    texts = [PEN_CHANGE] if stop is None else [line.text for line in whole.lines[stop - 1 : stop + 1]]
    return [ProgramLine(text) for text in texts]


def _first_stroke(program: Program) -> int:
    return next((line.stroke for line in program.lines if line.stroke is not None), 0)


class Passes:
    """Tells at the station which pen must be in, from the first one on.

    take_ink: what a simulated machine has drawn since the last call; None on one of metal.
    """

    def __init__(self, station: Station, job_id: str, program: Program, take_ink: Callable[[], InkMm | None]) -> None:
        self._station, self._program, self._take_ink = station, program, take_ink
        self._ink: list[InkMm | None] = []
        self._pens: list[str] = []
        self._wants(_first_stroke(program))
        if self.pen:
            station.pen_in = self.pen
            station.say(f"the {self.pen} pen draws first", job=job_id)

    def hear(self, event: Event) -> None:
        if isinstance(event, Paused) and event.change and event.stroke is not None:
            self._keep()
            self._wants(event.stroke)
            self._station.pen_in = ""
        elif isinstance(event, Resumed) and self.pen:
            self._station.pen_in = self.pen

    def over(self, ended: Ended) -> tuple[InkMm | None, list[str]]:
        """All that a simulated machine has drawn, and with which pen each line of it; no pens where none has a name."""
        self._keep()
        last = self._program.pen_of(ended.strokes_possible - 1)
        if last != self._station.pen_in and self.pen:
            # A control that has the whole program changes its pens by itself.
            self._station.pen_in = last if ended.verdict is Verdict.FINISHED else ""
        simulated = [ink for ink in self._ink if ink is not None]
        return ([line for ink in simulated for line in ink] if simulated else None), self._pens

    def _wants(self, stroke: int) -> None:
        self.pen = self._program.pen_of(stroke)
        """What the pen is called that must be in; "" where pens have no names."""
        self._station.show(pen_in=self.pen)

    def _keep(self) -> None:
        ink = self._take_ink()
        self._ink.append(ink)
        self._pens += [self.pen] * len(ink or ()) if self.pen else []
