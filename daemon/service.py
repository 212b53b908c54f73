"""The service: puts the rooms together, one thread each, until it is told to end."""

from __future__ import annotations

import signal
import sys
import threading
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

from daemon import __version__
from daemon.config import Settings
from daemon.config.reread import reread
from daemon.control import MACHINE_ORDERS, ControlServer, Order, give_order
from daemon.errors import DiskTrouble
from daemon.intake.inbox import Inbox
from daemon.intake.watch import RESCAN_S, InboxWatch
from daemon.jobs.arrivals import Arrivals
from daemon.jobs.choices import Choices
from daemon.jobs.orders import MachineOrder
from daemon.jobs.pressing import Pressing
from daemon.jobs.retention import Retention
from daemon.jobs.scanning import Scanning
from daemon.notify import Notifier
from daemon.parts import Parts, sign_of
from daemon.supervision import Supervision

LIFT_WITHIN_S = 25.0
"""How long an end waits for the pen to be lifted; systemd kills after 30 s."""
LONG_AGO_NS = 20 * 10**9
"""A picture that has lain in the inbox so long at the start does not have to settle."""
INBOX_WITHIN_S = 300.0
"""Of the loop of the inbox, beyond its own waiting: for a slow disk, and old jobs that are removed."""


class Service:
    """The daemon. `run` returns after `end`, with the pen up and every thread gone.

    A thread that dies takes the daemon with it, in order: half a daemon would look like one that works.
    """

    def __init__(
        self,
        settings: Settings,
        parts: Parts,
        *,
        notifier: Notifier | None = None,
        reread: Callable[[], Settings] | None = None,
    ) -> None:
        """reread: the settings as they are written now; raises SettingsError."""
        paths = settings.paths
        self._parts, self._asked, self._settings = parts, False, settings
        self._choices = Choices(parts.desk, placed=parts.runner.placed)
        self._settings_now = reread or (lambda: settings)
        self._supervision = Supervision(
            notifier or Notifier(),
            parts.pulse,
            say=parts.diary.say,
            status=lambda: parts.board.now,
            answers=lambda: give_order(paths.control, Order(order="ping")),
            reread=self._reread,
        )
        parts.board.told = self._supervision.show
        self._retention = Retention(parts.desk, settings.keep)
        self._arrivals = Arrivals(parts.desk, settings)
        self._inboxes, self._unseen = settings.inboxes, set(settings.inboxes)
        self._watches = [self._watch_of(machine) for machine in self._inboxes]
        self._scanning = Scanning(settings, say=parts.diary.say, trouble=parts.desk.trouble)
        self._pressing = Pressing(settings.button, self._pressed, say=parts.diary.say, trouble=parts.desk.trouble)
        self._control = ControlServer(paths.control, self._obey)

    def _watch_of(self, machine: str) -> InboxWatch:
        """Of its inbox; "": of the inbox of all."""
        folder, intake, trouble = self._inboxes[machine], self._settings.intake, self._parts.desk.trouble
        polls = intake.watch == "poll"
        inbox = Inbox(
            folder,
            settle_s=intake.settle_s,
            claim=partial(self._claim, machine),
            refuse=trouble,
            signs=self._signs(machine),
            order=intake.order,
            # The clock of a network folder is another one.
            whole_before_ns=0 if polls else time.time_ns() - LONG_AGO_NS,
        )
        return InboxWatch(
            inbox,
            folder,
            trouble=trouble,
            poll_s=intake.poll_s if polls else None,
            tidy=lambda: self._look_at_the_inbox(machine),
        )

    def _signs(self, machine: str) -> dict[str, Callable[[], object]]:
        """The files that say something, by name: in the inbox of all with the machine's, in its own without."""
        stations, pens = self._parts.desk.stations, self._parts.pens
        signs: dict[str, Callable[[], object]] = {"NEXT": self._which_machine, "PEN": self._which_machine}
        for name in stations:
            signs[sign_of("NEXT", name, self._settings)] = stations[name].new_sheet
            signs[sign_of("PEN", name, self._settings)] = pens[name].new
        if machine:
            signs |= {"NEXT": stations[machine].new_sheet, "PEN": pens[machine].new}
        return signs

    def _which_machine(self) -> None:
        names = " or ".join(sign_of("NEXT", name, self._settings) for name in self._settings.machines)
        self._parts.desk.trouble(f"NEXT or PEN of which machine? put {names} there, PEN likewise")

    def _pressed(self) -> None:
        """The button was."""
        button, stations = self._settings.button, self._parts.desk.stations
        if button.does == "scan":
            self._scanning.scan()
            return
        station = stations[button.machine or next(iter(stations))]
        if station.changes_pen:
            self._parts.runner.resume(station.name)
        else:
            station.pressed()

    def run(self) -> bool:
        """True when it ended because it was told to."""
        parts = self._parts
        parts.diary.say("linedrawd starts", version=__version__, inbox=self._inboxes[""])
        for station in parts.desk.stations.values():
            station.show(state="idle")
        # Before anything answers: whoever has got an answer finds a status.
        parts.board.tick(time.monotonic())
        self._arrivals.recover(self._inboxes)
        parts.desk.recover()
        works: dict[str, Callable[[], None]] = {
            f"draw {name}": partial(parts.runner.draw_on, name) for name in parts.drawings
        }
        works |= {"plan": parts.runner.plan_on}
        works |= {f"inbox {number}": watch.run for number, watch in enumerate(self._watches)}
        works |= {"scan": self._scanning.run, "button": self._pressing.run}
        works |= {"control": self._control.run, "status": parts.board.run}
        threads = [threading.Thread(target=self._work, args=(work,), name=name) for name, work in works.items()]
        for thread in threads:
            thread.start()
        self._supervision.run()
        self._end(threads)
        return self._asked

    def _work(self, work: Callable[[], None]) -> None:
        try:
            work()
        finally:
            self._supervision.end()

    def _look_at_the_inbox(self, machine: str) -> None:
        """Called at each look: the first one comes when everything that happens from now on is heard."""
        self._inbox_lives(machine)
        self._unseen.discard(machine)
        if not self._unseen:
            self._supervision.watching()
        if not machine:
            self._retention.turn()
            try:
                self._arrivals.finish()
            except DiskTrouble as error:
                self._parts.desk.trouble(str(error))

    def _claim(self, machine: str, picture: Path, beside: Path | None) -> None:
        """Each in its own time: pages are counted."""
        self._inbox_lives(machine)
        self._arrivals.take(picture, beside, inbox=machine)

    def _inbox_lives(self, machine: str) -> None:
        waits_s = max(RESCAN_S, self._settings.intake.poll_s)
        self._parts.pulse.inbox(machine or "all").within(INBOX_WITHIN_S + waits_s)

    def _reread(self) -> list[str]:
        """A sentence for each setting that has changed. Raises SettingsError."""
        self._settings, words = reread(self._settings, self._settings_now())
        self._parts.pool.settings = self._arrivals.settings = self._settings
        self._retention.keep = self._settings.keep
        return words or ["the settings have been read again: nothing has changed"]

    def end(self) -> None:
        """May be called from any thread and from a signal handler."""
        self._asked = True
        self._supervision.end()

    def end_on_signals(self) -> None:
        """SIGTERM and Ctrl-C: feed hold, pen up, end. SIGHUP: read the settings again."""
        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, lambda *_: self.end())
        # A terminal that was closed says the same as somebody who wants the settings read again.
        hang_up = self.end if sys.stdin.isatty() else self._supervision.reread
        signal.signal(signal.SIGHUP, lambda *_: hang_up())

    def _end(self, threads: list[threading.Thread]) -> None:
        parts = self._parts
        parts.runner.end()
        for watch in self._watches:
            watch.stop()
        self._pressing.end()
        self._scanning.end()
        self._control.stop()
        *others, board = threads
        for thread in others:
            thread.join(LIFT_WITHIN_S)
        for station in parts.desk.stations.values():
            station.show(state="ended", words="linedrawd has ended", port="")
        parts.board.change(state="ended", words="linedrawd has ended", pid=0)
        parts.board.stop()
        board.join(LIFT_WITHIN_S)
        parts.diary.say("linedrawd has ended")

    def _obey(self, order: Order) -> str:
        runner, machine = self._parts.runner, order.machine
        if order.order != "ping":
            self._parts.diary.say("a person says", order=order.order, what=order.job or machine or "-")
        obeyed: dict[str, Callable[[], str]] = {
            "ping": lambda: "linedrawd runs",
            "scan": self._scanning.scan,
            "next": lambda: runner.new_sheet(machine),
            "stop": lambda: runner.stop(machine),
            "go": lambda: runner.go(machine),
            "cancel": lambda: runner.cancel(order.job),
            "pause": lambda: runner.pause(machine, at_once=order.at_once),
            "feed": lambda: runner.feed(machine, percent=order.percent),
            "resume": lambda: self._resume(order),
            "drain": lambda: runner.drain(machine),
            "retry": lambda: self._choices.retry(order.job),
            "again": lambda: self._choices.again(order.job),
            "approve": lambda: self._choices.approve(order.job),
        }
        if order.order in obeyed:
            return obeyed[order.order]()
        return runner.move(machine_order(order), machine)

    def _resume(self, order: Order) -> str:
        if order.from_stroke is None:
            return self._parts.runner.resume(order.machine)
        return self._choices.resume_from(order.job, order.from_stroke)


def machine_order(order: Order) -> MachineOrder:
    """What the machine is asked by an order of `MACHINE_ORDERS`."""
    name = next(name for name in MACHINE_ORDERS if name == order.order)
    return MachineOrder(name, order.x_mm, order.y_mm, order.seconds, order.job)
