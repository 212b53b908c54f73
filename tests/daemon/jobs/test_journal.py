"""What the journal has recorded survives, and what it could not record has not happened."""

from __future__ import annotations

import resource
import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import pytest

from daemon.errors import DiskTrouble
from daemon.jobs.journal import Journal
from daemon.jobs.states import State


@contextmanager
def full_disk(limit_bytes: int) -> Iterator[None]:
    """No file grows beyond the limit: the kernel says so with SIGXFSZ (ignored by Python) and EFBIG."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit_bytes, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_steps_are_remembered_by_the_next_daemon(tmp_path: Path) -> None:
    with closing(Journal(tmp_path / "j", now=lambda: 5.0)) as journal:
        journal.add("1", "house.png")
        journal.step("1", State.PLANNING)
        journal.step("1", State.FAILED, "no picture: drop another")
        journal.add("2", "cat.png")
        written = journal.jobs()
    with closing(Journal(tmp_path / "j")) as journal:
        assert journal.jobs() == written
        assert [(job.id, job.name, job.state, job.words, job.changed_s) for job in journal.jobs()] == [
            ("1", "house.png", State.FAILED, "no picture: drop another", 5.0),
            ("2", "cat.png", State.QUEUED, "", 5.0),
        ]
        assert [job.id for job in journal.jobs(State.QUEUED)] == ["2"]


def test_a_step_that_the_table_lacks_is_not_recorded(tmp_path: Path) -> None:
    with closing(Journal(tmp_path / "j")) as journal:
        journal.add("1", "house.png")
        with pytest.raises(ValueError, match="from queued to done"):
            journal.step("1", State.DONE)
        assert journal.jobs()[0].state is State.QUEUED


def test_a_step_is_on_disk_when_the_call_returns(tmp_path: Path) -> None:
    with closing(Journal(tmp_path / "j")) as journal, closing(sqlite3.connect(tmp_path / "j")) as other:
        journal.add("1", "house.png")
        assert other.execute("SELECT job, state FROM events").fetchall() == [("1", "queued")]
        assert journal._rows.execute("PRAGMA journal_mode").fetchone() == ("wal",)
        assert journal._rows.execute("PRAGMA synchronous").fetchone() == (2,)


def test_a_sheet_is_used_from_its_first_drawing_until_a_new_one_is_in(tmp_path: Path) -> None:
    with closing(Journal(tmp_path / "j")) as journal:
        journal.add("1", "house.png")
        for state in (State.PLANNING, State.PLANNED):
            journal.step("1", state)
        assert not journal.sheet_used
        journal.step("1", State.DRAWING)
    with closing(Journal(tmp_path / "j")) as journal:
        assert journal.sheet_used
        journal.new_sheet()
        assert not journal.sheet_used
    with closing(Journal(tmp_path / "j")) as journal:
        assert not journal.sheet_used
        assert journal.jobs()[0].state is State.DRAWING


def test_a_step_that_a_full_disk_refuses_has_not_happened(tmp_path: Path) -> None:
    with closing(Journal(tmp_path / "j")) as journal:
        journal.add("1", "house.png")
        with full_disk(64), pytest.raises(DiskTrouble, match="free the disk"):
            journal.step("1", State.PLANNING)
        assert journal.jobs()[0].state is State.QUEUED
        assert journal.step("1", State.PLANNING).state is State.PLANNING


def test_a_journal_of_a_newer_version_is_refused(tmp_path: Path) -> None:
    with closing(sqlite3.connect(tmp_path / "j")) as newer:
        newer.execute("PRAGMA user_version=2")
    with pytest.raises(DiskTrouble, match="newer version"):
        Journal(tmp_path / "j")


def test_a_file_that_is_no_journal_is_refused_with_a_sentence(tmp_path: Path) -> None:
    (tmp_path / "j").write_bytes(b"not a database" * 100)
    with pytest.raises(DiskTrouble, match="cannot be opened"):
        Journal(tmp_path / "j")


def test_jobs_are_counted_by_their_state(tmp_path: Path) -> None:
    with closing(Journal(tmp_path / "journal.sqlite")) as journal:
        for name in ("a", "b", "c"):
            journal.add(name, name)
        journal.step("a", State.PLANNING)
        journal.step("a", State.PLANNED)
        journal.step("b", State.CANCELLED)
    with closing(Journal(tmp_path / "journal.sqlite")) as journal:
        assert journal.count(State.QUEUED) == 1
        assert journal.count(State.QUEUED, State.PLANNED) == 2
        assert journal.count(State.PLANNING) == 0
