"""A desk with everything real around it but the machine, which draws at once and ends as it is told."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from daemon.config import GrblMachine
from daemon.errors import MachineFault, NoMachine, Unplugged
from daemon.jobs.allotment import Allotment
from daemon.jobs.desk import Desk
from daemon.jobs.drawing import Drawing
from daemon.jobs.folder import JobFolders
from daemon.jobs.journal import Journal
from daemon.jobs.kept_ink import Reports
from daemon.jobs.moves import GrblMoves
from daemon.jobs.open_machine import InkMm
from daemon.jobs.orders import Places, rectangle_mm
from daemon.jobs.planning import Planning
from daemon.jobs.pool import Pool
from daemon.jobs.runner import Runner
from daemon.jobs.station import Station
from daemon.machine.link import Promise, promise_nothing
from daemon.program.file import load_program
from daemon.shapes import Program
from firmware_protocol.ink import Vector
from firmware_protocol.session import Accepted, Ended, Event, Paused, Ready, Resumed, Verdict
from tests.daemon.jobs.test_pool import PLANNER, settings_with


@dataclass
class InstantMachine:
    """Draws in no time. `endings`: how the next jobs end, FINISHED when there are no more."""

    name: str = "instant"
    endings: list[Ended] = field(default_factory=list)
    drawn: int = 0
    line: int = 0
    """That is being drawn: each takes a second."""
    unplugged: bool = False
    gone: type[MachineFault] = Unplugged
    missing: Exception | None = None
    locked: bool = False
    """It answers, and takes nothing before it is homed."""
    opened: int = 0
    closed: int = 0
    stops: int = 0
    while_drawing: Callable[[], None] = lambda: None
    ink: InkMm | None = None
    heard: Callable[[Event], None] = lambda event: None
    still: bool = False
    resting: str = ""
    lifted: int = 0
    programs: list[list[str]] = field(default_factory=list)
    corner_mm: tuple[float, float] = (0.0, 0.0)
    promised: int = 0
    feeds: list[int] = field(default_factory=list)

    def open(self, heard: Callable[[Event], None], still: bool) -> InstantMachine:
        self.still, self.resting = still, ""
        if self.missing:
            raise self.missing
        self.opened += 1
        self.heard = heard
        return self

    def now(self) -> float:
        return 12.5 * self.drawn + self.line

    def connect(self) -> Ready:
        if self.locked and self.still:
            raise NoMachine("instant is locked: home it")
        return Ready("Instant 1", 128)

    def draw(self, program: Program, promise: Promise = promise_nothing) -> Ended:
        self.drawn += 1
        self.programs.append([line.text for line in program.lines])
        self.promised = promise(program.strokes, 0) if program.strokes else 0
        for self.line in range(len(program.lines)):
            self.heard(Accepted(self.line))
        self.line = 0
        self.while_drawing()
        if self.endings:
            return self.endings.pop(0)
        return Ended(Verdict.FINISHED, program.strokes, program.strokes, True, True, "drawn")

    def listen(self) -> None:
        if self.unplugged:
            raise self.gone("instant was unplugged: plug it in")

    def line_times_s(self, program: Program) -> Sequence[float]:
        return [float(line + 1) for line in range(len(program.lines))]

    def take_ink(self) -> InkMm | None:
        return self.ink

    def position_mm(self) -> Vector | None:
        return (3.0, 4.0, 5.0)

    def count_from(self, corner_mm: tuple[float, float]) -> None:
        self.corner_mm = corner_mm

    @property
    def rests(self) -> str:
        return self.resting

    def home(self, program: Program) -> Ended:
        return self.draw(program)

    def check(self, program: Program) -> Sequence[str]:
        return ["port: instant", "firmware: Instant 1"]

    def lift(self) -> bool:
        self.lifted += 1
        return True

    def pause(self, *, at_once: bool) -> None:
        self.heard(Paused(1))

    def resume(self) -> None:
        self.heard(Resumed())

    def feed(self, percent: int) -> None:
        self.feeds.append(percent)

    def stop(self) -> None:
        self.stops += 1

    def close(self) -> None:
        self.closed += 1


class Bench:
    """One state folder, its desk, and a clock that only moves when it is told to."""

    def __init__(self, root: Path, *, asks_for_sheets: bool = False, pool: Pool | None = None) -> None:
        self.root, self.now_s = root, 100.0
        self.before_drawing: Callable[[], object] = lambda: None
        self.said: list[tuple[str, dict[str, Any]]] = []
        self.shown: dict[str, Any] = {}
        self._when_shown: Callable[[dict[str, Any]], None] = lambda values: None
        self.inbox = root / "inbox"
        self.inbox.mkdir(exist_ok=True)
        self.machine = InstantMachine()
        self.pool = pool or Pool(settings_with(root), planner=PLANNER)
        self.journal = Journal(root / "journal.sqlite")
        self.desk = Desk(
            self.journal,
            JobFolders(root / "jobs"),
            say=lambda words, **values: self.said.append((words, values)),
            show=self._show,
        )
        self.station = Station(self.desk, "plotter", show=self._show, asks_for_sheets=asks_for_sheets)
        self.allotment = Allotment(self.desk)
        self.planning = Planning(self.desk, self.pool, self.allotment)
        self.drawing = Drawing(
            self.station,
            opened=self.machine.open,
            load=self._load,
            reports=Reports(self.pool.await_pictures, lambda folder: self.pool.measure(folder, "plotter")),
            moves=GrblMoves(GrblMachine()),
            places=Places((1.0, 2.0), lambda job: rectangle_mm((0.0, 0.0), (10.0, 20.0)), lambda: Program((), 0)),
            now=lambda: self.now_s,
        )
        self.runner = Runner(self.desk, self.pool, self.planning, {"plotter": self.drawing})

    def _load(self, path: Path) -> Program:
        self.before_drawing()
        return load_program(path)

    def _show(self, **values: Any) -> None:
        self.shown.update(values)
        self._when_shown(values)

    def on_show(self, tell: Callable[[dict[str, Any]], None]) -> None:
        """`tell` hears each status that says how far the drawing has come."""
        self._when_shown = lambda values: tell(values) if values.get("percent") else None

    def when_shown(self, key: str, value: Any, do: Callable[[], object]) -> None:
        """Once."""

        def look(values: dict[str, Any]) -> None:
            if values.get(key) == value:
                self._when_shown = lambda values: None
                do()

        self._when_shown = look

    def wait_for(self, true: Callable[[], object]) -> None:
        """Sleeps on the desk's own bell, at most half a minute."""
        until = time.monotonic() + 30.0
        while True:
            seen = self.desk.changes
            if true():
                return
            assert time.monotonic() < until, self.states()
            self.desk.wait(max(0.0, until - time.monotonic()), since=seen)

    def drop(self, name: str = "a.png", text: str = "good") -> str:
        (self.inbox / name).write_text(text)
        self.desk.add(self.desk.folders.take(self.inbox / name), name)
        return self.journal.jobs()[-1].id

    def planned(self, name: str = "a.png") -> str:
        job = self.drop(name)
        self.planning.turn()
        return job

    def begun(self, *, certain: int = 0, possible: int = 1) -> str:
        """A planned job whose drawing has begun: so many strokes are promised."""
        job = self.station.begin_drawing()
        assert job is not None
        self.journal.promise(job.id, strokes=2, certain=certain, possible=possible)
        return job.id

    def sayings(self) -> list[str]:
        return [words for words, _ in self.said]

    def states(self) -> list[str]:
        return [job.state.value for job in self.journal.jobs()]

    def words(self, job: int = -1) -> str:
        return self.journal.jobs()[job].words

    def restarted(self) -> Bench:
        """As after kill -9: nothing is closed in order."""
        self.journal.close()
        after = Bench(self.root, pool=self.pool)
        after.desk.folders.finish_claims(after.inbox)
        after.desk.recover()
        return after

    def close(self) -> None:
        with closing(self.journal), closing(self.pool):
            pass


def fault(verdict: Verdict) -> Ended:
    return Ended(verdict, 1, 2, verdict is Verdict.REJECTED, False, f"{verdict.value} at line 7: look at it")
