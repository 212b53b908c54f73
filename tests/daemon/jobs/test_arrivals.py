"""A picture and its side file become jobs, each copy once, wherever the power is cut."""

from __future__ import annotations

import os
import shutil
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from daemon.errors import DiskTrouble, SettingsError
from daemon.jobs.arrival import ARRIVAL_NAME, Arrival, arrival_in
from daemon.jobs.arrivals import Arrivals
from daemon.jobs.folder import source_of
from daemon.jobs.states import State
from daemon.jobs.wishes import SIDE_NAME, settings_for
from daemon.parts import parts_of
from tests.daemon.jobs.intake_bench import Cuts, Intake
from tests.daemon.jobs.test_folder import drop

WISHES = b"copies = 2\nsize_mm = 40\n"


def test_a_side_file_asks_for_copies_and_goes_into_the_folder_of_each(tmp_path: Path) -> None:
    intake = Intake(tmp_path)
    drop(intake.inbox, "Häuschen.png")
    drop(intake.inbox, "Häuschen.toml", WISHES)
    intake.take("Häuschen.png", "Häuschen.toml")
    jobs = intake.journal.jobs()
    assert [(job.id, job.name) for job in jobs] == [
        ("000001-hauschen", "Häuschen.png"),
        ("000002-hauschen", "Häuschen.png"),
    ]
    assert [(intake.folders.path(job.id) / SIDE_NAME).read_bytes() for job in jobs] == [WISHES] * 2
    assert list(intake.inbox.iterdir()) == []


@pytest.mark.parametrize(
    ("said", "sentence"),
    [
        (b"machine = 'plottre'", "house.toml: machine 'plottre' is unknown: did you mean plotter?"),
        (b"[pen]\ndown_nm = 1", "house.toml: [pen] down_nm is unknown: did you mean down_mm?"),
        (b"[pen]\ndown_mm = 'low'", "house.toml: [pen] down_mm: Input should be a valid number"),
        (b"[pen]\ndown_mm = 9", "house.toml: pen.up_mm = 5 must be above pen.down_mm = 9"),
        (b"[pen]\nkind = 'servo'", "house.toml: [pen] kind belongs to the machine: leave it out"),
        (b"size_mn = 1", "house.toml: size_mn is unknown: did you mean size_mm?"),
    ],
)
def test_a_wrong_side_file_is_refused_and_everything_stays_where_it_is(
    tmp_path: Path, said: bytes, sentence: str
) -> None:
    intake = Intake(tmp_path)
    drop(intake.inbox, "house.png")
    drop(intake.inbox, "house.toml", said)
    with pytest.raises(SettingsError) as caught:
        intake.take()
    assert sentence in str(caught.value)
    assert sorted(path.name for path in intake.inbox.iterdir()) == ["house.png", "house.toml"]
    assert intake.states() == []


def test_a_side_file_that_is_a_link_is_refused(tmp_path: Path) -> None:
    intake = Intake(tmp_path)
    drop(intake.inbox, "house.png")
    (intake.inbox / "house.toml").symlink_to("/etc/passwd")
    with pytest.raises(SettingsError, match=r"house\.toml cannot be read"):
        intake.take()


def test_the_job_is_planned_by_its_own_wishes(tmp_path: Path) -> None:
    intake = Intake(tmp_path)
    folder = tmp_path / "000001-house"
    folder.mkdir()
    assert settings_for(folder, intake.settings, "plotter") == intake.settings
    (folder / SIDE_NAME).write_bytes(b"size_mm = [40, 30]\n[pen]\ndown_mm = -1\n")
    settings = settings_for(folder, intake.settings, "plotter")
    assert settings.sheet.box_mm == (40.0, 30.0)
    assert settings.machines["plotter"].pen.model_dump()["down_mm"] == -1
    assert intake.settings.sheet.box_mm == (64.0, 64.0)


def test_no_cut_loses_or_doubles_a_copy(tmp_path: Path, cuts: Cuts) -> None:
    cuts.everywhere(tmp_path, _with_a_side_file, Intake.take, _after_the_cut, changes=range(16, 500))


def _with_a_side_file(root: Path) -> Intake:
    intake = Intake(root)
    drop(intake.inbox, "house.png")
    drop(intake.inbox, "house.toml", WISHES)
    return intake


def _after_the_cut(root: Path) -> None:
    intake = Intake(root)
    intake.recover()
    if (intake.inbox / "house.png").exists():
        intake.take()
    jobs = intake.journal.jobs()
    assert len(jobs) == 2
    for job in jobs:
        source = source_of(intake.folders.path(job.id))
        assert source is not None
        assert source.read_bytes() == b"picture"
        assert (intake.folders.path(job.id) / SIDE_NAME).read_bytes() == WISHES
        assert job.name == "house.png"
    assert list(intake.inbox.iterdir()) == []
    intake.journal.close()


def test_below_the_floor_of_free_disk_no_picture_is_taken(tmp_path: Path) -> None:
    intake = Intake(tmp_path, free=lambda folder: 150_000_000)
    drop(intake.inbox, "house.png")
    with pytest.raises(DiskTrouble, match=r"only 150 MB are free .* below 200 MB: free the disk or lower free_mb"):
        intake.take(side=None)
    assert (intake.inbox / "house.png").exists()
    assert list(intake.folders.root.iterdir()) == []


def test_an_inbox_on_a_real_other_disk_is_emptied(tmp_path: Path) -> None:
    shared = Path("/dev/shm")
    if not shared.is_dir() or shared.stat().st_dev == tmp_path.stat().st_dev:
        pytest.skip("there is no second file system here")
    intake = Intake(tmp_path)
    with TemporaryDirectory(dir=shared) as inbox:
        name = os.fsdecode("Häus\n😀".encode() + b"\xff" + b"x" * 230 + b".png")
        drop(Path(inbox), name)
        intake.arrivals.take(Path(inbox) / name, None)
        assert os.listdir(inbox) == []
    (job,) = intake.journal.jobs()
    assert (intake.folders.path(job.id) / "source.png").read_bytes() == b"picture"
    assert job.name.startswith("Häus\\n😀\\xffxxx")


def test_priority_decides_which_of_those_that_wait_is_planned_and_drawn_first(tmp_path: Path) -> None:
    intake = Intake(tmp_path, "order = 'priority'")
    for name in ("a.png", "12-b.png", "3-c.png", "3-d.png"):
        drop(intake.inbox, name)
        intake.take(name, None)
    begun = [intake.allotment.begin() for _ in range(2)]
    assert [job.name for job in begun if job] == ["3-c.png", "3-d.png"]
    for job in reversed(begun):
        assert job is not None
        intake.allotment.end(job.id)
    drawn = intake.station.begin_drawing()
    assert drawn is not None
    assert drawn.name == "3-c.png"


def test_where_the_journal_is_lost_no_drawing_is_taken_for_a_picture_that_has_just_come(tmp_path: Path) -> None:
    intake = Intake(tmp_path)
    for name in ("a.png", "b.png"):
        drop(intake.inbox, name)
        intake.take(name, None)
    done = intake.journal.jobs()[0].id
    for state in (State.PLANNING, State.PLANNED, State.DRAWING, State.DONE):
        intake.desk.step(done, state)
    intake.journal.close()
    for file in tmp_path.glob("journal.sqlite*"):
        file.unlink()
    intake = Intake(tmp_path)
    intake.recover()
    assert [(job.name, job.state.value) for job in intake.journal.jobs()] == [("a.png", "done"), ("b.png", "queued")]


def test_a_folder_that_a_person_deleted_leaves_its_number_used(tmp_path: Path) -> None:
    intake = Intake(tmp_path)
    drop(intake.inbox, "a.png")
    intake.take("a.png", None)
    intake.journal.close()
    shutil.rmtree(intake.folders.path("000001-a"))
    with parts_of(intake.settings) as parts:
        drop(intake.inbox, "a.png")
        Arrivals(parts.desk, intake.settings).take(intake.inbox / "a.png", None)
        assert [job.id for job in parts.desk.journal.jobs()] == ["000001-a", "000002-a"]


@pytest.mark.parametrize("machine", ["plotter", ""])
def test_a_cut_before_the_record_forgets_neither_the_inbox_nor_the_machine(tmp_path: Path, machine: str) -> None:
    intake, own = Intake(tmp_path), tmp_path / "own"
    own.mkdir()
    drop(intake.inbox, "a.png")
    for folder in (own, intake.inbox):
        (folder / "a.toml").write_bytes(WISHES)
    arrival = Arrival("a.png", "a.toml", 2, inbox=machine, machine=machine)
    intake.folders.take(intake.inbox / "a.png", {ARRIVAL_NAME: arrival.encoded(), SIDE_NAME: WISHES})
    intake.arrivals.recover({"": intake.inbox, "plotter": own})
    assert [(job.name, job.bound_to) for job in intake.journal.jobs()] == [("a.png", machine)] * 2
    left = intake.inbox if machine else own
    assert [path for path in (own / "a.toml", intake.inbox / "a.toml") if path.exists()] == [left / "a.toml"]


def test_what_an_older_version_wrote_of_an_arrival_is_understood(tmp_path: Path) -> None:
    (tmp_path / ARRIVAL_NAME).write_text('{"name": "a.png", "side": "", "copies": 1, "copy_of": ""}')
    assert arrival_in(tmp_path) == Arrival("a.png", "", 1)
