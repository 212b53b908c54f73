"""The service: puts the rooms together, one thread each, until it is told to end."""

from __future__ import annotations

import fcntl
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass
from pathlib import Path

from daemon import __version__
from daemon.config import Settings
from daemon.control import MACHINE_ORDERS, ControlServer, Order
from daemon.errors import SettingsError
from daemon.intake.inbox import Inbox
from daemon.intake.rank import Rank, rank
from daemon.intake.watch import InboxWatch
from daemon.jobs.arrivals import Arrivals
from daemon.jobs.desk import Desk
from daemon.jobs.devices import check, moves_of, opened
from daemon.jobs.drawing import Drawing
from daemon.jobs.folder import JobFolders, make_folder
from daemon.jobs.moves import PointMm
from daemon.jobs.open_journal import open_journal
from daemon.jobs.orders import MachineOrder, Places, outline_mm, rectangle_mm
from daemon.jobs.pen_life import PenLife
from daemon.jobs.planning import Planning
from daemon.jobs.pool import Pool
from daemon.jobs.retention import Retention
from daemon.jobs.runner import Runner
from daemon.jobs.scanning import Scanning
from daemon.jobs.sheet import box_origin_mm
from daemon.machine.recorder import Recorder
from daemon.program.file import load_program
from daemon.shapes import Program
from daemon.status import Diary, StatusBoard

LIFT_WITHIN_S = 25.0
"""How long an end waits for the pen to be lifted; systemd kills after 30 s."""


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


@contextmanager
def parts_of(
    settings: Settings, *, verbose: bool = False, planner: str | None = None, record: Path | None = None
) -> Iterator[Parts]:
    """Everything that works on the state folder, which belongs to us until the block is left.

    record: a file into which everything that is said to the machine and by it is written.

    Raises SettingsError when another daemon works on it or its programs suit no machine here, and DiskTrouble.
    """
    paths, name = settings.paths, settings.machine_name
    check(settings.machines[name])
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
        desk = Desk(
            journal,
            folders,
            say=diary.say,
            show=board.change,
            asks_for_sheets=settings.machines[name].asks_for_sheets,
            ahead=settings.planning.ahead,
            rank=_rank_in(settings),
        )
        life_m = settings.machines[name].pen_life_m
        pen = PenLife(paths.state_dir / "pen.json", life_m, say=diary.say, show=board.change)
        pool = at_end.enter_context(closing(Pool(settings, planner=planner)))
        recorder = at_end.enter_context(closing(Recorder(record))) if record else None
        drawing = Drawing(
            desk,
            opened=lambda hear, still: opened(settings.machines[name], hear, still, recorder),
            moves=moves_of(settings.machines[name]),
            places=_places(settings, desk),
            load=load_program,
            measure=lambda folder: pool.measure(folder, name),
            inked=pen.drew,
        )
        at_end.callback(drawing.close)
        planning = Planning(desk, pool, name)
        yield Parts(desk, pool, planning, drawing, Runner(desk, pool, planning, drawing), pen, board, diary)


def _rank_in(settings: Settings) -> Callable[[str], Rank]:
    return lambda name: rank(name, settings.intake.order)


def _places(settings: Settings, desk: Desk) -> Places:
    """A frame is that of the drawing, or of the box where no job has been planned."""
    machine = settings.machines[settings.machine_name]
    left, bottom = box_origin_mm(settings.sheet, machine)
    width, height = settings.sheet.box_mm
    box = rectangle_mm((left, bottom), (left + width, bottom + height))

    def frame_mm(job: str) -> Sequence[PointMm]:
        found = desk.find(job) if job else desk.next_to_draw()
        return outline_mm(desk.folders.path(found.id)) if found else box

    def next_program() -> Program:
        found = desk.next_to_draw()
        return load_program(desk.folders.path(found.id) / "program.gcode") if found else Program((), 0)

    return Places(machine.park_mm, frame_mm, next_program)


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

    def __init__(self, settings: Settings, parts: Parts) -> None:
        paths = settings.paths
        self._parts, self._ended, self._asked = parts, threading.Event(), False
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
            tidy=Retention(parts.desk, settings.keep).turn,
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
        self._ended.wait()
        self._end(threads)
        return self._asked

    def _work(self, work: Callable[[], None]) -> None:
        try:
            work()
        finally:
            self._ended.set()

    def end(self) -> None:
        """May be called from any thread and from a signal handler."""
        self._asked = True
        self._ended.set()

    def end_on_signals(self) -> None:
        """SIGTERM and Ctrl-C: feed hold, pen up, end."""
        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, lambda *_: self.end())

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
        self._parts.diary.say("a person says", order=order.order, what=order.job or "-")
        obeyed: dict[str, Callable[[], str]] = {
            "ping": lambda: "linedrawd runs",
            "scan": self._scanning.scan,
            "next": runner.new_sheet,
            "stop": runner.stop,
            "go": runner.go,
            "cancel": lambda: runner.cancel(order.job),
            "pause": lambda: runner.pause(at_once=order.at_once),
            "resume": runner.resume,
        }
        if order.order in obeyed:
            return obeyed[order.order]()
        return runner.move(machine_order(order))


def machine_order(order: Order) -> MachineOrder:
    """What the machine is asked by an order of `MACHINE_ORDERS`."""
    name = next(name for name in MACHINE_ORDERS if name == order.order)
    return MachineOrder(name, order.x_mm, order.y_mm, order.seconds, order.job)
