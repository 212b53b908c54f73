"""The runner: takes jobs through their states in two loops, and takes the orders of people."""

from __future__ import annotations

import logging
import traceback
from collections.abc import Callable, Mapping, Sequence

from daemon.errors import LinedrawError, unknown
from daemon.jobs.desk import DISK_RETRY_S, Desk
from daemon.jobs.drawing import Drawing
from daemon.jobs.orders import MachineOrder
from daemon.jobs.planning import Planning
from daemon.jobs.pool import Pool
from daemon.jobs.states import UNDER_THE_PEN, State
from daemon.pulse import Heart, Pulse

DRAWING_WITHIN_S = 90.0
"""Of the drawing loop: the longest wait after a fault, and a look at every port. Its link beats more often."""
PLANNING_WITHIN_S = 150.0
"""Of the planning loop, beyond the time limit of a picture."""


_DRAINED = "a person said drain: nothing more is begun"
_ALWAYS_SO = "draw_mm_s in the settings is the speed of all drawings"


class Runner:
    """`plan_on` and a `draw_on` for each machine run in a thread of their own until `end`; the rest comes from any.

    The orders return a sentence for the person who gave them. machine: its name; with one machine it may be "", and
    with several `stop` and `pause` then mean all of them. Raises LinedrawError where it is not clear which.
    """

    def __init__(
        self, desk: Desk, pool: Pool, planning: Planning, drawings: Mapping[str, Drawing], pulse: Pulse | None = None
    ) -> None:
        """drawings: by the name of the machine."""
        self._desk, self._pool, self._planning, self._drawings = desk, pool, planning, drawings
        self._pulse = pulse or Pulse()

    def plan_on(self) -> None:
        heart, limit_s = self._pulse.planning, self._pool.settings.planning.time_limit_s
        self._turn_on(self._planning.turn, heart, PLANNING_WITHIN_S + limit_s, list(self._drawings.values()))
        self._pool.close()

    def draw_on(self, machine: str) -> None:
        drawing = self._drawings[machine]
        self._turn_on(drawing.turn, self._pulse.drawing(machine), DRAWING_WITHIN_S, [drawing])
        drawing.end()

    def new_sheet(self, machine: str = "") -> str:
        self._one(machine).station.new_sheet()
        return "a new sheet is in"

    def stop(self, machine: str = "") -> str:
        """Hold at once, pen up, and freeze the queue."""
        stopped = [self._one(machine)] if machine else list(self._drawings.values())
        for drawing in stopped:
            drawing.stop()
        for drawing in stopped:
            drawing.station.hold("a person stopped the machine")
            # Once more, for a job that began in between.
            drawing.stop()
        return f"stopped, no job starts until you say {_commands(stopped, 'go')}"

    def drain(self, machine: str = "") -> str:
        """What is being drawn is finished, and nothing more is begun."""
        station = self._one(machine).station
        station.hold(_DRAINED)
        return f"what is being drawn is finished, no further job starts until you say {station.command('go')}"

    def go(self, machine: str = "") -> str:
        drawing = self._one(machine)
        drawing.look_now()
        drawing.station.go()
        return "jobs may start again"

    def cancel(self, job_id: str) -> str:
        before = self._desk.cancel(job_id)
        job = self._desk.find(job_id)
        if before is State.PLANNING:
            self._pool.interrupt()
        elif before in UNDER_THE_PEN:
            self._drawings[job.machine].stop()
        return f"job {job.id} is dropped (it was {before.value})"

    def pause(self, machine: str = "", *, at_once: bool) -> str:
        """Stand still with the pen up, at the end of the stroke or at once."""
        every = not machine and self._desk.several
        paused = [each for each in self._drawings.values() if each.station.draws] if every else [self._one(machine)]
        if not paused:
            raise LinedrawError("nothing is being drawn: `linedrawd stop` keeps the next drawing from starting")
        for each in paused:
            each.drawn_on().pause(at_once=at_once)
        return (
            f"the machine pauses {'at once' if at_once else 'at the end of the stroke'}: "
            f"{_commands(paused, 'resume')} goes on"
        )

    def resume(self, machine: str = "") -> str:
        self._one(machine).drawn_on().resume()
        return "the drawing goes on"

    def feed(self, machine: str = "", *, percent: int) -> str:
        """Draw the rest of the running drawing at so many percent of its feeds."""
        drawing = self._one(machine)
        drawing.drawn_on(_ALWAYS_SO).feed(percent)
        drawing.station.show(feed_percent=percent)
        return f"the rest of this drawing is drawn at {percent} % of its speed"

    def move(self, order: MachineOrder, machine: str = "") -> str:
        """Between two drawings; waits until it has been done."""
        return self._one(machine).asked.ask(order)

    def placed(self, machine: str) -> bool:
        """This machine knows where the sheet's origin is."""
        return self._drawings[machine].placed

    def _one(self, machine: str) -> Drawing:
        names = list(self._drawings)
        if machine in self._drawings:
            return self._drawings[machine]
        if machine:
            raise LinedrawError(unknown(f"the machine {machine}", machine, names))
        if len(names) > 1:
            raise LinedrawError(f"which machine? say --machine and one of {', '.join(names)}")
        return self._drawings[names[0]]

    def end(self) -> None:
        """Hold at once, pen up; the loops come to their end."""
        self._desk.end()
        for drawing in self._drawings.values():
            drawing.stop()
        self._pool.close()

    def _turn_on(self, turn: Callable[[], float], heart: Heart, within_s: float, drawings: Sequence[Drawing]) -> None:
        """drawings: what is stopped by a mistake of ours."""
        while not self._desk.ending:
            heart.within(within_s)
            seen = self._desk.changes
            try:
                self._desk.wait(turn(), since=seen)
            except LinedrawError as error:
                self._desk.trouble(str(error))
                self._desk.wait(DISK_RETRY_S)
            except Exception as error:
                # A mistake of ours must not start anything: what the machine does is no longer known.
                self._desk.say(traceback.format_exc(), level=logging.ERROR)
                for drawing in drawings:
                    drawing.stop()
                words = f"a mistake in linedrawd ({error!r}): please report it with linedrawd.log"
                self._desk.trouble(words)
                for drawing in drawings:
                    drawing.station.hold(words)
                self._desk.wait(DISK_RETRY_S)


def _commands(drawings: Sequence[Drawing], order: str) -> str:
    """How each of them is told."""
    return ", ".join(drawing.station.command(order) for drawing in drawings)
