"""Orders of people, and what a restart finds: nothing is drawn twice, nothing starts by itself."""

from __future__ import annotations

from threading import Thread

import pytest

from daemon.errors import LinedrawError, MachineFault, NoMachine
from firmware_protocol.session import Ended, Verdict
from tests.daemon.jobs.bench import Bench, fault


def test_a_fault_is_still_held_after_a_restart(bench: Bench) -> None:
    bench.machine.endings = [fault(Verdict.SILENT)]
    bench.planned("a.png")
    bench.planned("b.png")
    bench.drawing.turn()
    after = bench.restarted()
    after.drawing.turn()
    assert after.states() == ["interrupted", "planned"]
    assert after.machine.opened == 0
    assert after.shown["state"] == "held"
    assert after.shown["words"] == "no job starts until a person says `linedrawd go`: silent at line 7: look at it"
    after.journal.close()


def test_an_end_in_mid_drawing_is_held_after_a_restart_and_is_not_measured(bench: Bench) -> None:
    bench.machine.endings = [Ended(Verdict.STOPPED, 1, 2, True, True, "stopped")]
    bench.machine.ink = [[(1.0, 1.0), (9.0, 1.0)]]
    bench.machine.while_drawing = bench.desk.end
    bench.planned("a.png")
    bench.planned("b.png")
    bench.drawing.turn()
    assert "ink_strokes" not in (bench.desk.folders.path("000001-a") / "report.json").read_text()
    after = bench.restarted()
    after.drawing.turn()
    assert after.states() == ["interrupted", "planned"]
    assert after.station.held.startswith("linedrawd ended in the middle of a drawing")
    after.journal.close()


def test_stop_ends_the_drawing_and_freezes_the_queue(bench: Bench) -> None:
    bench.machine.endings = [Ended(Verdict.STOPPED, 1, 2, True, True, "stopped: put a new sheet in")]
    bench.machine.while_drawing = lambda: print(bench.runner.stop())
    bench.planned("a.png")
    bench.planned("b.png")
    for _ in range(3):
        bench.drawing.turn()
    assert bench.states() == ["interrupted", "planned"]
    assert bench.machine.stops == 2
    assert bench.shown["held"] == "a person stopped the machine"


def test_a_stop_just_before_the_first_line_draws_nothing(bench: Bench) -> None:
    bench.planned()
    bench.before_drawing = bench.runner.stop
    bench.drawing.turn()
    assert bench.states() == ["planned"]
    assert bench.machine.drawn == 0


def test_a_cancelled_drawing_is_stopped_and_the_next_one_starts(bench: Bench) -> None:
    first = bench.planned("a.png")
    bench.planned("b.png")
    bench.machine.endings = [Ended(Verdict.STOPPED, 1, 2, True, True, "stopped")]
    bench.machine.while_drawing = lambda: print(bench.runner.cancel(first))
    bench.drawing.turn()
    assert bench.shown["state"] == "idle"
    bench.machine.while_drawing = lambda: None
    bench.drawing.turn()
    assert bench.states() == ["cancelled", "done"]
    assert bench.machine.stops == 1


def test_a_job_cancelled_just_before_the_first_line_is_not_drawn(bench: Bench) -> None:
    job = bench.planned()
    bench.before_drawing = lambda: bench.runner.cancel(job)
    bench.drawing.turn()
    assert bench.states() == ["cancelled"]
    assert bench.machine.drawn == 0


def test_a_waiting_job_is_cancelled_by_its_number(bench: Bench) -> None:
    bench.planned()
    assert bench.runner.cancel("1") == "job 000001-a is dropped (it was planned)"
    bench.drawing.turn()
    assert bench.states() == ["cancelled"]
    assert bench.machine.drawn == 0


def test_a_job_is_cancelled_while_it_is_planned(bench: Bench) -> None:
    job = bench.drop("a.png", "hang")
    bench.drop("b.png")
    thread = Thread(target=bench.planning.turn)
    bench.when_shown("stage", "decode", lambda: bench.runner.cancel(job))
    thread.start()
    thread.join(10)
    bench.planning.turn()
    assert bench.states() == ["cancelled", "planned"]


@pytest.mark.parametrize("job", ["7", "nonsense", ""])
def test_a_job_that_is_not_there_cannot_be_cancelled(bench: Bench, job: str) -> None:
    with pytest.raises(LinedrawError, match="lists them"):
        bench.runner.cancel(job)


def test_a_job_that_is_over_cannot_be_cancelled(bench: Bench) -> None:
    bench.planned()
    bench.drawing.turn()
    with pytest.raises(LinedrawError, match="is done already"):
        bench.runner.cancel("1")


def test_a_job_found_in_drawing_is_interrupted_its_pen_is_lifted_and_nothing_else_starts(bench: Bench) -> None:
    bench.planned("a.png")
    bench.planned("b.png")
    bench.begun()
    after = bench.restarted()
    for _ in range(3):
        after.drawing.turn()
    assert after.states() == ["interrupted", "planned"]
    assert (after.machine.lifted, after.machine.still, after.machine.drawn) == (1, True, 0)
    assert (after.machine.opened, after.machine.closed) == (1, 1)
    assert "the last drawing was cut off: the pen has been lifted, and nothing else moves" in after.sayings()
    assert after.station.held
    after.runner.go()
    after.drawing.turn()
    assert after.states() == ["interrupted", "done"]
    assert (after.machine.lifted, after.machine.still) == (1, False)
    after.journal.close()


def test_a_pen_that_was_left_down_is_lifted_as_soon_as_the_machine_is_found(bench: Bench) -> None:
    bench.planned()
    bench.begun()
    after = bench.restarted()
    after.machine.missing = NoMachine("no adapter: plug it in")
    after.drawing.turn()
    after.machine.missing = None
    after.now_s += 3.0
    after.drawing.turn()
    assert after.machine.lifted == 1
    after.journal.close()


def test_a_pen_that_cannot_be_lifted_is_said_once(bench: Bench) -> None:
    bench.planned()
    bench.begun()
    after = bench.restarted()
    after.machine.missing = MachineFault("the controller is locked: unlock it")
    for _ in range(2):
        after.now_s += 100.0
        after.drawing.turn()
    assert (
        after.sayings().count("the pen may still be down, it could not be lifted: the controller is locked: unlock it")
        == 1
    )
    after.journal.close()


def test_a_job_found_in_planning_is_planned_again(bench: Bench) -> None:
    bench.drop()
    bench.allotment.begin()
    after = bench.restarted()
    assert after.states() == ["queued"]
    after.journal.close()


def test_a_picture_that_was_claimed_but_not_recorded_becomes_a_job(bench: Bench) -> None:
    (bench.inbox / "a.png").write_text("good")
    bench.desk.folders.take(bench.inbox / "a.png")
    after = bench.restarted()
    after.planning.turn()
    assert after.states() == ["planned"]
    after.journal.close()
