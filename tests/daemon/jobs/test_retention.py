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
