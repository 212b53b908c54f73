"""A drawing in three colours is drawn in three passes; between them a person puts another pen in."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from daemon.config import Settings
from daemon.control import Order, give_order
from daemon.jobs.journal import Job
from daemon.jobs.states import Reason, State
from daemon.shapes import Points
from tests.daemon.intake.buttons import ENTER
from tests.daemon.test_button import keypad, press
from tests.daemon.test_every_device import farthest_mm
from tests.daemon.test_service import Daemon, ended, loaded, running
from tests.drawings.colours import SECTION

__all__ = ["keypad"]
"""A fixture."""

SVG = Path(__file__).parents[1] / "drawings" / "three_colours.svg"


def settings_of(root: Path, device: str, *, more: str = "") -> Settings:
    return loaded(root, f"{SECTION}{more}\n", device=device, port=f"sim://{device}")


def at_pen_change(daemon: Daemon, pen: str) -> Job:
    (job,) = daemon.wait_for(lambda jobs: jobs and jobs[0].words.startswith(f"put the {pen} pen in"))
    assert (job.state, job.reason) == (State.PAUSED, Reason.PEN_CHANGE)
    assert daemon.parts.board.now.pen_in == pen
    return job


def drop(daemon: Daemon, name: str = "three.svg") -> None:
    shutil.copyfile(SVG, daemon.settings.paths.inbox / name)


def go_on(daemon: Daemon, job: Job) -> str:
    """From the first stroke of the red pen."""
    order = Order.model_validate({"order": "resume", "job": job.id, "from_stroke": 5})
    return give_order(daemon.settings.paths.control, order)


def by_pen(folder: Path) -> dict[str, list[Points]]:
    """The lines of ink, dots left out."""
    ink = json.loads((folder / "ink.json").read_text())
    found: dict[str, list[Points]] = {}
    for pen, line in zip(ink["pens"], ink["strokes"], strict=True):
        if len(line) > 1:
            found.setdefault(pen, []).append(np.array(line, float))
    return found


@pytest.mark.parametrize("device", ["grbl", "emco", "dobot"])
def test_three_colours_are_three_passes_and_the_ink_of_each_lies_on_its_lines(device: str, tmp_path: Path) -> None:
    with running(settings_of(tmp_path, device), planner=None) as daemon:
        drop(daemon)
        job = at_pen_change(daemon, "red")
        assert ("START" in job.words) == (device == "emco")
        daemon.order("resume")
        at_pen_change(daemon, "blue")
        daemon.order("resume")
        (job,) = daemon.wait_for(ended)
        assert job.state is State.DONE, job.words
        ink, report = by_pen(daemon.folder(job)), json.loads((daemon.folder(job) / "report.json").read_text())
        log = (daemon.folder(job) / "job.log").read_text()
        strokes = np.array(report["from_px"]), json.loads((daemon.folder(job) / "strokes.json").read_text())["strokes"]
    assert list(ink) == list(report["pens"]) == ["black", "red", "blue"]
    assert [len(lines) for lines in ink.values()] == [each["strokes"] for each in report["pens"].values()]
    assert "the black pen draws first" in log
    assert report["fidelity"]["f1"] > 0.98
    from_px, lines = strokes
    everything = [np.array(line) @ from_px[:, :2].T + from_px[:, 2] for line in lines]
    assert farthest_mm([line for each in ink.values() for line in each], everything) < 0.15


@pytest.mark.usefixtures("keypad")
def test_a_button_says_that_the_pen_is_in(tmp_path: Path) -> None:
    path = tmp_path / "keypad"
    with running(settings_of(tmp_path, "grbl", more=f"[button]\npath = '{path}'"), planner=None) as daemon:
        drop(daemon)
        for pen in ("red", "blue"):
            at_pen_change(daemon, pen)
            press(path, ENTER)
        (job,) = daemon.wait_for(ended)
    assert job.state is State.DONE


def test_a_daemon_that_was_stopped_at_a_pen_change_names_the_pen_to_go_on_with(tmp_path: Path) -> None:
    with running(settings_of(tmp_path, "grbl"), planner=None) as daemon:
        drop(daemon)
        at_pen_change(daemon, "red")
        daemon.order("stop")
        (job,) = daemon.wait_for(ended)
        assert (job.state, job.reason) == (State.INTERRUPTED, Reason.POSITION_KNOWN)
        assert job.certain == job.possible == 5
        assert "with the red pen" in go_on(daemon, job)
        # Nobody has said that it was put in.
        job = at_pen_change(daemon, "red")
        assert job.certain == job.possible == 5
        daemon.order("resume")
        at_pen_change(daemon, "blue")
        daemon.order("resume")
        (job,) = daemon.wait_for(ended)
        ink = by_pen(daemon.folder(job))
    assert job.state is State.DONE
    assert list(ink) == ["black", "red", "blue"]


def test_what_was_stopped_again_before_its_pen_was_in_keeps_what_is_on_the_sheet(tmp_path: Path) -> None:
    with running(settings_of(tmp_path, "grbl"), planner=None) as daemon:
        drop(daemon)
        at_pen_change(daemon, "red")
        daemon.order("stop")
        (job,) = daemon.wait_for(ended)
        go_on(daemon, job)
        at_pen_change(daemon, "red")
        daemon.order("stop")
        (job,) = daemon.wait_for(ended)
    assert (job.state, job.certain, job.possible) == (State.INTERRUPTED, 5, 5)


@pytest.mark.parametrize("device", ["grbl", "dobot", "emco"])
def test_the_next_drawing_waits_for_its_first_pen_where_the_last_one_is_in(device: str, tmp_path: Path) -> None:
    with running(settings_of(tmp_path, device), planner=None) as daemon:
        station = next(iter(daemon.parts.desk.stations.values()))
        drop(daemon)
        for pen in ("red", "blue"):
            at_pen_change(daemon, pen)
            assert station.pen_in == ""
            daemon.order("resume")
        daemon.wait_for(ended)
        assert station.pen_in == "blue"
        drop(daemon, "again.svg")
        daemon.order("next")
        daemon.wait_for(lambda jobs: len(jobs) == 2 and jobs[1].words.startswith("put the black pen in"))
        assert daemon.parts.board.now.strokes_done == 0
        daemon.order("resume")
        daemon.wait_for(lambda jobs: jobs[1].words.startswith("put the red pen in"))
        daemon.order("stop")
        daemon.wait_for(lambda jobs: ended(jobs[1:]))


def test_at_a_pen_change_everything_before_is_certain_and_nothing_behind_is_promised(tmp_path: Path) -> None:
    with running(settings_of(tmp_path, "grbl"), planner=None) as daemon:
        drop(daemon)
        job = at_pen_change(daemon, "red")
        assert (job.certain, job.possible) == (5, 5)
        shown = daemon.parts.board.now
        assert (shown.state, shown.strokes_done) == ("paused", 5)
        daemon.order("stop")
        daemon.wait_for(ended)


def test_only_what_is_blue_is_drawn_without_a_pen_change(tmp_path: Path) -> None:
    with running(settings_of(tmp_path, "grbl", more="skip = ['black', 'red']"), planner=None) as daemon:
        drop(daemon)
        (job,) = daemon.wait_for(ended)
        ink, log = by_pen(daemon.folder(job)), (daemon.folder(job) / "job.log").read_text()
    assert job.state is State.DONE
    assert list(ink) == ["blue"]
    assert "the blue pen draws first" in log
