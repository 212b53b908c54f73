"""A job that a person has to approve waits for that word and for nothing else; the others go on."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from daemon.cli.__main__ import main
from daemon.config import Settings
from daemon.errors import LinedrawError
from daemon.jobs.allotment import Allotment
from daemon.jobs.choices import Choices
from daemon.jobs.planning import Planning
from daemon.jobs.states import Reason, State
from tests.daemon.jobs.bench import Bench
from tests.daemon.test_service import Daemon, ended, running, settings_of


def asking(bench: Bench, *names: str) -> Choices:
    """The jobs of these pictures have to be approved."""

    def asks(job: str) -> bool:
        return bench.desk.find(job).name in names

    bench.allotment = Allotment(bench.desk, asks=asks)
    bench.planning = Planning(bench.desk, bench.pool, bench.allotment)
    return Choices(bench.desk, placed=bench.runner.placed)


def test_it_waits_and_is_drawn_once_it_has_been_approved(bench: Bench) -> None:
    choices = asking(bench, "a.png")
    bench.planned()
    bench.drawing.turn()
    (job,) = bench.journal.jobs()
    assert (job.state, job.reason) == (State.WAITING, Reason.APPROVAL)
    assert job.words.startswith(f"look at {bench.desk.folders.path(job.id)}/preview.html, then `linedrawd approve 1`")
    assert choices.approve("1") == "job 000001-a is drawn when its turn comes"
    bench.drawing.turn()
    assert bench.states() == ["done"]


def test_it_stops_none_of_the_jobs_behind_it_from_being_planned_and_drawn(bench: Bench) -> None:
    asking(bench, "a.png", "b.png", "c.png")
    for name in ("a.png", "b.png", "c.png", "d.png"):
        bench.planned(name)
    bench.drawing.turn()
    assert bench.states() == ["waiting", "waiting", "waiting", "done"]
    assert (bench.shown["jobs_to_approve"], bench.shown["jobs_waiting"]) == (3, 0)


def test_it_waits_after_a_restart_too(bench: Bench) -> None:
    asking(bench, "a.png")
    bench.planned()
    after = bench.restarted()
    after.drawing.turn()
    (job,) = after.journal.jobs()
    assert (job.state, job.reason) == (State.WAITING, Reason.APPROVAL)
    Choices(after.desk, placed=after.runner.placed).approve("1")
    again = after.restarted()
    again.drawing.turn()
    assert again.states() == ["done"]
    again.journal.close()


def test_a_job_that_was_approved_and_finds_no_machine_needs_no_second_word(bench: Bench) -> None:
    choices = asking(bench, "a.png")
    bench.planned()
    choices.approve("1")
    bench.station.let_wait("no machine")
    (job,) = bench.journal.jobs()
    assert (job.state, job.reason) == (State.WAITING, Reason.NONE)
    bench.drawing.turn()
    assert bench.states() == ["done"]


def test_only_what_waits_for_it_is_approved(bench: Bench) -> None:
    choices = asking(bench)
    bench.planned()
    with pytest.raises(LinedrawError, match="planned: it does not wait for anybody's approval"):
        choices.approve("1")
    with pytest.raises(LinedrawError, match="there is no job 7"):
        choices.approve("7")


def test_what_nobody_approves_is_cancelled(bench: Bench) -> None:
    asking(bench, "a.png")
    bench.planned()
    bench.runner.cancel("1")
    bench.drawing.turn()
    assert bench.states() == ["cancelled"]


def test_the_one_picture_that_a_person_draws_now_is_approved_by_that(bench: Bench) -> None:
    asking(bench, "a.png")
    bench.desk.only = bench.drop()
    bench.planning.turn()
    assert bench.states() == ["planned"]


def with_approval(settings: Settings) -> Settings:
    return settings.model_copy(update={"intake": settings.intake.model_copy(update={"approve": True})})


def waits(daemon: Daemon) -> None:
    daemon.wait_for(lambda jobs: [job.reason for job in jobs] == [Reason.APPROVAL])


def test_the_settings_ask_for_it_and_status_and_jobs_say_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    settings = with_approval(settings_of(tmp_path))
    with running(settings) as daemon:
        daemon.drop("a.png")
        waits(daemon)
        while not daemon.status().get("jobs_to_approve"):
            daemon.parts.desk.wait(0.05)
        places = ["--state-dir", str(tmp_path / "state")]
        assert main(["status", *places]) == 0
        assert "`linedrawd approve JOB` or `linedrawd cancel JOB`" in capsys.readouterr().out
        assert main(["jobs", "--json", *places]) == 0
        (said,) = json.loads(capsys.readouterr().out)
        assert (said["state"], said["reason"]) == ("waiting", "approval")
        assert "linedrawd approve JOB" in said["remedy"]
        assert main(["approve", "1", *places]) == 0
        (job,) = daemon.wait_for(ended)
        assert job.state is State.DONE


def test_a_side_file_asks_for_it_and_cannot_waive_it(tmp_path: Path) -> None:
    (tmp_path / "other").mkdir()
    settings = settings_of(tmp_path)
    with running(settings) as daemon:
        (settings.paths.inbox / "a.toml").write_text("approve = true")
        daemon.drop("a.png")
        waits(daemon)
    settings = with_approval(settings_of(tmp_path / "other"))
    with running(settings) as daemon:
        (settings.paths.inbox / "a.toml").write_text("approve = false")
        daemon.drop("a.png")
        waits(daemon)
