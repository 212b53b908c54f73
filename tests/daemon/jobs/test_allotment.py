"""Which machine a picture is planned for, and what becomes of it when that one cannot begin it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from daemon.errors import LinedrawError
from daemon.jobs.allotment import Allotment
from daemon.jobs.choices import Choices
from daemon.jobs.desk import Desk
from daemon.jobs.folder import JobFolders
from daemon.jobs.journal import Job, Journal
from daemon.jobs.states import Reason, State
from daemon.jobs.station import Station


def silent(*_: Any, **__: Any) -> None:
    """Tells nobody."""


class Two:
    """A desk with two machines, and pictures as they are dropped. Nothing is planned but by name, and nothing drawn."""

    def __init__(self, root: Path, *, alike: bool = False) -> None:
        self.root, self.alike, self.small = root, alike, set[str]()
        self.journal = Journal(root / "journal.sqlite")
        self.desk = Desk(self.journal, JobFolders(root / "jobs"), say=silent, show=silent)
        self.left, self.right = (self._station(name) for name in ("left", "right"))
        self.allotment = Allotment(self.desk, ahead=2, suits=lambda job, machine: machine not in self.small)

    def _station(self, name: str) -> Station:
        return Station(self.desk, name, show=silent, asks_for_sheets=False, alike=lambda other: self.alike)

    def drop(self, *names: str, bound_to: str = "") -> None:
        for name in names:
            (self.root / name).write_text(name)
            self.desk.add(self.desk.folders.take(self.root / name), name, bound_to=bound_to)

    def planned(self) -> str:
        """The machine that the next picture is planned for; "" where none is planned."""
        job = self.allotment.begin()
        if job is None:
            return ""
        self.allotment.end(job.id)
        return job.machine

    def drawn(self, station: Station) -> Job:
        job = station.begin_drawing()
        assert job is not None
        return job

    def restarted(self) -> Two:
        self.journal.close()
        after = Two(self.root)
        after.desk.recover()
        return after


@pytest.fixture
def two(tmp_path: Path) -> Iterator[Two]:
    two = Two(tmp_path)
    yield two
    two.journal.close()


def test_pictures_are_planned_for_the_machine_that_will_be_free_first_and_so_many_ahead(two: Two) -> None:
    two.drop(*"abcde")
    assert [two.planned() for _ in range(5)] == ["left", "right", "left", "right", ""]
    two.drawn(two.right)
    assert two.planned() == "right"


def test_no_machine_takes_what_is_planned_for_one_that_is_set_otherwise(two: Two) -> None:
    two.drop("a")
    two.planned()
    assert two.right.begin_drawing() is None
    assert two.drawn(two.left).name == "a"


def test_a_machine_that_is_set_alike_draws_the_others_plan_and_is_remembered(tmp_path: Path) -> None:
    two = Two(tmp_path, alike=True)
    two.drop("a")
    assert two.planned() == "left"
    two.drawn(two.right)
    assert [job.machine for job in two.journal.jobs()] == ["right"]
    two.journal.close()


def test_what_is_bound_to_a_machine_waits_for_it(two: Two) -> None:
    two.alike = True
    two.drop("a", bound_to="left")
    two.left.hold("stopped")
    assert two.planned() == "left"
    assert two.right.begin_drawing() is None
    assert two.planned() == ""


@pytest.mark.parametrize("away", ["held", "missing", "drawing"])
def test_what_a_machine_cannot_begin_is_planned_again_for_one_that_is_free(two: Two, away: str) -> None:
    two.drop("a", "b", "c")
    assert [two.planned() for _ in range(3)] == ["left", "right", "left"]
    if away == "drawing":
        two.drawn(two.left)
    two.drawn(two.right)
    if away == "held":
        two.left.hold("stopped")
    if away == "missing":
        two.left.lost(missing=True)
    assert two.planned() == "", "right draws"
    for job in two.journal.jobs(State.DRAWING):
        if job.machine == "right":
            two.desk.end_drawing(job.id, State.DONE, "", reason=Reason.NONE, extent=(1, 1))
    assert two.right.begin_drawing() is None
    assert two.planned() == "right"
    assert two.drawn(two.right).name == ("c" if away == "drawing" else "a")


def test_nothing_is_planned_for_a_machine_that_is_held_while_another_is_not(two: Two) -> None:
    two.left.hold("stopped")
    two.drop(*"abc")
    assert [two.planned() for _ in range(3)] == ["right", "right", ""]


def test_a_machine_that_is_free_leaves_its_plan_to_one_that_is_about_to_begin_it(two: Two) -> None:
    two.drop("a")
    two.right.begin_drawing()
    assert two.planned() == "left"
    assert two.planned() == ""


@pytest.mark.parametrize("alike", [False, True])
def test_what_is_half_drawn_goes_on_on_its_own_machine_only(two: Two, alike: bool) -> None:
    two.alike = alike
    two.drop("a")
    two.planned()
    job = two.drawn(two.left).id
    two.journal.promise(job, strokes=2, certain=0, possible=1)
    two.desk.step(job, State.INTERRUPTED, reason=Reason.POSITION_KNOWN)
    two.desk.step(job, State.WAITING)
    two.left.hold("stopped")
    assert two.right.begin_drawing() is None
    assert two.planned() == ""
    two.left.go()
    assert two.drawn(two.left).id == job


def test_a_job_is_not_handed_to_and_fro(two: Two) -> None:
    """right looks as if it would reach, and does not."""
    two.drop("a", "b")
    assert two.planned() == "left"
    two.drawn(two.left)
    two.small = {"right"}
    assert two.planned() == "left"
    two.small = set()
    assert two.right.begin_drawing() is None
    job = two.allotment.begin()
    assert job is not None
    assert job.machine == "right"
    assert two.allotment.too_far(job)
    assert two.planned() == "left"
    assert [two.planned() for _ in range(3)] == [""] * 3


def test_a_job_that_no_machine_reaches_is_told_so_by_the_last(two: Two) -> None:
    two.drop("a")
    for machine in ("left", "right"):
        job = two.allotment.begin()
        assert job is not None
        assert job.machine == machine
        again = two.allotment.too_far(job)
    assert not again


def test_a_machine_whose_reach_does_not_hold_the_box_comes_last(two: Two) -> None:
    two.small = {"left"}
    two.drop(*"abc")
    assert [two.planned() for _ in range(3)] == ["right", "right", ""]


def test_what_is_held_and_drawn_is_remembered_of_each_machine(two: Two) -> None:
    two.drop("a", "b")
    two.planned(), two.planned()
    two.drawn(two.left), two.drawn(two.right)
    two.journal.promise("000001-a", strokes=2, certain=0, possible=1)
    after = two.restarted()
    assert [job.state for job in after.journal.jobs()] == [State.INTERRUPTED, State.PLANNED]
    assert (bool(after.left.held), after.right.held) == (True, "")
    assert (after.left.cut_off, after.right.cut_off) == (True, False)
    assert (after.journal.kept.of("left").sheet_used, after.journal.kept.of("right").sheet_used) == (True, False)
    again = after.restarted()
    assert (bool(again.left.held), again.right.held) == (True, "")
    again.journal.close()


def test_what_was_planned_for_a_machine_that_is_no_longer_set_is_planned_again(two: Two) -> None:
    two.desk.stations.clear()
    for name in ("up", "down"):
        two._station(name)
    two.drop("a", "b")
    assert two.planned() == "up"
    two.drop("c", bound_to="down")
    two.desk.stations["up"].hold("stopped")
    after = two.restarted()
    assert [job.state for job in after.journal.jobs()] == [State.QUEUED, State.QUEUED, State.FAILED]
    assert "set it, then `linedrawd retry 000003-c`" in after.journal.jobs()[2].words
    choices = Choices(after.desk, placed=lambda machine: False)
    for choose in (choices.retry, choices.again):
        with pytest.raises(LinedrawError, match="job 000003-c is for the machine down, which is not set"):
            choose("3")
    assert after.left.held == "up, which is not set any more, was held (stopped)"
    after.left.go()
    again = after.restarted()
    assert (again.left.held, bool(again.right.held)) == ("", True)
    again.journal.close()
