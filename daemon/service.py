"""The service: puts the rooms together, one thread each, until it is told to end."""

from __future__ import annotations

import fcntl
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass
from pathlib import Path

from daemon import __version__
from daemon.config import Settings
from daemon.config.reread import reread
from daemon.control import MACHINE_ORDERS, ControlServer, Order, give_order
from daemon.errors import SettingsError
from daemon.intake.inbox import Inbox
from daemon.intake.rank import Rank, rank
from daemon.intake.watch import RESCAN_S, InboxWatch
from daemon.jobs.arrivals import Arrivals
from daemon.jobs.beats import Beats
from daemon.jobs.choices import Choices
from daemon.jobs.desk import Desk
from daemon.jobs.devices import check, moves_of, opened
from daemon.jobs.drawing import Drawing
from daemon.jobs.folder import JobFolders, make_folder
from daemon.jobs.frame import places_of
from daemon.jobs.mending import Mending
from daemon.jobs.open_journal import open_journal
from daemon.jobs.orders import MachineOrder
from daemon.jobs.pen_life import PenLife
from daemon.jobs.planning import Planning
from daemon.jobs.pool import Pool
from daemon.jobs.retention import Retention
from daemon.jobs.runner import Runner
from daemon.jobs.scanning import Scanning
from daemon.machine.recorder import Recorder
from daemon.notify import Notifier
from daemon.program.file import load_program
from daemon.pulse import Pulse
from daemon.status import Diary, StatusBoard
from daemon.supervision import Supervision

LIFT_WITHIN_S = 25.0
"""How long an end waits for the pen to be lifted; systemd kills after 30 s."""
INBOX_WITHIN_S = 300.0
"""Of the loop of the inbox, beyond its own waiting: for a slow disk, and old jobs that are removed."""


@dataclass(frozen=True, slots=True)
class Parts:
    """What works on one state folder. Nothing of it runs yet."""

    desk: Desk
    pool: Pool
    planning: Planning
    drawing: Drawing
    runner: Runner
    pen: PenLife
    board: StatusBoard
    diary: Diary
    pulse: Pulse


@contextmanager
def parts_of(
    settings: Settings, *, verbose: bool = False, planner: str | None = None, record: Path | None = None
) -> Iterator[Parts]:
    """Everything that works on the state folder, which belongs to us until the block is left.

    record: a file into which everything that is said to the machine and by it is written.

    Raises SettingsError when another daemon works on it or its programs suit no machine here, and DiskTrouble.
    """
    paths, name = settings.paths, settings.machine_name
    machine = settings.machines[name]
    check(machine)
    for folder in (paths.state_dir, paths.inbox, paths.log_dir, paths.runtime_dir):
        make_folder(folder)
    with ExitStack() as at_end:
        at_end.enter_context(_only_one(paths.state_dir))
        folders = JobFolders(paths.jobs)
        keep = settings.keep
        diary = Diary(paths.log_dir, paths.jobs, to_stderr=verbose, log_mb=keep.log_mb, log_files=keep.log_files)
        at_end.enter_context(closing(diary))
        board = StatusBoard(paths.status)
        board.change(machine=name)
        journal = at_end.enter_context(closing(open_journal(paths.journal, say=diary.say)))
        folders.go_on_behind(job.id for job in journal.jobs())
        desk = Desk(
            journal,
            folders,
            say=diary.say,
            show=board.change,
            asks_for_sheets=machine.asks_for_sheets,
            ahead=settings.planning.ahead,
            rank=_rank_in(settings),
        )
        pen = PenLife(paths.state_dir / "pen.json", machine.pen_life_m, say=diary.say, show=board.change)
        pool = at_end.enter_context(closing(Pool(settings, planner=planner)))
        recorder = at_end.enter_context(closing(Recorder(record))) if record else None
        pulse = Pulse()
        beats = Beats(pulse)
        mending = Mending(
            machine,
            lambda hear, still: opened(machine, beats.hearing(hear), still, recorder, beats.turned),
            say=diary.say,
        )
        drawing = Drawing(
            desk,
            opened=mending.opened,
            moves=moves_of(machine),
            places=places_of(pool, desk),
            load=load_program,
            measure=lambda folder: beats.measuring(pool, folder, name),
            inked=pen.drew,
        )
        at_end.callback(drawing.close)
        planning = Planning(desk, pool, name)
        runner = Runner(desk, pool, planning, drawing, pulse)
        yield Parts(desk, pool, planning, drawing, runner, pen, board, diary, pulse)


def _rank_in(settings: Settings) -> Callable[[str], Rank]:
    return lambda name: rank(name, settings.intake.order)


@contextmanager
def _only_one(state_dir: Path) -> Iterator[None]:
    with (state_dir / "lock").open("a+", encoding="ascii") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            lock.seek(0)
            first = lock.read().strip() or "?"
            raise SettingsError(
                f"linedrawd, process {first}, already works on {state_dir}: stop it or give another --state-dir"
            ) from None
        lock.truncate(0)
        lock.write(str(os.getpid()))
        lock.flush()
        yield


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
        self._choices = Choices(parts.desk, placed=lambda: parts.drawing.placed)
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
        intake = settings.intake
        self._arrivals = Arrivals(parts.desk, settings)
        inbox = Inbox(
            paths.inbox,
            settle_s=intake.settle_s,
            claim=self._arrivals.take,
            refuse=parts.desk.trouble,
            signs={"NEXT": parts.desk.new_sheet, "PEN": parts.pen.new},
            order=intake.order,
        )
        self._watch = InboxWatch(
            inbox,
            paths.inbox,
            trouble=parts.desk.trouble,
            poll_s=intake.poll_s if intake.watch == "poll" else None,
            tidy=self._look_at_the_inbox,
        )
        self._scanning = Scanning(settings, say=parts.diary.say, trouble=parts.desk.trouble)
        self._control = ControlServer(paths.control, self._obey)
        self._inbox_dir = paths.inbox

    def run(self) -> bool:
        """True when it ended because it was told to."""
        parts = self._parts
        parts.diary.say("linedrawd starts", version=__version__, inbox=self._inbox_dir)
        parts.board.change(state="idle")
        # Before anything answers: whoever has got an answer finds a status.
        parts.board.tick(time.monotonic())
        self._arrivals.recover(self._inbox_dir)
        parts.desk.recover(self._inbox_dir)
        works = [parts.runner.plan_on, parts.runner.draw_on, self._watch.run, self._scanning.run, self._control.run]
        works.append(parts.board.run)
        threads = [threading.Thread(target=self._work, args=(work,), name=work.__qualname__) for work in works]
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

    def _look_at_the_inbox(self) -> None:
        """Called at each look: the first one comes when everything that happens from now on is heard."""
        waits_s = max(RESCAN_S, self._settings.intake.poll_s)
        self._parts.pulse.inbox.within(INBOX_WITHIN_S + waits_s)
        self._supervision.watching()
        self._retention.turn()

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
        self._watch.stop()
        self._scanning.end()
        self._control.stop()
        planning, drawing, inbox, scanning, control, board = threads
        for thread in (drawing, planning, inbox, scanning, control):
            thread.join(LIFT_WITHIN_S)
        parts.board.change(state="ended", words="linedrawd has ended", pid=0, port="")
        parts.board.stop()
        board.join(LIFT_WITHIN_S)
        parts.diary.say("linedrawd has ended")

    def _obey(self, order: Order) -> str:
        runner = self._parts.runner
        if order.order != "ping":
            self._parts.diary.say("a person says", order=order.order, what=order.job or "-")
        obeyed: dict[str, Callable[[], str]] = {
            "ping": lambda: "linedrawd runs",
            "scan": self._scanning.scan,
            "next": runner.new_sheet,
            "stop": runner.stop,
            "go": runner.go,
            "cancel": lambda: runner.cancel(order.job),
            "pause": lambda: runner.pause(at_once=order.at_once),
            "resume": lambda: self._resume(order),
            "drain": self._choices.drain,
            "retry": lambda: self._choices.retry(order.job),
            "again": lambda: self._choices.again(order.job),
        }
        if order.order in obeyed:
            return obeyed[order.order]()
        return runner.move(machine_order(order))

    def _resume(self, order: Order) -> str:
        if order.from_stroke is None:
            return self._parts.runner.resume()
        return self._choices.resume_from(order.job, order.from_stroke)


def machine_order(order: Order) -> MachineOrder:
    """What the machine is asked by an order of `MACHINE_ORDERS`."""
    name = next(name for name in MACHINE_ORDERS if name == order.order)
    return MachineOrder(name, order.x_mm, order.y_mm, order.seconds, order.job)
