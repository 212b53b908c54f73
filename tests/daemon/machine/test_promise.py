"""Nothing of a stroke leaves before it has been promised that it may be on the sheet."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from daemon.config import DobotMachine, EmcoMachine, GrblMachine, Machine
from daemon.errors import DiskTrouble
from daemon.jobs.devices import opened, program_of
from daemon.machine.link import Promise
from daemon.machine.open import OpenedMachine
from daemon.shapes import Program, Stroke, Toolpath
from firmware_protocol.session import Ended, Event, Paused, Verdict
from tests.daemon.planned import STROKES_MM

MACHINES: dict[str, Callable[[], Machine]] = {
    "grbl": lambda: GrblMachine(url="sim://grbl"),
    "line by line": lambda: GrblMachine(url="sim://grbl", flow="line"),
    "tried before": lambda: GrblMachine(url="sim://grbl", dry_run=True),
    "arm": lambda: DobotMachine(device="dobot", url="sim://dobot"),
    "characters": lambda: EmcoMachine(device="emco", url="sim://emco", link="xonxoff"),
    "blocks": lambda: EmcoMachine(device="emco", url="sim://emco", link="blocks"),
}


class Table:
    """A simulated machine, and the strokes that have been promised."""

    def __init__(self, machine: Machine) -> None:
        self.heard: list[Event] = []
        self.opened = opened(machine, self._hear, still=False)
        assert isinstance(self.opened, OpenedMachine)
        toolpath = Toolpath(tuple(map(Stroke, STROKES_MM * 2)), None, machine.park_mm)  # type: ignore[arg-type]
        self.program = program_of(toolpath, machine, "000001-house")
        self.on_event: Callable[[Event], None] = lambda event: None
        self.opened.connect()
        self.promised, self.told = 0, [(0, 0)]

    def _hear(self, event: Event) -> None:
        self.heard.append(event)
        self.on_event(event)

    def draw(self, promise: Promise | None = None) -> Ended:
        return self.opened.draw(self.program, promise or self.promise)

    def promise(self, touched: int, certain: int) -> int:
        self.told.append((touched, certain))
        self.promised = touched
        return touched


@pytest.mark.parametrize("name", MACHINES)
def test_every_stroke_is_promised(name: str) -> None:
    table = Table(MACHINES[name]())
    assert table.draw().verdict is Verdict.FINISHED
    assert table.promised == table.program.strokes


@pytest.mark.parametrize("name", MACHINES)
def test_what_is_promised_and_certain_only_grows(name: str) -> None:
    table = Table(MACHINES[name]())
    table.draw()
    assert [touched for touched, _ in table.told] == sorted({touched for touched, _ in table.told})
    assert [certain for _, certain in table.told] == sorted(certain for _, certain in table.told)


@pytest.mark.parametrize("name", MACHINES)
@pytest.mark.parametrize("after", range(6))
def test_a_promise_that_cannot_be_written_stops_the_job_before_that_stroke(name: str, after: int) -> None:
    table = Table(MACHINES[name]())

    def promise(touched: int, certain: int) -> int:
        if touched > after:
            raise DiskTrouble("the disk is full: free it")
        return table.promise(touched, certain)

    ended = table.draw(promise)
    assert (ended.verdict, ended.why) == (Verdict.STOPPED, "the disk is full: free it")
    assert ended.strokes_possible <= after
    assert sum(len(line) > 1 for line in table.opened.take_ink() or ()) <= after


def test_a_pause_takes_no_promise_back() -> None:
    table = Table(MACHINES["grbl"]())

    def resume(event: Event) -> None:
        if isinstance(event, Paused):
            table.opened.resume()

    table.on_event = resume
    table.opened.pause(at_once=False)
    assert table.draw().verdict is Verdict.FINISHED
    assert any(isinstance(event, Paused) for event in table.heard)
    assert table.promised == table.program.strokes


def test_a_job_without_strokes_promises_nothing() -> None:
    table = Table(MACHINES["grbl"]())
    table.opened.draw(Program((), 0), table.promise)
    assert table.told == [(0, 0)]
