"""The station: where one machine stands at the desk; what holds it up, which job it takes next, what is told of it."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from daemon.errors import DiskTrouble
from daemon.jobs.desk import GONE, Desk
from daemon.jobs.journal import Job
from daemon.jobs.record import write_record
from daemon.jobs.states import UNDER_THE_PEN, Reason, State


class Station:
    """One of the desk's machines. Calls come from any thread.

    show: changed fields of its part of the status. alike: whether a plan for another machine is one for this machine.
    """

    def __init__(
        self,
        desk: Desk,
        name: str,
        *,
        show: Callable[..., None],
        asks_for_sheets: bool,
        alike: Callable[[str], bool] = lambda other: False,
    ) -> None:
        self.desk, self.name, self.show, self._alike = desk, name, show, alike
        self._asks_for_sheets = asks_for_sheets
        self.cut_off = False
        """The daemon before this one was killed while it drew, so that nobody has lifted the pen."""
        self.free = False
        """It has asked for a job, and there was none for it."""
        self.missing = False
        """There is no machine, or none that can begin."""
        self.pen_in: str | None = None
        """What the pen is called that is in; "" where it may be another one, None before anybody has said so."""
        desk.stations[name] = self

    @property
    def held(self) -> str:
        """Why it begins no job, in a sentence; empty when it may."""
        return self.desk.journal.kept.of(self.name).held

    @property
    def draws(self) -> bool:
        return self._under_the_pen() is not None

    def _under_the_pen(self) -> Job | None:
        drawing = self.desk.journal.jobs(*UNDER_THE_PEN) if self.desk.journal.count(*UNDER_THE_PEN) else []
        return next((job for job in drawing if self.desk.station(job.machine) is self), None)

    @property
    def away(self) -> bool:
        """It will begin no job before a person, or a plug, has done something."""
        return bool(self.held) or self.missing or (self.wants_a_sheet and not self.draws)

    @property
    def wants_a_sheet(self) -> bool:
        return self._asks_for_sheets and self.desk.journal.kept.of(self.name).sheet_used

    def command(self, order: str) -> str:
        """How a person says this order to this machine."""
        return f"`linedrawd {order} --machine {self.name}`" if self.desk.several else f"`linedrawd {order}`"

    def say(self, words: str, **values: Any) -> None:
        """Where there are several machines, with this one's name."""
        self.desk.say(words, **values, **({"machine": self.name} if self.desk.several else {}))

    def trouble(self, words: str, *, job: str = "") -> None:
        """Say an error, once until something has gone well again."""
        self.desk.trouble(f"{self.name}: {words}" if self.desk.several else words, job=job)

    def recover(self) -> None:
        """After a start. A machine that nobody has heard of is held where one that is no longer set was."""
        kept = self.desk.journal.kept
        for name, why in kept.held().items():
            if name not in self.desk.stations and not kept.knows(self.name):
                self.hold(f"{name}, which is not set any more, was held ({why})")
        if self.held:
            self.show_now()

    def may_take(self, job: Job) -> bool:
        """It, or a machine that is set alike, is the one that the job was planned for."""
        if job.bound_to not in ("", self.name):
            return False
        mine = self.desk.station(job.machine) is self
        # What is half drawn lies on this machine's sheet, or on that one's.
        return mine or (not job.possible and self._alike(job.machine))

    def begin_drawing(self) -> Job | None:
        """The next job for it, now in drawing; None while there is none or something holds it up."""
        with self.desk.changed:
            ready = self._ready()
            self._set_free(not (ready or self.desk.ending or self.held or self.wants_a_sheet))
            if self.desk.ending or self.held or not ready:
                return None
            if self.wants_a_sheet and not ready[0].possible:
                self.let_wait(f"waiting for a new sheet: put one in and say {self.command('next')}")
                return None
            return self._begin(ready[0])

    def _set_free(self, free: bool) -> None:
        was_free, self.free = self.free, free
        if free and not was_free and self.desk.several:
            # Whoever plans may give it what another machine cannot begin now.
            self.desk.wake()

    def lost(self, *, missing: bool) -> None:
        """missing: there is no machine any more, or none that can begin; False: there is one again."""
        self.missing, self.free = missing, False
        self.desk.wake()

    def _ready(self) -> list[Job]:
        """What goes on with a drawing comes first: its sheet lies under the pen."""
        mine = [job for job in self.desk.ready() if self.may_take(job)]
        return sorted(mine, key=lambda job: not job.possible)

    def _begin(self, job: Job) -> Job | None:
        begun = replace(job, state=State.DRAWING, machine=self.name)
        try:
            write_record(self.desk.folders.path(job.id), begun)
        except FileNotFoundError:
            self.desk.step(job.id, State.FAILED, GONE.format(job=job.id))
            return None
        self.desk.step(job.id, State.DRAWING, machine=self.name)
        return job

    def next_to_draw(self) -> Job | None:
        """The planned job that comes next, None where none is planned."""
        ready = self._ready()
        return ready[0] if ready else None

    def let_wait(self, words: str) -> None:
        """The jobs that are planned for it wait, and `words` say for what."""
        with self.desk.changed:
            for job in self.desk.worked_on(State.PLANNED):
                if self.desk.station(job.machine) is self:
                    self.desk.step(job.id, State.WAITING, words)
            self.show(state="waiting", words=words)

    @property
    def changes_pen(self) -> bool:
        """Its drawing waits for another pen."""
        job = self._under_the_pen()
        return job is not None and job.reason is Reason.PEN_CHANGE

    def new_sheet(self) -> None:
        self.desk.journal.new_sheet(self.name)
        self.say("a new sheet is in")
        self.desk.wake()

    def pressed(self) -> None:
        """Somebody has pressed the button that says that a new sheet is in; where none is awaited, nothing changes."""
        with self.desk.changed:
            why = self._no_sheet_awaited()
            if why:
                self.say(f"the button was pressed, and {why}")
                return
            self.new_sheet()
        if self.held:
            self.say(self.show_now())

    def _no_sheet_awaited(self) -> str:
        if not self._asks_for_sheets:
            return "no sheet is ever waited for: it draws on by itself, as sheet in its settings says"
        if self.draws:
            return "a drawing is not over: put a new sheet in when it is, and press again"
        return "" if self.wants_a_sheet else "a new sheet is in already"

    def hold(self, words: str) -> None:
        """It begins no further job until a person says `go`, also after a restart."""
        try:
            self.desk.journal.hold(self.name, words)
        except DiskTrouble as error:
            self.trouble(str(error))
        self.say(self.show_now(), level=logging.WARNING)
        self.desk.wake()

    def show_now(self) -> str:
        """Show what is true: what it draws, what holds it, or that it is idle. Returns what holds it, in a sentence."""
        with self.desk.changed:
            held = self.held and f"no job starts until a person says {self.command('go')}: {self.held}"
            state, reason, words = ("held" if held else "idle"), "", held
            job = self._under_the_pen()
            if job:
                state, reason = job.state.value, job.reason.value
                words = job.words if job.state is State.PAUSED else held
            self.show(state=state, reason=reason, words=words, held=self.held)
            return held

    def go(self) -> None:
        self.desk.journal.go(self.name)
        self.say("jobs may start again")
        self.show_now()
        self.desk.wake()
