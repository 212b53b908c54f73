"""What only a person may choose: no ink is repeated without their word, and none of it is lost with it."""

from __future__ import annotations

from pathlib import Path

import pytest

from daemon.errors import LinedrawError
from daemon.jobs.choices import Choices
from daemon.jobs.orders import MachineOrder
from daemon.jobs.pool import Pool
from daemon.jobs.states import State
from firmware_protocol.session import Ended, Verdict
from tests.daemon.jobs.bench import Bench, fault


@pytest.fixture
def choices(bench: Bench) -> Choices:
    return Choices(bench.desk, placed=bench.runner.placed)


def interrupted(bench: Bench, *, known: bool = False) -> str:
    """A job of which the first stroke is drawn and the second is not."""
    job = bench.planned()
    bench.machine.endings = [Ended(Verdict.STOPPED, 1, 1, known, True, "stopped")]
    bench.drawing.turn()
    assert bench.states()[-1] == "interrupted"
    return job


def test_a_job_that_failed_before_ink_is_tried_again(bench: Bench, choices: Choices) -> None:
    job = bench.drop("a.png", "bad")
    bench.planning.turn()
    (bench.desk.folders.path(job) / "source.png").write_text("good")
    assert choices.retry("1") == "job 000001-a is queued again"
    bench.planning.turn()
    bench.drawing.turn()
    assert bench.states() == ["done"]


def test_a_job_that_failed_with_ink_is_not_tried_again(bench: Bench, choices: Choices) -> None:
    bench.machine.endings = [fault(Verdict.REJECTED)]
    bench.planned()
    bench.drawing.turn()
    with pytest.raises(LinedrawError, match="ink of job 000001-a may be on the sheet"):
        choices.retry("1")
    assert bench.states() == ["failed"]


def test_a_job_that_did_not_fail_is_not_tried_again(bench: Bench, choices: Choices) -> None:
    bench.planned()
    with pytest.raises(LinedrawError, match="only a failed one"):
        choices.retry("1")


def test_again_makes_another_job_of_the_same_picture(bench: Bench, choices: Choices) -> None:
    job = bench.planned()
    (bench.desk.folders.path(job) / "side.toml").write_text("size_mm = [50, 50]")
    bench.drawing.turn()
    assert choices.again("1") == "job 000002-a draws a.png once more"
    assert (bench.desk.folders.path("000002-a") / "side.toml").read_text() == "size_mm = [50, 50]"
    bench.planning.turn()
    bench.drawing.turn()
    assert [(job.name, job.state) for job in bench.journal.jobs()] == [("a.png", State.DONE)] * 2


def test_again_without_its_picture_says_so(bench: Bench, choices: Choices) -> None:
    job = bench.planned()
    (bench.desk.folders.path(job) / "source.png").unlink()
    with pytest.raises(LinedrawError, match="drop it into the inbox again"):
        choices.again("1")


def test_drain_finishes_what_is_drawn_and_begins_nothing(bench: Bench, choices: Choices) -> None:
    bench.planned("a.png")
    bench.planned("b.png")
    bench.machine.while_drawing = lambda: print(bench.runner.drain())
    for _ in range(2):
        bench.drawing.turn()
    assert (bench.states(), bench.machine.stops) == (["done", "planned"], 0)
    bench.machine.while_drawing = lambda: None
    bench.runner.go()
    bench.drawing.turn()
    assert bench.states() == ["done", "done"]


def test_a_job_goes_on_from_the_stroke_that_a_person_names(bench: Bench, choices: Choices) -> None:
    interrupted(bench, known=True)
    bench.machine.endings = [Ended(Verdict.FINISHED, 2, 2, True, True, "drawn")]
    assert choices.resume_from("1", 1) == "job 000001-a goes on from stroke 1"
    bench.drawing.turn()
    assert bench.states() == ["done"]
    assert bench.machine.programs[1] == [
        "G21 G90", "G0 Z5", "G0 X1 Y5", "G1 Z0 F600", "G1 X9 Y5 F1200", "G0 Z5", "G0 X0 Y0",
    ]  # fmt: skip
    assert (bench.machine.opened, bench.machine.closed) == (1, 0)


def test_a_job_goes_on_upon_the_sheet_that_is_in_and_before_all_others(tmp_path: Path, shared_pool: Pool) -> None:
    bench = Bench(tmp_path, asks_for_sheets=True, pool=shared_pool)
    interrupted(bench, known=True)
    bench.desk._rank = lambda name: name
    bench.planned("0 goes before it.png")
    Choices(bench.desk, placed=bench.runner.placed).resume_from("1", 1)
    bench.drawing.turn()
    bench.drawing.turn()
    assert (bench.states(), bench.machine.drawn) == (["done", "waiting"], 2)
    assert "waiting for a new sheet" in bench.words()
    bench.journal.close()


def test_the_ink_of_both_parts_is_measured_together(bench: Bench, choices: Choices) -> None:
    bench.machine.ink = [[(1.0, 1.0), (9.0, 1.0)]]
    job = interrupted(bench, known=True)
    bench.machine.ink = [[(1.0, 5.0), (9.0, 5.0)]]
    choices.resume_from("1", 1)
    bench.drawing.turn()
    assert '"ink_strokes": 2' in (bench.desk.folders.path(job) / "report.json").read_text()


def test_a_machine_that_does_not_know_its_origin_is_given_one_first(bench: Bench, choices: Choices) -> None:
    interrupted(bench)
    with pytest.raises(LinedrawError, match="does not know where the sheet's origin is"):
        choices.resume_from("1", 1)
    assert (bench.states(), bool(bench.station.held)) == (["interrupted"], True)
    bench.drawing.obey(MachineOrder("origin"))
    choices.resume_from("1", 1)
    bench.drawing.turn()
    assert bench.states() == ["done"]
    assert bench.machine.corner_mm == (3.0, 4.0)


def test_an_origin_that_is_lost_again_before_the_pen_comes_down_draws_nothing(bench: Bench, choices: Choices) -> None:
    interrupted(bench, known=True)
    choices.resume_from("1", 1)
    after = bench.restarted()
    after.drawing.turn()
    assert (after.states(), after.machine.drawn) == (["interrupted"], 0)
    assert "does not know where the sheet's origin is" in after.station.held
    after.journal.close()


def test_a_daemon_that_is_killed_before_it_goes_on_still_knows_from_where(bench: Bench, choices: Choices) -> None:
    interrupted(bench, known=True)
    choices.resume_from("1", 1)
    after = bench.restarted()
    after.drawing.obey(MachineOrder("origin"))
    after.drawing.turn()
    assert after.states() == ["done"]
    assert len(after.machine.programs[0]) == 7
    after.journal.close()


def test_a_machine_that_has_only_moved_knows_no_origin(bench: Bench, choices: Choices) -> None:
    interrupted(bench)
    bench.drawing.obey(MachineOrder("park"))
    with pytest.raises(LinedrawError, match="does not know where the sheet's origin is"):
        choices.resume_from("1", 1)


@pytest.mark.parametrize(("job", "stroke"), [("1", 2), ("7", 0), ("2", 0)])
def test_a_stroke_or_job_that_there_is_not_is_refused(bench: Bench, choices: Choices, job: str, stroke: int) -> None:
    interrupted(bench, known=True)
    bench.drop("b.png")
    with pytest.raises(LinedrawError, match=r"from 0 to 1: give|there is no job 7|only an interrupted one"):
        choices.resume_from(job, stroke)


def test_a_worker_that_dies_over_a_picture_is_tried_once_more_and_no_more(bench: Bench) -> None:
    bench.drop("crash.png", "crash")
    bench.planning.turn()
    assert bench.states() == ["queued"]
    assert "it is tried once more" in bench.words()
    bench.planning.turn()
    assert bench.states() == ["failed"]
