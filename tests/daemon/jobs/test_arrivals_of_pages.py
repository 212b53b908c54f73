"""A document becomes a job for each of its pages, each once in each copy, wherever the power is cut."""

from __future__ import annotations

import shutil
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from daemon.config import Keep
from daemon.intake.pages import UNCOUNTED
from daemon.jobs.arrival import ARRIVAL_NAME, Arrival, arrival_in, keep_page, page_in
from daemon.jobs.arrivals import Arrivals
from daemon.jobs.choices import Choices
from daemon.jobs.folder import source_of
from daemon.jobs.retention import EVERY_S, Retention
from daemon.jobs.states import State
from daemon.jobs.wishes import SIDE_NAME
from tests.daemon.jobs.intake_bench import Cuts, Intake
from tests.daemon.jobs.test_folder import drop

PAGES, WISHES = 3, b"copies = 2\n"
NAMES = [f"plan.pdf page {page}" for page in (1, 2, 3)]


def book_in(root: Path, said: bytes = b"") -> Intake:
    intake = Intake(root, pages=PAGES)
    drop(intake.inbox, "plan.pdf")
    if said:
        drop(intake.inbox, "plan.toml", said)
    return intake


def take(intake: Intake) -> None:
    intake.take("plan.pdf", "plan.toml" if (intake.inbox / "plan.toml").exists() else None)


def told(intake: Intake) -> list[tuple[str, int]]:
    return [(job.name, page_in(intake.folders.path(job.id))) for job in intake.journal.jobs()]


def test_each_page_is_a_job_with_its_name_and_the_one_file_is_not_kept_thrice(tmp_path: Path) -> None:
    intake = book_in(tmp_path)
    take(intake)
    assert told(intake) == list(zip(NAMES, (1, 2, 3), strict=True))
    sources = [source_of(intake.folders.path(job.id)) for job in intake.journal.jobs()]
    assert [source.name for source in sources if source] == ["source.pdf"] * 3
    assert len({source.stat().st_ino for source in sources if source}) == 1
    assert list(intake.inbox.iterdir()) == []


def test_each_copy_is_drawn_page_by_page_with_its_wishes(tmp_path: Path) -> None:
    intake = book_in(tmp_path, WISHES)
    take(intake)
    assert told(intake) == list(zip(NAMES * 2, (1, 2, 3) * 2, strict=True))
    assert all((intake.folders.path(job.id) / SIDE_NAME).read_bytes() == WISHES for job in intake.journal.jobs())


@pytest.mark.parametrize("said", [b"", WISHES], ids=["once", "two copies"])
def test_no_cut_loses_or_doubles_a_page(tmp_path: Path, cuts: Cuts, said: bytes) -> None:
    cuts.everywhere(tmp_path, lambda root: book_in(root, said), take, all_of_it(said), changes=range(24, 500))


@pytest.mark.parametrize("said", [b"", WISHES], ids=["once", "two copies"])
def test_a_disk_that_is_full_in_between_loses_or_doubles_no_page(tmp_path: Path, full_disk: Cuts, said: bytes) -> None:
    full_disk.everywhere(tmp_path, lambda root: book_in(root, said), take, all_of_it(said), changes=range(24, 500))


def all_of_it(said: bytes) -> Callable[[Path], None]:
    """What has to be true after the next start."""
    copies = 2 if said else 1

    def after_the_start(root: Path) -> None:
        intake = Intake(root, pages=PAGES)
        intake.recover()
        if (intake.inbox / "plan.pdf").exists():
            take(intake)
        assert sorted(told(intake)) == sorted(zip(NAMES * copies, (1, 2, 3) * copies, strict=True))
        for job in intake.journal.jobs():
            source = source_of(intake.folders.path(job.id))
            assert source is not None
            assert source.read_bytes() == b"picture"
        assert list(intake.inbox.iterdir()) == []
        assert len(list(intake.folders.root.iterdir())) == PAGES * copies
        intake.journal.close()

    return after_the_start


def test_a_picture_that_is_deleted_while_the_disk_is_full_holds_up_nothing(tmp_path: Path) -> None:
    intake = book_in(tmp_path)
    made = [intake.folders.take(intake.inbox / "plan.pdf", {})]
    intake.arrivals._unfinished.append((made, Arrival("plan.pdf", "", 1, pages=PAGES), None))
    shutil.rmtree(intake.folders.path(made[0]))
    intake.arrivals.finish()
    assert intake.arrivals._unfinished == []


def test_a_document_that_becomes_another_one_while_it_is_counted_is_not_taken(tmp_path: Path) -> None:
    intake = book_in(tmp_path)

    def counted(picture: Path) -> int:
        (tmp_path / "new").write_bytes(b"another")
        (tmp_path / "new").rename(picture)
        return 1

    with pytest.raises(FileNotFoundError):
        Arrivals(intake.desk, intake.settings, pages=counted).take(intake.inbox / "plan.pdf", None)
    assert (intake.inbox / "plan.pdf").read_bytes() == b"another"
    assert intake.states() == []


def test_of_somebody_elses_file_one_copy_is_made_for_all_pages(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    link = Path.hardlink_to

    def protected(path: Path, target: Path) -> None:
        if target.parent.name.startswith("000001-"):
            raise PermissionError(1, "Operation not permitted")
        link(path, target)

    monkeypatch.setattr(Path, "hardlink_to", protected)
    intake = book_in(tmp_path)
    take(intake)
    sources = [source_of(intake.folders.path(job.id)) for job in intake.journal.jobs()]
    assert [source.stat().st_nlink for source in sources if source] == [1, 2, 2]


def test_the_one_file_counts_once_for_what_is_kept(tmp_path: Path) -> None:
    intake = Intake(tmp_path, pages=PAGES)
    (intake.inbox / "plan.pdf").write_bytes(bytes(3_000_000))
    take(intake)
    for job in intake.journal.jobs():
        for state in (State.PLANNING, State.PLANNED, State.DRAWING, State.DONE):
            intake.desk.step(job.id, state)
    Retention(intake.desk, Keep(jobs_mb=4)).turn()
    assert len(list(intake.folders.root.iterdir())) == PAGES


def test_what_is_left_of_the_pages_has_the_whole_file(tmp_path: Path) -> None:
    intake, clock, began_s = Intake(tmp_path, pages=PAGES), [0.0], time.time()
    (intake.inbox / "plan.pdf").write_bytes(bytes(3_000_000))
    take(intake)
    for job in intake.journal.jobs():
        for state in (State.PLANNING, State.PLANNED, State.DRAWING, State.DONE):
            intake.desk.step(job.id, state)
    retention = Retention(intake.desk, Keep(jobs_mb=2.5), now=lambda: clock[0], wall=lambda: began_s + clock[0])
    for left in (2, 1):
        retention.turn()
        assert len(list(intake.folders.root.iterdir())) == left
        clock[0] += EVERY_S


def test_where_no_links_can_be_made_the_file_is_copied(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(path: Path, target: Path) -> None:
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(Path, "hardlink_to", refused)
    intake = book_in(tmp_path)
    take(intake)
    sources = [source_of(intake.folders.path(job.id)) for job in intake.journal.jobs()]
    assert [source.read_bytes() for source in sources if source] == [b"picture"] * 3


def test_again_draws_the_same_page_alone_also_when_the_power_is_cut_behind_it(tmp_path: Path) -> None:
    intake = book_in(tmp_path)
    take(intake)
    second = intake.journal.jobs()[1].id
    Choices(intake.desk, placed=lambda machine: True).again(second)
    assert told(intake)[PAGES:] == [(NAMES[1], 2)]
    arrival = arrival_in(intake.folders.path(second))
    assert arrival is not None
    source = source_of(intake.folders.path(second))
    assert source is not None
    intake.folders.copy(source, {ARRIVAL_NAME: arrival.copy(second).encoded()}, name="plan.pdf")
    intake.journal.close()
    intake = Intake(tmp_path, pages=PAGES)
    intake.recover()
    assert told(intake)[PAGES:] == [(NAMES[1], 2)] * 2


def test_each_copy_of_a_document_that_nobody_could_count_knows_that(tmp_path: Path) -> None:
    intake = Intake(tmp_path, pages=UNCOUNTED)
    drop(intake.inbox, "plan.pdf")
    drop(intake.inbox, "plan.toml", WISHES)
    take(intake)
    assert told(intake) == [("plan.pdf", UNCOUNTED)] * 2


def test_a_document_that_comes_again_is_dropped_as_one(tmp_path: Path) -> None:
    intake = Intake(tmp_path, "duplicates = 'skip'", pages=PAGES)
    for _ in range(2):
        drop(intake.inbox, "plan.pdf")
        take(intake)
    assert intake.states() == ["queued"] * PAGES + ["cancelled"]


def test_a_folder_that_is_no_jobs_keeps_the_page_that_was_asked_for_last(tmp_path: Path) -> None:
    keep_page(tmp_path, 1)
    assert list(tmp_path.iterdir()) == []
    for page in (2, 1):
        keep_page(tmp_path, page)
        assert page_in(tmp_path) == page


def test_one_page_that_a_person_asked_for_stays_that_page(tmp_path: Path) -> None:
    intake = Intake(tmp_path, pages=PAGES)
    drop(tmp_path, "plan.pdf")
    intake.folders.copy(tmp_path / "plan.pdf", {ARRIVAL_NAME: Arrival("plan.pdf", "", 1, page=3).encoded()})
    intake.recover()
    assert told(intake) == [(NAMES[2], 3)]
