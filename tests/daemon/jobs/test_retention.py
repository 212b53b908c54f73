"""What is over goes, the oldest first; what is not done stays, whatever the bounds say."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from daemon.config import Keep
from daemon.jobs.retention import DAY_S, EVERY_S, Retention
from daemon.jobs.states import Reason, State
from tests.daemon.jobs.bench import Bench

WAYS = {
    State.DONE: (State.PLANNING, State.PLANNED, State.DRAWING, State.DONE),
    State.FAILED: (State.PLANNING, State.FAILED),
    State.CANCELLED: (State.CANCELLED,),
    State.INTERRUPTED: (State.PLANNING, State.PLANNED, State.DRAWING, State.INTERRUPTED),
    State.PLANNED: (State.PLANNING, State.PLANNED),
    State.QUEUED: (),
}

REASONS = {State.INTERRUPTED: Reason.POSITION_UNKNOWN}


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Bench]:
    bench = Bench(tmp_path)
    yield bench
    bench.close()


def put(bench: Bench, state: State, *, size: int = 0) -> str:
    job = bench.drop(f"{state.value}.png")
    for step in WAYS[state]:
        bench.desk.step(job, step, reason=REASONS.get(step, Reason.NONE))
    (bench.desk.folders.path(job) / "preview.png").write_bytes(b"x" * size)
    return job


def turn(bench: Bench, keep: Keep, *, days_later: float = 0.0) -> set[str]:
    at_s = bench.journal.jobs()[0].changed_s + days_later * DAY_S
    Retention(bench.desk, keep, wall=lambda: at_s, now=lambda: 0.0).turn()
    return {path.name for path in bench.desk.folders.root.iterdir()}


def test_what_is_too_old_goes_if_it_is_over(bench: Bench) -> None:
    jobs = {state: put(bench, state) for state in (*WAYS, State.QUEUED)}
    assert turn(bench, Keep(jobs_days=10), days_later=9) == set(jobs.values()) | {"000006-queued"}
    left = turn(bench, Keep(jobs_days=10), days_later=11)
    assert not {jobs[state] for state in (State.DONE, State.FAILED, State.CANCELLED)} & left
    assert {jobs[state] for state in (State.INTERRUPTED, State.PLANNED, State.QUEUED)} < left


def test_the_oldest_go_until_the_rest_keeps_within_its_size(bench: Bench) -> None:
    _, second, third = (put(bench, State.DONE, size=1_000_000) for _ in range(3))
    assert turn(bench, Keep(jobs_mb=2.5)) == {second, third}
    assert "the folder of a job that is over was removed to keep within [keep]" in bench.sayings()


def test_work_that_is_not_done_stays_however_large_it_is(bench: Bench) -> None:
    jobs = {put(bench, state, size=1_000_000) for state in (State.INTERRUPTED, State.PLANNED, State.QUEUED)}
    assert turn(bench, Keep(jobs_mb=0.001), days_later=1000) == jobs


def test_the_last_folder_stays_so_that_no_number_is_given_twice(bench: Bench) -> None:
    put(bench, State.DONE)
    last = put(bench, State.DONE)
    assert turn(bench, Keep(jobs_days=1), days_later=2) == {last}


def test_what_a_cut_left_half_removed_is_no_job_and_goes(bench: Bench) -> None:
    half = bench.root / ".going-000001-a"
    half.mkdir()
    (half / "source.png").write_text("picture")
    assert bench.desk.folders.strays(set()) == []
    put(bench, State.QUEUED)
    turn(bench, Keep())
    assert not half.exists()


def test_it_is_looked_at_now_and_then(bench: Bench) -> None:
    now = [0.0]
    put(bench, State.DONE)
    retention = Retention(bench.desk, Keep(jobs_days=1e-9), wall=lambda: 1e12, now=lambda: now[0])
    retention.turn()
    put(bench, State.DONE)
    now[0] = EVERY_S - 1
    retention.turn()
    assert len(list(bench.desk.folders.root.iterdir())) == 2
    now[0] = EVERY_S
    retention.turn()
    assert len(list(bench.desk.folders.root.iterdir())) == 1


class Clocks:
    """Of a computer: one that goes on evenly since it was switched on, and one that is set."""

    def __init__(self, bench: Bench, wall_s: float) -> None:
        self.bench, self.wall_s, self.now_s = bench, wall_s, 30.0
        bench.journal._now = lambda: self.wall_s

    def retention(self) -> Retention:
        return Retention(self.bench.desk, Keep(jobs_days=30), wall=lambda: self.wall_s, now=lambda: self.now_s)

    def passes(self, seconds: float) -> None:
        self.wall_s, self.now_s = self.wall_s + seconds, self.now_s + seconds

    def left(self) -> set[str]:
        return {path.name for path in self.bench.desk.folders.root.iterdir()}


TODAY_S = 1795000000.0


@pytest.mark.parametrize("booted_s", [0.0, TODAY_S - 90 * DAY_S], ids=["1970", "when it was switched off"])
@pytest.mark.parametrize("restarted", [False, True])
def test_a_clock_that_is_set_after_the_start_makes_no_job_old(bench: Bench, booted_s: float, restarted: bool) -> None:
    clocks = Clocks(bench, booted_s)
    retention = clocks.retention()
    jobs = {put(bench, State.DONE), put(bench, State.FAILED), put(bench, State.QUEUED)}
    clocks.passes(EVERY_S)
    retention.turn()
    clocks.wall_s = TODAY_S
    retention.turn()
    if restarted:
        retention = clocks.retention()
    clocks.passes(29 * DAY_S)
    retention.turn()
    assert clocks.left() == jobs
    clocks.passes(2 * DAY_S)
    retention.turn()
    assert clocks.left() == {"000003-queued"}


def test_a_daemon_that_starts_after_an_unset_clock_was_set_counts_from_then(bench: Bench) -> None:
    clocks = Clocks(bench, 100.0)
    jobs = {put(bench, State.DONE), put(bench, State.QUEUED)}
    clocks.wall_s = TODAY_S
    retention = clocks.retention()
    retention.turn()
    assert clocks.left() == jobs
    clocks.passes(31 * DAY_S)
    retention.turn()
    assert clocks.left() == {"000002-queued"}


def test_a_clock_that_was_never_set_makes_no_job_old(bench: Bench) -> None:
    clocks = Clocks(bench, 0.0)
    jobs = {put(bench, State.DONE), put(bench, State.QUEUED)}
    clocks.passes(400 * DAY_S)
    clocks.retention().turn()
    assert clocks.left() == jobs


def test_a_clock_that_jumps_back_a_year_makes_no_job_old_and_none_younger(bench: Bench) -> None:
    clocks = Clocks(bench, TODAY_S + 365 * DAY_S)
    retention = clocks.retention()
    early = put(bench, State.DONE, size=1_000_000)
    clocks.passes(EVERY_S)
    clocks.wall_s = TODAY_S
    late = put(bench, State.DONE, size=1_000_000)
    queued = put(bench, State.QUEUED)
    clocks.passes(EVERY_S)
    retention.turn()
    assert clocks.left() == {early, late, queued}
    retention.keep = Keep(jobs_mb=1.5)
    clocks.passes(EVERY_S)
    retention.turn()
    assert clocks.left() == {late, queued}


def test_a_clock_that_is_corrected_a_little_changes_no_age(bench: Bench) -> None:
    clocks = Clocks(bench, TODAY_S)
    retention = clocks.retention()
    put(bench, State.DONE)
    put(bench, State.QUEUED)
    for _ in range(31):
        clocks.passes(DAY_S)
        clocks.wall_s += 2.0
        retention.turn()
    assert clocks.left() == {"000002-queued"}
