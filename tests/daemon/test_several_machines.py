"""Several machines in one daemon: one queue, each drawing exactly once, and none of them stops the others."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path

import pytest

from daemon.cli.__main__ import main
from daemon.config import Settings
from daemon.control import Order, give_order
from daemon.errors import LinedrawError
from daemon.jobs.states import State
from tests.daemon.test_service import LITTLE_MEMORY, Daemon, ended, loaded, running

SLOW = "url = 'sim://grbl?speed=25'"
PLANNED = "tests.daemon.planned"


def settings_of(root: Path, **machines: str) -> Settings:
    """One section for each machine, with these lines."""
    sections = "".join(f"[machines.{name}]\n{lines}\n" for name, lines in machines.items())
    return loaded(root, LITTLE_MEMORY + sections)


def order(daemon: Daemon, name: str, machine: str = "") -> str:
    return give_order(daemon.settings.paths.control, Order.model_validate({"order": name, "machine": machine}))


def drawn_by(daemon: Daemon) -> list[str]:
    """The machine that each job was drawn by, in the order of the jobs."""
    return [job.machine for job in daemon.parts.desk.journal.jobs(State.DONE)]


def inked(daemon: Daemon) -> int:
    """How many jobs have ink, each with its own two strokes and no others."""
    inks = [json.loads(path.read_text())["strokes"] for path in daemon.settings.paths.jobs.glob("*/ink.json")]
    # A dot is left where the pen stands when the machine is switched on.
    assert [len([line for line in ink if len(line) > 1]) for ink in inks] == [2] * len(inks)
    return len(inks)


def begun(daemon: Daemon) -> Counter[str]:
    return Counter("state=drawing" in line and line.split()[2] for line in daemon.log().splitlines())


def test_two_machines_draw_ten_pictures_of_one_inbox_each_exactly_once(tmp_path: Path) -> None:
    with running(settings_of(tmp_path, left=SLOW, right=SLOW)) as daemon:
        for number in range(10):
            daemon.drop(f"{number}.png")
        daemon.wait_for(lambda jobs: len(jobs) == 10 and ended(jobs), within_s=60.0)
        assert set(drawn_by(daemon)) == {"left", "right"}
        assert (len(drawn_by(daemon)), inked(daemon)) == (10, 10)
        times = begun(daemon)
    assert [times[job] for job in times if job] == [1] * 10


def test_a_machine_that_is_unplugged_interrupts_its_job_and_the_other_goes_on_with_the_queue(tmp_path: Path) -> None:
    left, right = "url = 'sim://grbl?unplug=1.5'", SLOW + "\ndraw_mm_s = 15"
    with running(settings_of(tmp_path, left=left, right=right)) as daemon:
        for number in range(6):
            daemon.drop(f"{number}.png")
        jobs = daemon.wait_for(lambda jobs: len(jobs) == 6 and ended(jobs), within_s=60.0)
        assert Counter(job.state for job in jobs) == {State.INTERRUPTED: 1, State.DONE: 5}
        assert [job.machine for job in jobs if job.state is State.INTERRUPTED] == ["left"]
        assert set(drawn_by(daemon)) == {"right"}
        stations = daemon.parts.desk.stations
        assert (bool(stations["left"].held), stations["right"].held) == (True, "")


def test_an_inbox_each(tmp_path: Path) -> None:
    settings = settings_of(tmp_path, left=SLOW + "\ninbox = 'left'", right=SLOW + "\ninbox = 'right'")
    settings.paths.inbox.mkdir(parents=True)
    settings.paths.inbox.chmod(0o2770)
    with running(settings) as daemon:
        assert (tmp_path / "state" / "left").stat().st_mode & 0o7777 == 0o2770
        for number in range(3):
            (tmp_path / "state" / "left" / f"{number}.png").write_text("good")
        jobs = daemon.wait_for(lambda jobs: len(jobs) == 3 and ended(jobs))
        (tmp_path / "state" / "left" / "NEXT").write_text("")
        while "a new sheet is in machine=left" not in daemon.log():
            daemon.parts.desk.wait(0.05)
        (tmp_path / "state" / "right" / "side.toml").write_text("machine = 'left'")
        (tmp_path / "state" / "right" / "side.png").write_text("good")
        while "this is the inbox of right: leave it out" not in daemon.log():
            daemon.parts.desk.wait(0.05)
        assert [job.machine for job in jobs] == ["left"] * 3
        assert daemon.parts.desk.journal.count(State.QUEUED) == 0


def test_a_drawing_too_large_for_the_small_one_goes_to_the_large_one(tmp_path: Path) -> None:
    small = SLOW + "\nreach_mm = [70, 70]\nbox_mm = [40, 40]\nbox_origin_mm = [5, 5]"
    with running(settings_of(tmp_path, small=small, large=SLOW), planner="tests.daemon.sized") as daemon:
        for number in range(4):
            daemon.drop(f"{number}.toml", "size_mm = [120, 90]")
            daemon.drop(f"{number}.png")
        daemon.drop("fits.png")
        jobs = daemon.wait_for(lambda jobs: len(jobs) == 5 and ended(jobs), within_s=60.0)
    assert [job.state for job in jobs] == [State.DONE] * 5, jobs
    assert {job.machine for job in jobs if job.name != "fits.png"} == {"large"}


def test_a_drawing_that_only_turns_out_to_be_too_large_is_planned_for_another(tmp_path: Path) -> None:
    small = SLOW + "\nreach_mm = [100, 100]"
    with running(settings_of(tmp_path, small=small, large=SLOW), planner="tests.daemon.sized") as daemon:
        daemon.drop("bulky.png", "150")
        (job,) = daemon.wait_for(ended)
        assert (job.state, job.machine) == (State.DONE, "large")
        assert "small does not reach so far: it is planned for another machine" in daemon.log()
        daemon.drop("huge.png", "900")
        huge = daemon.wait_for(lambda jobs: len(jobs) == 2 and ended(jobs))[1]
    assert (huge.state, "the machine reaches" in huge.words) == (State.FAILED, True)


def test_a_plotter_and_an_arm_draw_what_each_is_given(tmp_path: Path) -> None:
    arm = "device = 'dobot'\nurl = 'sim://dobot?speed=25'"
    with running(settings_of(tmp_path, plotter=SLOW, arm=arm), planner=PLANNED) as daemon:
        for number in range(4):
            daemon.drop(f"{number}.toml", f"machine = '{('plotter', 'arm')[number % 2]}'")
            daemon.drop(f"{number}.png")
        jobs = daemon.wait_for(lambda jobs: len(jobs) == 4 and ended(jobs), within_s=60.0)
        assert [job.state for job in jobs] == [State.DONE] * 4, jobs
        assert {job.name: job.machine for job in jobs} == {
            "0.png": "plotter", "1.png": "arm", "2.png": "plotter", "3.png": "arm",
        }  # fmt: skip


def test_what_holds_one_machine_holds_only_that_one_also_after_a_restart(tmp_path: Path) -> None:
    settings = settings_of(tmp_path, left=SLOW, right=SLOW)
    with running(settings) as daemon:
        assert order(daemon, "stop", "left") == ("stopped, no job starts until you say `linedrawd go --machine left`")
    with running(settings) as daemon:
        stations = daemon.parts.desk.stations
        assert (stations["left"].held, stations["right"].held) == ("a person stopped the machine", "")
        for number in range(3):
            daemon.drop(f"{number}.png")
        daemon.wait_for(lambda jobs: len(jobs) == 3 and ended(jobs))
        assert set(drawn_by(daemon)) == {"right"}
        order(daemon, "stop", "right")
        order(daemon, "go", "left")
        daemon.drop("last.png")
        daemon.wait_for(lambda jobs: len(jobs) == 4 and ended(jobs))
        assert drawn_by(daemon)[-1] == "left"


def test_an_order_that_names_no_machine_says_which_there_are_and_stop_means_all(tmp_path: Path) -> None:
    with running(settings_of(tmp_path, left=SLOW, right=SLOW)) as daemon:
        for name in ("next", "go", "drain", "resume", "check", "park"):
            with pytest.raises(LinedrawError, match=r"which machine\? say --machine and one of left, right"):
                order(daemon, name)
        with pytest.raises(LinedrawError, match="the machine lft is unknown: did you mean left"):
            order(daemon, "go", "lft")
        with pytest.raises(LinedrawError, match="nothing is being drawn"):
            order(daemon, "pause")
        assert "port: " in order(daemon, "check", "right")
        order(daemon, "stop")
        assert all(station.held for station in daemon.parts.desk.stations.values())


def test_a_sheet_is_put_into_one_machine(tmp_path: Path) -> None:
    ask = SLOW + "\nsheet = 'ask'"
    with running(settings_of(tmp_path, left=ask, right=ask)) as daemon:
        for number in range(4):
            daemon.drop(f"{number}.png")
        daemon.wait_for(lambda jobs: len([job for job in jobs if job.state is State.DONE]) == 2)
        assert sorted(drawn_by(daemon)) == ["left", "right"]
        daemon.drop("NEXT", "")
        while "NEXT or PEN of which machine? put NEXT-left or NEXT-right there" not in daemon.log():
            daemon.parts.desk.wait(0.05)
        daemon.drop("NEXT-left", "")
        daemon.wait_for(lambda jobs: len([job for job in jobs if job.state is State.DONE]) == 3)
        assert sorted(drawn_by(daemon)) == ["left", "left", "right"]
        order(daemon, "next", "right")
        daemon.wait_for(ended)
        assert sorted(drawn_by(daemon)) == ["left", "left", "right", "right"]


def test_status_jobs_and_watch_tell_of_each_machine(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    settings = settings_of(tmp_path, left=SLOW, right=SLOW)
    options = ["--config", str(tmp_path / "linedrawd.toml"), "--state-dir", str(tmp_path / "state")]
    with running(settings) as daemon:
        order(daemon, "stop", "left")
        daemon.drop("a.png")
        daemon.wait_for(ended)
        while daemon.status()["machines"]["left"]["state"] != "held":  # type: ignore[index]
            daemon.parts.desk.wait(0.05)
        said = daemon.status()
        assert main(["status", *options]) == 0
        shown = capsys.readouterr().out
        assert main(["watch", "--once", *options]) == 0
        watched = capsys.readouterr().out
        assert main(["stop", "--machine", "right", *options]) == 0
        assert main(["go", *options]) == 1
        assert main(["draw", str(tmp_path / "state" / "status.json"), *options]) == 2
        assert "which machine? say --machine and one of left, right" in capsys.readouterr().err
        assert main(["jobs", "--json", *options]) == 0
        (job,) = json.loads(capsys.readouterr().out)
    assert (said["machine"], said["port"], said["held"]) == ("left, right", "", "")
    assert said["machines"]["left"]["held"] == "a person stopped the machine"  # type: ignore[index]
    assert "\nleft\nstate          held\n" in shown
    assert "\nright\nstate " in shown
    assert "left: held" in watched
    assert "right: " in watched
    assert job["machine"] == "right"


def test_with_one_machine_the_status_has_the_fields_it_always_had(tmp_path: Path) -> None:
    with running(settings_of(tmp_path, plotter="url = 'sim://grbl'")) as daemon:
        daemon.drop("a.png")
        daemon.wait_for(ended)
        order(daemon, "stop")
        while daemon.status()["state"] != "held":
            daemon.parts.desk.wait(0.05)
        said = daemon.status()
    own = said["machines"]["plotter"]  # type: ignore[index]
    assert {key: said[key] for key in own} == own
    assert (said["machine"], said["port"], said["held"]) == ("plotter", "sim://grbl", "a person stopped the machine")
    assert set(said) >= {
        "state", "words", "pid", "machine", "firmware", "port", "job", "picture", "stage", "strokes_done",
        "strokes_total", "percent", "seconds_left", "planning", "jobs_queued", "jobs_waiting", "held", "ink_m", "pen",
        "last_error", "recording", "changed",
    }  # fmt: skip
