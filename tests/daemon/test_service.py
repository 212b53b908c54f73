"""The daemon as a whole, on a simulated machine: pictures are dropped, drawings come out, and it ends in order."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Event, Thread
from typing import Any

import pytest

from daemon.config import GrblMachine, Options, ServoPenSettings, Settings, ZPenSettings, load_settings
from daemon.control import Order, give_order
from daemon.errors import DiskFull, SettingsError
from daemon.jobs.arrivals import Arrivals
from daemon.jobs.grbl import touches
from daemon.jobs.journal import Job
from daemon.jobs.states import State
from daemon.parts import Parts, parts_of
from daemon.service import Service
from firmware_protocol.ink import PenRule
from tests.daemon.jobs.test_pool import PLANNER

LITTLE_MEMORY = "[planning]\nmemory_mb = 256\n"


def loaded(root: Path, text: str, **options: Any) -> Settings:
    """The settings of a daemon that lives in this folder and takes pictures at once. options: see `Options`."""
    file = root / "linedrawd.toml"
    file.write_text(f"[intake]\nsettle_s = 0.02\n{text}")
    return load_settings(Options(config=file, state_dir=root / "state", **options), environment={"HOME": str(root)})


def settings_of(root: Path, *, port: str = "sim://grbl", sheet: str = "auto") -> Settings:
    return loaded(root, f"{LITTLE_MEMORY}[machines.left]\nsheet = '{sheet}'\n", port=port)


class Daemon:
    def __init__(self, settings: Settings, parts: Parts) -> None:
        self.settings, self.parts = settings, parts

    def drop(self, name: str, text: str = "good") -> None:
        (self.settings.paths.inbox / name).write_text(text)

    def wait_for(self, true: Callable[[list[Job]], object], *, within_s: float = 30.0) -> list[Job]:
        """Sleeps on the desk's own bell."""
        desk, until = self.parts.desk, time.monotonic() + within_s
        while True:
            seen, jobs = desk.changes, desk.journal.jobs()
            if true(jobs):
                return jobs
            assert time.monotonic() < until, jobs
            desk.wait(max(0.0, until - time.monotonic()), since=seen)

    def order(self, order: str, job: str = "") -> str:
        return give_order(self.settings.paths.control, Order.model_validate({"order": order, "job": job}))

    def folder(self, job: Job) -> Path:
        return self.parts.desk.folders.path(job.id)

    def status(self) -> dict[str, object]:
        found: dict[str, object] = json.loads(self.settings.paths.status.read_text())
        return found

    def log(self) -> str:
        return (self.settings.paths.log_dir / "linedrawd.log").read_text()


@contextmanager
def running(settings: Settings, *, planner: str | None = PLANNER) -> Iterator[Daemon]:
    with parts_of(settings, planner=planner) as parts:
        service = Service(settings, parts)
        thread = Thread(target=service.run)
        thread.start()
        try:
            yield Daemon(settings, parts)
        finally:
            service.end()
            thread.join(20)
        assert not thread.is_alive()


def ended(jobs: list[Job]) -> bool:
    return bool(jobs) and all(job.state in (State.DONE, State.FAILED, State.INTERRUPTED) for job in jobs)


def test_what_is_dropped_is_drawn_and_its_ink_is_kept(tmp_path: Path) -> None:
    settings = settings_of(tmp_path)
    settings.paths.inbox.mkdir(parents=True)
    (settings.paths.inbox / "before the start.png").write_text("good")
    with running(settings) as daemon:
        (job,) = daemon.wait_for(ended)
        ink = json.loads((daemon.folder(job) / "ink.json").read_text())["strokes"]
    assert (job.state, job.name) == (State.DONE, "before the start.png")
    drawn = [[stroke[0], stroke[-1]] for stroke in ink if len(stroke) > 1]
    assert drawn == [[pytest.approx([1, 1]), pytest.approx([9, 1])], [pytest.approx([1, 5]), pytest.approx([9, 5])]]


def test_a_bad_picture_fails_visibly_and_never_stops_the_next_one(tmp_path: Path) -> None:
    with running(settings_of(tmp_path)) as daemon:
        daemon.drop("bad.png", "bad")
        daemon.wait_for(ended)
        daemon.drop("good.png")
        bad, good = daemon.wait_for(lambda jobs: len(jobs) == 2 and ended(jobs))
        assert (bad.state, good.state) == (State.FAILED, State.DONE)
        (line,) = (line for line in daemon.log().splitlines() if "bad.png is no picture: drop another" in line)
        assert line in (daemon.folder(bad) / "job.log").read_text().splitlines()
        told = json.loads((daemon.folder(bad) / "job.json").read_text())["words"]
    assert daemon.status()["last_error"] == bad.words == told == "bad.png is no picture: drop another"


def test_two_hundred_pictures_at_once_are_all_claimed_in_order(tmp_path: Path) -> None:
    settings = settings_of(tmp_path, port="/dev/does-not-exist")
    settings.paths.inbox.mkdir(parents=True)
    for number in range(200):
        path = settings.paths.inbox / f"{number:03d}.png"
        path.write_text("good")
        os.utime(path, ns=(number, number))
    with running(settings) as daemon:
        jobs = daemon.wait_for(lambda jobs: len(jobs) == 200)
    assert [job.name for job in jobs] == [f"{number:03d}.png" for number in range(200)]
    assert list(settings.paths.inbox.iterdir()) == []


def test_without_a_machine_the_daemon_keeps_running_and_says_what_it_waits_for(tmp_path: Path) -> None:
    with running(settings_of(tmp_path, port="/dev/does-not-exist")) as daemon:
        daemon.drop("a.png")
        (job,) = daemon.wait_for(lambda jobs: jobs and jobs[0].state is State.WAITING)
        assert daemon.order("ping") == "linedrawd runs"
        assert daemon.parts.board.now.words == job.words
    assert "/dev/does-not-exist" in job.words


@pytest.mark.parametrize("fault", ["unplug=1.5", "hang=1.5", "brownout=1.5", "limit=1.5"])
def test_a_machine_that_fails_in_mid_job_interrupts_it_and_nothing_starts_until_go(tmp_path: Path, fault: str) -> None:
    with running(settings_of(tmp_path, port=f"sim://grbl?{fault}")) as daemon:
        daemon.drop("a.png")
        daemon.wait_for(ended)
        daemon.drop("b.png")
        first, second = daemon.wait_for(lambda jobs: jobs[1:] and jobs[1].state is State.PLANNED)
        assert first.state is State.INTERRUPTED
        assert "of 2 strokes 0 are certainly drawn" in first.words
        assert daemon.parts.desk.stations["left"].held
    assert second.state is State.PLANNED
    assert daemon.status()["held"]


def test_one_drawing_a_sheet_until_a_file_says_next(tmp_path: Path) -> None:
    with running(settings_of(tmp_path, sheet="ask")) as daemon:
        daemon.drop("a.png")
        daemon.wait_for(ended)
        daemon.drop("b.png")
        jobs = daemon.wait_for(lambda jobs: jobs[1:] and jobs[1].state is State.WAITING)
        assert "new sheet" in jobs[1].words
        daemon.drop("NEXT", "")
        daemon.wait_for(ended)
        daemon.drop("c.png")
        daemon.wait_for(lambda jobs: jobs[2:] and jobs[2].state is State.WAITING)
        daemon.order("next")
        daemon.wait_for(ended)


def test_stop_freezes_the_queue_and_go_frees_it(tmp_path: Path) -> None:
    with running(settings_of(tmp_path)) as daemon:
        daemon.order("stop")
        daemon.drop("a.png")
        daemon.wait_for(lambda jobs: jobs and jobs[0].state is State.PLANNED)
        assert daemon.parts.board.now.held == "a person stopped the machine"
        daemon.order("go")
        daemon.wait_for(ended)


def test_an_end_in_mid_drawing_lifts_the_pen_and_leaves_the_job_interrupted(tmp_path: Path) -> None:
    with running(settings_of(tmp_path, port="sim://grbl?speed=1")) as daemon:
        station, begun = daemon.parts.desk.stations["left"], Event()
        show = station.show

        def show_and_tell(**values: object) -> None:
            show(**values)
            if float(str(values.get("percent", 0))) > 30:  # the pen is on the sheet
                begun.set()

        station.show = show_and_tell
        daemon.drop("a.png")
        assert begun.wait(20)
    log = daemon.log()
    assert "state=interrupted" in log
    assert "the pen is up" in log
    assert (daemon.status()["state"], daemon.status()["pid"]) == ("ended", 0)


def test_a_second_daemon_on_the_same_folder_is_refused_and_names_the_first(tmp_path: Path) -> None:
    settings = settings_of(tmp_path)
    with (
        parts_of(settings, planner=PLANNER),
        pytest.raises(SettingsError, match=f"process {os.getpid()}, already works on .*--state-dir"),
        parts_of(settings, planner=PLANNER),
    ):
        pass


def test_the_status_is_there_before_anything_happens(tmp_path: Path) -> None:
    settings, found = settings_of(tmp_path), list[str]()
    with parts_of(settings, planner=PLANNER) as parts:
        service = Service(settings, parts)
        parts.desk.recover = lambda: found.append(settings.paths.status.read_text())  # type: ignore[method-assign]
        service.end()
        service.run()
    assert '"state": "idle"' in found[0]


def test_the_status_names_the_recording(tmp_path: Path) -> None:
    for record in (tmp_path / "said.txt", None):
        with parts_of(settings_of(tmp_path), planner=PLANNER, record=record) as parts:
            assert parts.board.now.recording == (str(record) if record else "")


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_a_thread_that_dies_ends_the_daemon_in_order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    settings = settings_of(tmp_path)
    # A mistake of ours, which no room expects.
    monkeypatch.setattr("daemon.jobs.arrivals.Arrivals.take", lambda *_, **__: 1 / 0)
    with parts_of(settings, planner=PLANNER) as parts:
        service = Service(settings, parts)
        (settings.paths.inbox / "a.png").write_text("good")
        assert service.run() is False
    assert json.loads(settings.paths.status.read_text())["state"] == "ended"


def test_the_pen_of_a_simulated_machine_is_up_where_the_settings_say() -> None:
    assert touches(GrblMachine(dialect="paper", pen=ZPenSettings(kind="z", up_mm=-5))) == PenRule(up_is_minus=True)
    assert touches(GrblMachine(pen=ZPenSettings(kind="z", down_mm=1))) == PenRule(down_at_mm=1)
    assert touches(GrblMachine(pen=ServoPenSettings(kind="servo", up_s=3))) == PenRule(down_s=1000, up_s=3)


def test_the_daemons_own_process_loads_no_network_no_vision_and_no_arrays() -> None:
    program = (
        "import sys; from daemon.cli import __main__ as main; main.whole_parser(); "
        "print({'onnxruntime', 'cv2', 'numpy', 'torch'} & set(sys.modules))"
    )
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert found.stdout == "set()\n"


def test_a_side_file_makes_copies_and_its_mistakes_are_told_until_they_are_mended(tmp_path: Path) -> None:
    with running(settings_of(tmp_path)) as daemon:
        daemon.drop("house.toml", "copys = 2")
        daemon.drop("house.png")
        while "house.toml: copys is unknown: did you mean copies?" not in daemon.log():
            daemon.parts.desk.wait(0.05)
        assert daemon.parts.desk.journal.jobs() == []
        daemon.drop("house.toml", "copies = 2")
        jobs = daemon.wait_for(lambda jobs: len(jobs) == 2 and ended(jobs))
    assert [(job.name, job.state) for job in jobs] == [("house.png", State.DONE)] * 2


def test_a_file_says_that_a_new_pen_is_in(tmp_path: Path) -> None:
    with running(settings_of(tmp_path)) as daemon:
        daemon.parts.pens["left"].ink_m = 12.0
        daemon.drop("PEN", "")
        while daemon.parts.pens["left"].ink_m:
            daemon.parts.desk.wait(0.05)
        assert "a new pen is in drawn_with_the_old_m=12" in daemon.log()


def at_rest(settings: Settings, parts: Parts) -> Service:
    """One that runs no loop; nobody can reach it."""
    service = Service(settings, parts)
    service._control._close()
    return service


def test_each_picture_gives_the_loop_of_the_inbox_its_time(tmp_path: Path) -> None:
    settings = settings_of(tmp_path)
    with parts_of(settings, planner=PLANNER) as parts:
        service, heart = at_rest(settings, parts), parts.pulse.inbox("all")
        settings.paths.inbox.mkdir(exist_ok=True)
        (settings.paths.inbox / "a.png").write_text("good")
        heart.within(-1.0)
        service._claim("", settings.paths.inbox / "a.png", None)
        assert heart.late_s == 0.0
        assert [job.name for job in parts.desk.journal.jobs()] == ["a.png"]


def test_what_a_full_disk_broke_off_goes_on_at_the_next_look(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    settings, looks = settings_of(tmp_path), list[str]()

    def finish(arrivals: Arrivals) -> None:
        looks.append("")
        raise DiskFull("no room for page 2: free the disk")

    monkeypatch.setattr(Arrivals, "finish", finish)
    with parts_of(settings, planner=PLANNER) as parts:
        service = at_rest(settings, parts)
        service._look_at_the_inbox("")
        assert looks == [""]
        assert "no room for page 2" in (settings.paths.log_dir / "linedrawd.log").read_text()
