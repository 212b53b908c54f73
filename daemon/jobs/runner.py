"""The runner: takes jobs through their states in two loops, and takes the orders of people."""

from __future__ import annotations

import logging
import traceback
from collections.abc import Callable

from daemon.errors import LinedrawError
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


class Runner:
    """`plan_on` and `draw_on` each run in a thread of their own until `end`; everything else comes from any thread.

    The orders return a sentence for the person who gave them.
    """

    def __init__(
        self, desk: Desk, pool: Pool, planning: Planning, drawing: Drawing, pulse: Pulse | None = None
    ) -> None:
        self._desk, self._pool, self._planning, self._drawing = desk, pool, planning, drawing
        self._pulse = pulse or Pulse()

    def plan_on(self) -> None:
        heart, limit_s = self._pulse.planning, self._pool.settings.planning.time_limit_s
        self._turn_on(self._planning.turn, heart, PLANNING_WITHIN_S + limit_s)
        self._pool.close()

    def draw_on(self) -> None:
        self._turn_on(self._drawing.turn, self._pulse.drawing, DRAWING_WITHIN_S)
        self._drawing.end()

    def new_sheet(self) -> str:
        self._desk.new_sheet()
        return "a new sheet is in"

    def stop(self) -> str:
        """Hold at once, pen up, and freeze the queue."""
        self._drawing.stop()
        self._desk.hold("a person stopped the machine")
        # Once more, for a job that began in between.
        self._drawing.stop()
        return "stopped, no job starts until you say `linedrawd go`"

    def go(self) -> str:
        self._desk.go()
        return "jobs may start again"

    def cancel(self, job_id: str) -> str:
        before = self._desk.cancel(job_id)
        if before is State.PLANNING:
            self._pool.interrupt()
        elif before in UNDER_THE_PEN:
            self._drawing.stop()
        return f"job {self._desk.find(job_id).id} is dropped (it was {before.value})"

    def pause(self, *, at_once: bool) -> str:
        """Stand still with the pen up, at the end of the stroke or at once."""
        self._drawing.pause(at_once=at_once)
        return f"the machine pauses {'at once' if at_once else 'at the end of the stroke'}: `linedrawd resume` goes on"

    def resume(self) -> str:
        self._drawing.resume()
        return "the drawing goes on"

    def move(self, order: MachineOrder) -> str:
        """Between two drawings; waits until it has been done."""
        return self._drawing.ask(order)

    def end(self) -> None:
        """Hold at once, pen up; the loops come to their end."""
        self._desk.end()
        self._drawing.stop()
        self._pool.close()

    def _turn_on(self, turn: Callable[[], float], heart: Heart, within_s: float) -> None:
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
                self._drawing.stop()
                words = f"a mistake in linedrawd ({error!r}): please report it with linedrawd.log"
                self._desk.trouble(words)
                self._desk.hold(words)
                self._desk.wait(DISK_RETRY_S)
