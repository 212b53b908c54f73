"""The same picture twice: drawn twice, or once where duplicates are skipped, wherever the power is cut."""

from __future__ import annotations

from pathlib import Path

from daemon.jobs.folder import source_of
from daemon.jobs.states import State
from tests.daemon.jobs.intake_bench import Cuts, Intake
from tests.daemon.jobs.test_folder import drop

SKIP = "duplicates = 'skip'"


def test_the_same_picture_twice_is_drawn_twice(tmp_path: Path) -> None:
    intake = Intake(tmp_path)
    for name in ("a.png", "b.png"):
        drop(intake.inbox, name)
        intake.take(name, None)
    assert intake.states() == ["queued", "queued"]


def test_the_same_picture_twice_is_drawn_once_where_duplicates_are_skipped(tmp_path: Path) -> None:
    for name, data in (("a.png", b"picture"), ("b.png", b"picture"), ("c.png", b"another")):
        intake = Intake(tmp_path, SKIP)
        drop(intake.inbox, name, data)
        intake.take(name, None)
        words = intake.journal.jobs()[-1].words
        intake.journal.close()
        if name == "b.png":
            assert words.startswith("the same picture as job 000001-a (duplicates = 'skip')")
    assert intake.states() == ["queued", "cancelled", "queued"]
    assert list(intake.inbox.iterdir()) == []


def test_no_cut_loses_or_draws_what_is_skipped(tmp_path: Path, cuts: Cuts) -> None:
    cuts.everywhere(
        tmp_path, _with_a_twin, lambda intake: intake.take("b.png", None), _after_the_second, changes=range(6, 100)
    )


def _with_a_twin(root: Path) -> Intake:
    intake = Intake(root, SKIP)
    for name in ("a.png", "b.png"):
        drop(intake.inbox, name)
    intake.take("a.png", None)
    return intake


def _after_the_second(root: Path) -> None:
    intake = Intake(root, SKIP)
    intake.recover()
    if (intake.inbox / "b.png").exists():
        intake.take("b.png", None)
    first, second = intake.journal.jobs()
    assert (first.state, second.state) == (State.QUEUED, State.CANCELLED)
    assert (second.name, second.words.startswith("the same picture as job 000001-a")) == ("b.png", True)
    source = source_of(intake.folders.path(second.id))
    assert source is not None
    assert source.read_bytes() == b"picture"
    assert list(intake.inbox.iterdir()) == []
    intake.journal.close()


def test_what_was_skipped_stays_so_where_the_journal_is_lost(tmp_path: Path) -> None:
    intake = Intake(tmp_path, SKIP)
    for name in ("a.png", "b.png"):
        drop(intake.inbox, name)
        intake.take(name, None)
    intake.journal.close()
    for file in tmp_path.glob("journal.sqlite*"):
        file.unlink()
    after = Intake(tmp_path, SKIP)
    after.recover()
    assert after.states() == ["queued", "cancelled"]
    after.journal.close()


def test_a_picture_that_was_not_drawn_or_is_wished_otherwise_is_no_duplicate(tmp_path: Path) -> None:
    intake = Intake(tmp_path, SKIP)
    drop(intake.inbox, "a.png")
    intake.take("a.png", None)
    intake.desk.step(intake.journal.jobs()[0].id, State.FAILED, "it could not be planned")
    drop(intake.inbox, "a.png")
    intake.take("a.png", None)
    drop(intake.inbox, "a.png")
    drop(intake.inbox, "a.toml", b"size_mm = 40")
    intake.take("a.png", "a.toml")
    assert intake.states() == ["failed", "queued", "queued"]
