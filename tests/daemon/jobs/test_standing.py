"""A pen that stands is told with its reason, and a drawing goes on only where the place of the pen is known."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from daemon.config import GrblMachine
from daemon.errors import LinedrawError
from daemon.jobs.choices import Choices
from daemon.jobs.devices import opened
from daemon.jobs.journal import Job
from daemon.jobs.moves import GrblMoves
from daemon.jobs.open_machine import OpenMachine
from daemon.jobs.record import RECORD_NAME, read_record
from daemon.jobs.states import Reason, State, meaning_of
from daemon.machine.open import OpenedMachine
from daemon.machine.simulated import SimulatedTransport
from daemon.shapes import Program
from firmware_protocol.session import Accepted, Ended, Event, Verdict
from tests.daemon.jobs.bench import Bench, fault
from tests.daemon.jobs.test_journal import full_disk

DOOR, HOLD, CYCLE_START = b"\x84", b"!", b"~"
HOMING = GrblMachine(home="job")


class Plotter:
    """A simulated GRBL machine under the bench's drawing, and hands at its buttons."""

    def __init__(self, bench: Bench) -> None:
        self._bench, self._way = bench, list[OpenedMachine[Any]]()
        bench.drawing._opened = self._open

    def _open(self, hear: Callable[[Event], None], still: bool) -> OpenMachine:
        way = opened(GrblMachine(url="sim://grbl"), hear, still)
        assert isinstance(way, OpenedMachine)
        self._way.append(way)
        return way

    def press(self, byte: bytes) -> None:
        transport = self._way[-1]._transport
        assert isinstance(transport, SimulatedTransport)
        transport.simulator.receive(byte, transport.now())

    def resume(self) -> None:
        self._way[-1].resume()

    def while_drawn(self, do: Callable[[], object]) -> None:
        """Once, when the first stroke is under the pen."""
        shown = [do]
        self._bench.on_show(lambda values: shown.pop()() if shown and values["percent"] > 10 else None)


def of(bench: Bench) -> tuple[State, Reason]:
    job = bench.journal.jobs()[0]
    return job.state, job.reason


def when_said(bench: Bench, state: State, do: Callable[[], object]) -> None:
    def say(words: str, **values: Any) -> None:
        bench.said.append((words, values))
        if values.get("state") == state.value:
            do()

    bench.desk.say = say


@pytest.mark.parametrize("by_hand", [True, False], ids=["cycle start", "resume"])
@pytest.mark.parametrize(
    ("byte", "reason", "sentence"),
    [(DOOR, Reason.DOOR, "close it, then press cycle start"), (HOLD, Reason.AT_THE_MACHINE, "press cycle start at")],
)
def test_a_door_and_a_feed_hold_pause_the_job_until_somebody_lets_it_go_on(
    bench: Bench, byte: bytes, reason: Reason, sentence: str, by_hand: bool
) -> None:
    plotter, seen, shown = Plotter(bench), list[Job](), list[tuple[str, str]]()

    def look_and_go_on() -> None:
        seen.extend(bench.journal.jobs())
        shown.append((bench.shown["state"], bench.shown["reason"]))
        plotter.press(CYCLE_START) if by_hand else plotter.resume()

    when_said(bench, State.PAUSED, look_and_go_on)
    bench.planned()
    plotter.while_drawn(lambda: plotter.press(byte))
    bench.drawing.turn()
    assert [(job.state, job.reason, sentence in job.words) for job in seen] == [(State.PAUSED, reason, True)]
    assert shown == [("paused", reason.value)]
    assert "the machine goes on" in bench.sayings()
    assert of(bench) == (State.DONE, Reason.NONE)
    bench.drawing.close()


def test_a_person_who_pauses_is_the_reason(bench: Bench) -> None:
    seen: list[tuple[State, Reason]] = []
    when_said(bench, State.PAUSED, lambda: seen.append(of(bench)))
    bench.machine.while_drawing = lambda: (bench.runner.pause(at_once=False), bench.runner.resume())
    bench.planned()
    bench.drawing.turn()
    assert seen == [(State.PAUSED, Reason.PERSON)]
    assert of(bench) == (State.DONE, Reason.NONE)


def test_a_daemon_that_is_killed_while_the_pen_stands_finds_the_job_interrupted(bench: Bench) -> None:
    bench.planned()
    bench.begun(certain=1, possible=2)
    bench.desk.step("000001-a", State.PAUSED, "the door is open", reason=Reason.DOOR)
    after = bench.restarted()
    assert of(after) == (State.INTERRUPTED, Reason.POSITION_UNKNOWN)
    assert "of 2 strokes 1 are certainly drawn" in after.words()
    assert (after.station.held != "", after.station.cut_off) == (True, True)
    after.journal.close()


def test_a_pause_that_a_full_disk_keeps_out_of_the_journal_ends_well(bench: Bench) -> None:
    def pause_and_resume() -> None:
        with full_disk(64):
            bench.runner.pause(at_once=False)
            bench.runner.resume()

    bench.machine.while_drawing = pause_and_resume
    bench.planned()
    bench.drawing.turn()
    assert of(bench) == (State.DONE, Reason.NONE)


def test_a_job_that_is_dropped_while_the_pen_stands_is_broken_off(bench: Bench) -> None:
    def drop() -> None:
        bench.runner.pause(at_once=False)
        bench.runner.cancel("1")

    bench.machine.while_drawing = drop
    bench.machine.endings = [Ended(Verdict.STOPPED, 1, 1, True, True, "stopped")]
    bench.planned()
    bench.drawing.turn()
    assert (of(bench), bench.machine.stops) == ((State.CANCELLED, Reason.NONE), 1)


ENDS = [
    (Ended(Verdict.STOPPED, 1, 1, True, True, "stopped"), State.INTERRUPTED, Reason.POSITION_KNOWN),
    (Ended(Verdict.STOPPED, 1, 1, False, True, "stopped while it homed"), State.INTERRUPTED, Reason.POSITION_UNKNOWN),
    (Ended(Verdict.ALARM, 1, 1, True, False, "alarm"), State.INTERRUPTED, Reason.POSITION_UNKNOWN),
    (fault(Verdict.RESTARTED), State.INTERRUPTED, Reason.POWER),
    (fault(Verdict.SILENT), State.INTERRUPTED, Reason.POSITION_UNKNOWN),
    (fault(Verdict.UNPLUGGED), State.INTERRUPTED, Reason.POSITION_UNKNOWN),
    (fault(Verdict.REJECTED), State.FAILED, Reason.CONTROLLER),
    (Ended(Verdict.STOPPED, 0, 0, True, True, "stopped"), State.PLANNED, Reason.NONE),
]


@pytest.mark.parametrize(("ended", "state", "reason"), ENDS)
def test_how_a_drawing_ended_says_whether_the_place_of_the_pen_is_known(
    bench: Bench, ended: Ended, state: State, reason: Reason
) -> None:
    job = bench.planned()
    bench.machine.endings = [ended]
    bench.drawing.turn()
    assert of(bench) == (state, reason)
    told = json.loads((bench.desk.folders.path(job) / RECORD_NAME).read_text())
    assert (told["reason"], told["remedy"]) == (reason.value, meaning_of(state, reason).remedy)


def interrupted(bench: Bench, *, known: bool = True) -> None:
    bench.planned()
    bench.machine.endings = [Ended(Verdict.STOPPED, 1, 1, known, True, "stopped")]
    bench.drawing.turn()


def test_a_restart_forgets_the_place(bench: Bench) -> None:
    interrupted(bench)
    after = bench.restarted()
    assert of(after) == (State.INTERRUPTED, Reason.POSITION_UNKNOWN)
    assert after.words() == (
        "linedrawd was started anew, so the place of the pen is no longer known "
        "(of 2 strokes 1 are certainly drawn, none from 1 on is touched)"
    )
    after.journal.close()


def test_an_end_in_order_forgets_it_too_for_the_port_is_closed(bench: Bench) -> None:
    bench.planned()
    bench.machine.endings = [Ended(Verdict.STOPPED, 1, 1, True, True, "stopped")]
    bench.machine.while_drawing = bench.desk.end
    bench.drawing.turn()
    assert of(bench) == (State.INTERRUPTED, Reason.POSITION_UNKNOWN)


def test_a_machine_that_is_unplugged_afterwards_forgets_it(bench: Bench) -> None:
    interrupted(bench)
    bench.machine.unplugged = True
    bench.drawing.turn()
    assert of(bench) == (State.INTERRUPTED, Reason.POSITION_UNKNOWN)
    with pytest.raises(LinedrawError, match="does not know where the sheet's origin is"):
        Choices(bench.desk, placed=bench.runner.placed).resume_from("1", 1)


def test_motors_that_were_switched_off_forget_it(bench: Bench) -> None:
    interrupted(bench)
    bench.runner.go()
    bench.machine.resting = "the motors are off: home it"
    bench.drawing.turn()
    assert of(bench) == (State.INTERRUPTED, Reason.POSITION_UNKNOWN)


@pytest.mark.parametrize("known", [True, False])
def test_only_a_machine_that_has_lost_its_place_homes_before_it_goes_on(bench: Bench, known: bool) -> None:
    bench.drawing._moves = GrblMoves(HOMING)
    bench.drawing._places = replace(bench.drawing._places, homes=True)
    load = bench.drawing._load
    bench.drawing._load = lambda path: with_homing(load(path))
    interrupted(bench, known=known)
    assert bench.machine.programs[0][0] == "$H"
    Choices(bench.desk, placed=bench.runner.placed).resume_from("1", 1)
    bench.drawing.turn()
    assert ("$H" in bench.machine.programs[1], bench.machine.opened) == ((False, 1) if known else (True, 2))
    assert "G1 X9 Y5 F1200" in bench.machine.programs[1]


def with_homing(program: Program) -> Program:
    return Program((*GrblMoves(HOMING).home().lines, *program.lines), program.strokes)


def test_a_record_without_a_reason_is_of_a_place_that_nobody_knows(bench: Bench) -> None:
    interrupted(bench)
    folder = bench.desk.folders.path("000001-a")
    told = json.loads((folder / RECORD_NAME).read_text())
    del told["reason"], told["remedy"]
    (folder / RECORD_NAME).write_text(json.dumps(told))
    job = read_record(folder)
    assert job is not None
    assert (job.state, job.reason) == (State.INTERRUPTED, Reason.POSITION_UNKNOWN)


def test_a_state_has_no_reason_that_the_table_lacks(bench: Bench) -> None:
    bench.planned()
    bench.begun()
    with pytest.raises(ValueError, match="not paused for the reason ''"):
        bench.journal.step("000001-a", State.PAUSED, "paused")
    with pytest.raises(ValueError, match="not done for the reason 'door'"):
        bench.journal.end_drawing("000001-a", State.DONE, "", certain=2, possible=2, reason=Reason.DOOR)
    assert of(bench) == (State.DRAWING, Reason.NONE)


def test_the_status_says_held_when_a_stopped_drawing_has_ended(bench: Bench) -> None:
    def stop() -> None:
        bench.runner.stop()
        bench.machine.heard(Accepted(1))

    bench.machine.while_drawing = stop
    bench.machine.endings = [Ended(Verdict.STOPPED, 1, 1, True, True, "stopped")]
    bench.planned()
    bench.drawing.turn()
    assert bench.shown["state"] == "held"
    assert "a person stopped the machine" in bench.shown["words"]
