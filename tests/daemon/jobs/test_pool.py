"""A picture that kills, fills or stops the worker fails alone; the next one is planned."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from threading import Event, Thread

import pytest

from daemon.config import Options, Settings, load_settings
from daemon.errors import BadPicture, DiskTrouble, LinedrawError, PlanningFailed
from daemon.jobs.pool import Pool

PLANNER = "tests.daemon.jobs.planners"
NEEDS_MORE = "planning needs more than 256 MB: scale the picture down or raise memory_mb"


def settings_with(folder: Path, **planning: float) -> Settings:
    given = load_settings(Options(device="sim", state_dir=folder / "state"), environment={"HOME": str(folder)})
    limits = given.planning.model_copy(update={"memory_mb": 256, "time_limit_s": 20.0} | planning)
    return given.model_copy(update={"planning": limits})


@pytest.fixture
def pool(tmp_path: Path) -> Iterator[Pool]:
    pool = Pool(settings_with(tmp_path), planner=PLANNER)
    yield pool
    pool.close()


def plan(pool: Pool, folder: Path, text: str) -> list[str]:
    (folder / "source.png").write_text(text)
    stages: list[str] = []
    pool.plan(folder / "source.png", folder, "plotter", progress=stages.append)
    return stages


def test_the_worker_fills_the_folder_and_tells_its_stages(pool: Pool, tmp_path: Path) -> None:
    assert plan(pool, tmp_path, "good") == ["decode", "write"]
    assert json.loads((tmp_path / "strokes.json").read_text())["machine"] == "plotter"


def test_the_worker_gives_way_to_the_machine_and_phones_nobody(pool: Pool, tmp_path: Path) -> None:
    plan(pool, tmp_path, "good")
    assert json.loads((tmp_path / "strokes.json").read_text())["nice"] >= 10
    environment = json.loads((tmp_path / "environment.json").read_text())
    assert environment["ORT_DISABLE_TELEMETRY"] == "1"
    assert environment["OMP_NUM_THREADS"] == "1"


@pytest.mark.parametrize(
    ("text", "error", "sentence"),
    [
        ("bad", BadPicture, "source.png is no picture: drop another"),
        ("crash", PlanningFailed, "the planning process was killed by SIGSEGV: try another picture"),
        ("eat", PlanningFailed, NEEDS_MORE),
        ("eat in C++", PlanningFailed, NEEDS_MORE),
        ("eat in OpenCV", PlanningFailed, NEEDS_MORE),
        ("fill", DiskTrouble, "No space left on device: free the disk"),
        ("mistake", PlanningFailed, "ended with 1 after saying KeyError: 'a mistake in the planner'"),
    ],
)
def test_a_bad_picture_fails_with_a_sentence_and_the_next_one_is_planned(
    pool: Pool, tmp_path: Path, text: str, error: type[LinedrawError], sentence: str
) -> None:
    with pytest.raises(error) as failed:
        plan(pool, tmp_path, text)
    assert sentence in str(failed.value)
    assert plan(pool, tmp_path, "good") == ["decode", "write"]


def test_an_endless_picture_is_broken_off(tmp_path: Path) -> None:
    pool = Pool(settings_with(tmp_path, time_limit_s=0.6), planner=PLANNER)
    with pytest.raises(PlanningFailed, match=r"more than 0\.6 s"):
        plan(pool, tmp_path, "hang")
    pool.close()


def test_an_answer_that_nobody_waited_for_answers_no_other_question(pool: Pool, tmp_path: Path) -> None:
    def give_up(stage: str) -> None:
        raise KeyboardInterrupt

    (tmp_path / "source.png").write_text("good")
    with pytest.raises(KeyboardInterrupt):
        pool.plan(tmp_path / "source.png", tmp_path, "plotter", progress=give_up)
    with pytest.raises(BadPicture):
        plan(pool, tmp_path, "bad")


def test_one_worker_is_kept_for_all_pictures(pool: Pool, tmp_path: Path) -> None:
    plan(pool, tmp_path, "good")
    first = pool._worker
    with pytest.raises(BadPicture):
        plan(pool, tmp_path, "bad")
    plan(pool, tmp_path, "good")
    assert pool._worker is first


def test_the_ink_is_measured_where_the_simulator_left_it(pool: Pool, tmp_path: Path) -> None:
    plan(pool, tmp_path, "good")
    (tmp_path / "ink.json").write_text('{"strokes": [[[0, 0], [1, 1]]]}')
    pool.measure(tmp_path, "plotter")
    assert json.loads((tmp_path / "report.json").read_text())["ink_strokes"] == 1


def test_closing_breaks_off_a_picture_and_leaves_no_process(pool: Pool, tmp_path: Path) -> None:
    (tmp_path / "source.png").write_text("hang")
    begun, failed = Event(), Event()

    def plan_it() -> None:
        try:
            pool.plan(tmp_path / "source.png", tmp_path, "plotter", progress=lambda stage: begun.set())
        except PlanningFailed:
            failed.set()

    thread = Thread(target=plan_it)
    thread.start()
    assert begun.wait(10)
    worker = pool._worker
    pool.close()
    thread.join(10)
    assert failed.is_set()
    assert worker is not None
    assert not worker.alive
    with pytest.raises(PlanningFailed, match="ending"):
        plan(pool, tmp_path, "good")
