"""Jobs go through their states: planned ahead, drawn once, and after a fault none starts until a person says so."""

from __future__ import annotations

import json
from pathlib import Path
from threading import Thread

import pytest

from daemon.errors import MachineFault, NoMachine
from daemon.jobs.desk import DISK_RETRY_S
from daemon.jobs.planning import Planning
from daemon.jobs.pool import Pool
from daemon.jobs.states import State
from daemon.machine.open import LISTEN_S
from daemon.pulse import Heart
from firmware_protocol.session import Verdict
from tests.daemon.jobs.bench import Bench, fault
from tests.daemon.jobs.planners import WARNINGS
from tests.daemon.jobs.test_journal import full_disk


def test_a_picture_is_planned_and_drawn(bench: Bench) -> None:
    bench.drop()
    bench.planning.turn()
    assert bench.states() == ["planned"]
    bench.drawing.turn()
    assert bench.states() == ["done"]
    assert bench.words() == "all 2 strokes are drawn"


def test_what_the_report_of_a_plan_warns_of_stands_in_the_log_of_the_job(bench: Bench) -> None:
    job = bench.planned()
    (said,) = [values for words, values in bench.said if words == WARNINGS[0]]
    assert said["job"] == job


def test_two_jobs_are_planned_ahead_and_no_more(bench: Bench) -> None:
    for number in range(4):
        bench.drop(f"{number}.png")
    for _ in range(4):
        bench.planning.turn()
    assert bench.states() == ["planned", "planned", "queued", "queued"]


def test_a_bad_picture_never_stops_the_next_one(bench: Bench) -> None:
    bench.drop("bad.png", "bad")
    bench.drop("good.png")
    bench.planning.turn()
    bench.planning.turn()
    bench.drawing.turn()
    assert bench.states() == ["failed", "done"]
    assert bench.shown["last_error"] == "bad.png is no picture: drop another"
    assert bench.machine.drawn == 1


def test_a_picture_whose_file_has_gone_fails_with_a_sentence(bench: Bench) -> None:
    job = bench.drop()
    (bench.desk.folders.path(job) / "source.png").unlink()
    bench.planning.turn()
    assert bench.states() == ["failed"]
    assert "drop it into the inbox again" in bench.words()


def test_without_a_machine_jobs_wait_and_the_status_says_for_what(bench: Bench) -> None:
    bench.machine.missing = NoMachine("no serial adapter is plugged in: plug it in")
    bench.planned()
    assert 0 < bench.drawing.turn() <= 3.0
    assert bench.states() == ["waiting"]
    assert bench.shown["words"] == bench.words() == "no serial adapter is plugged in: plug it in"
    bench.machine.missing = None
    bench.drawing.turn()
    assert bench.machine.opened == 0
    bench.now_s += 3.0
    bench.drawing.turn()
    assert bench.states() == ["done"]


def test_a_missing_machine_is_told_once(bench: Bench) -> None:
    bench.machine.missing = NoMachine("no adapter: plug it in")
    for _ in range(5):
        bench.now_s += 10.0
        bench.drawing.turn()
    assert [words for words, _ in bench.said].count("no adapter: plug it in") == 1


@pytest.mark.parametrize("verdict", [Verdict.ALARM, Verdict.RESTARTED, Verdict.SILENT, Verdict.UNPLUGGED])
def test_a_fault_interrupts_the_job_and_no_further_one_starts_until_a_person_says_go(
    bench: Bench, verdict: Verdict
) -> None:
    bench.machine.endings = [fault(verdict)]
    bench.planned("a.png")
    bench.planned("b.png")
    for _ in range(3):
        bench.drawing.turn()
        bench.now_s += 100.0
    assert bench.states() == ["interrupted", "planned"]
    assert "1 are certainly drawn, none from 2 on is touched; the pen may be down" in bench.words(0)
    assert (bench.machine.drawn, bench.machine.opened, bench.machine.closed) == (1, 1, 1)
    assert bench.shown["held"] == f"{verdict.value} at line 7: look at it"
    assert bench.shown["port"] == ""
    assert bench.said[-1][1]["port"] == "instant"
    bench.runner.go()
    bench.drawing.turn()
    assert bench.states() == ["interrupted", "done"]
    assert bench.machine.opened == 2


def test_a_refused_line_fails_the_job_and_holds_the_others_on_the_same_port(bench: Bench) -> None:
    bench.machine.endings = [fault(Verdict.REJECTED)]
    bench.planned("a.png")
    bench.planned("b.png")
    for _ in range(3):
        bench.drawing.turn()
    assert bench.states() == ["failed", "planned"]
    assert bench.machine.closed == 0


def test_a_machine_that_is_unplugged_in_idle_is_opened_again(bench: Bench) -> None:
    bench.drawing.turn()
    bench.machine.unplugged = True
    bench.drawing.turn()
    assert bench.machine.closed == 1
    bench.machine.unplugged = False
    bench.now_s += 3.0
    bench.planned()
    bench.drawing.turn()
    assert bench.states() == ["done"]


def test_a_machine_that_failed_in_idle_is_left_alone_longer_than_one_that_was_unplugged(bench: Bench) -> None:
    bench.drawing.turn()
    bench.machine.unplugged, bench.machine.gone = True, MachineFault
    bench.drawing.turn()
    bench.machine.unplugged = False
    bench.planned()
    bench.now_s += 29.0
    bench.drawing.turn()
    assert bench.machine.opened == 1
    bench.now_s += 1.0
    bench.drawing.turn()
    bench.drawing.turn()
    assert bench.states() == ["done"]


def test_an_idle_machine_is_looked_at_more_often_than_once_a_second(bench: Bench) -> None:
    bench.drawing.turn()
    assert bench.drawing.turn() + LISTEN_S <= 1.0


def test_a_fault_that_the_link_raises_interrupts_too(bench: Bench) -> None:
    def gone() -> None:
        raise MachineFault("gone: look")

    bench.machine.while_drawing = gone
    bench.planned()
    bench.drawing.turn()
    assert bench.states() == ["interrupted"]
    assert "0 are certainly drawn, none from 2 on is touched" in bench.words()


def test_one_drawing_a_sheet(tmp_path: Path, shared_pool: Pool) -> None:
    bench = Bench(tmp_path, asks_for_sheets=True, pool=shared_pool)
    bench.planned("a.png")
    bench.planned("b.png")
    for _ in range(3):
        bench.drawing.turn()
    assert bench.states() == ["done", "waiting"]
    assert bench.words() == "waiting for a new sheet: put one in and say `linedrawd next`"
    bench.runner.new_sheet()
    bench.drawing.turn()
    assert bench.states() == ["done", "done"]
    bench.journal.close()


def test_progress_counts_strokes_and_seconds_by_what_is_drawn(bench: Bench) -> None:
    seen: list[tuple[int, float, float]] = []
    bench.on_show(lambda shown: seen.append((shown["strokes_done"], shown["percent"], shown["seconds_left"])))
    bench.planned()
    bench.drawing.turn()
    assert seen[4:6] == [(0, 45.5, 6.0), (1, 54.5, 5.0)]
    assert seen[-1] == (2, 90.9, 1.0)


def test_the_ink_of_a_simulated_machine_is_kept_and_measured(bench: Bench) -> None:
    bench.machine.ink = [[(1.0, 1.0), (9.0, 1.0)], [(1.0, 5.0), (9.0, 5.0)]]
    folder = bench.desk.folders.path(bench.planned())
    bench.drawing.turn()
    assert len(json.loads((folder / "ink.json").read_text())["strokes"]) == 2
    told = {"strokes": 2, "real_s": 12.5, "warnings": WARNINGS, "ink_strokes": 2}
    assert json.loads((folder / "report.json").read_text()) == told


def test_a_drawing_that_cannot_be_recorded_is_not_forgotten(bench: Bench) -> None:
    """The disk is full when the last line is drawn, and is freed while the runner waits."""
    bench.planned()
    limit = full_disk(64)
    bench.machine.while_drawing = limit.__enter__
    bench.desk.wait = lambda seconds, since=None: limit.__exit__(None, None, None)  # type: ignore[method-assign]
    bench.drawing.turn()
    assert bench.states() == ["done"]
    assert any("cannot be written" in words and "free the disk" in words for words, _ in bench.said)


def test_a_trouble_that_stays_is_said_once(bench: Bench) -> None:
    for _ in range(3):
        bench.desk.trouble("the disk is full: free it")
    bench.drop()
    bench.planning.turn()
    bench.desk.trouble("the disk is full: free it")
    assert [words for words, _ in bench.said].count("the disk is full: free it") == 2


def with_a_disk(bench: Bench, *, free_mb: float) -> None:
    bench.planning = Planning(
        bench.desk, bench.pool, bench.allotment, now=lambda: bench.now_s, free=lambda folder: int(free_mb * 1e6)
    )


@pytest.mark.parametrize(("free_mb", "what"), [(1.0, "refuse"), (1e6, "fill")])
def test_a_full_disk_is_waited_for_by_every_picture(bench: Bench, free_mb: float, what: str) -> None:
    """Also where there is room and it may not be used, as with a quota."""
    with_a_disk(bench, free_mb=free_mb)
    job = bench.drop("fill.png", what)
    bench.drop("good.png")
    for _ in range(4):
        bench.planning.turn()
        assert 0.0 < bench.planning.turn() <= DISK_RETRY_S
        bench.now_s += DISK_RETRY_S
    assert bench.states() == ["queued", "queued"]
    assert "free the disk" in str(bench.shown["last_error"])
    (bench.desk.folders.path(job) / "source.png").write_text("good")
    bench.planning.turn()
    bench.planning.turn()
    assert bench.states() == ["planned", "planned"]


def test_a_folder_that_takes_nothing_fails_alone_after_another_try(bench: Bench) -> None:
    with_a_disk(bench, free_mb=1e6)
    bench.drop("fill.png", "refuse")
    bench.drop("good.png")
    for state in ("queued", "failed"):
        bench.planning.turn()
        assert bench.states() == [state, "queued"]
        bench.now_s += DISK_RETRY_S
    bench.planning.turn()
    assert bench.states() == ["failed", "planned"]
    assert (bench.desk.folders.path("000001-fill") / "source.png").exists()


def test_a_mistake_of_ours_holds_everything(bench: Bench) -> None:
    def mistake() -> float:
        bench.desk.ending = True
        raise KeyError("a mistake")

    bench.runner._turn_on(mistake, Heart("drawing"), 1.0, [bench.drawing])
    assert "a mistake in linedrawd (KeyError('a mistake'))" in bench.station.held
    assert bench.shown["last_error"] == bench.station.held
    assert bench.machine.stops == 0


def test_the_loops_draw_what_comes_and_end(tmp_path: Path) -> None:
    bench = Bench(tmp_path)
    loops = [Thread(target=bench.runner.plan_on), Thread(target=bench.runner.draw_on, args=("plotter",))]
    for loop in loops:
        loop.start()
    for number in range(5):
        bench.drop(f"{number}.png")
    bench.wait_for(lambda: bench.journal.jobs(State.DONE)[4:])
    bench.runner.end()
    for loop in loops:
        loop.join(10)
        assert not loop.is_alive()
    assert bench.states() == ["done"] * 5
    assert bench.machine.closed == 1
    bench.close()
