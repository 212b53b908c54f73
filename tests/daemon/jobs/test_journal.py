"""What the journal has recorded survives, and what it could not record has not happened."""

from __future__ import annotations

import resource
import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import pytest

from daemon.errors import DiskTrouble
from daemon.jobs.journal import UNTOLD, VERSION, DamagedJournal, Journal
from daemon.jobs.open_journal import open_journal
from daemon.jobs.states import Reason, State

LOST = Reason.POSITION_UNKNOWN


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
        assert not journal.kept.of("").sheet_used
        journal.step("1", State.DRAWING)
    with closing(Journal(tmp_path / "j")) as journal:
        assert journal.kept.of("").sheet_used
        journal.new_sheet("")
        assert not journal.kept.of("").sheet_used
    with closing(Journal(tmp_path / "j")) as journal:
        assert not journal.kept.of("").sheet_used
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
        newer.execute(f"PRAGMA user_version={VERSION + 1}")
    with pytest.raises(DiskTrouble, match="newer version"):
        Journal(tmp_path / "j")


def test_a_file_that_is_no_journal_is_damaged_and_stays_as_it_is(tmp_path: Path) -> None:
    (tmp_path / "j").write_bytes(b"not a database" * 100)
    with pytest.raises(DamagedJournal, match="cannot be opened"):
        Journal(tmp_path / "j")
    assert (tmp_path / "j").read_bytes() == b"not a database" * 100


def in_drawing(path: Path) -> Journal:
    journal = Journal(path)
    journal.add("1", "house.png")
    for state in (State.PLANNING, State.PLANNED, State.DRAWING):
        journal.step("1", state)
    return journal


def test_a_promise_is_on_disk_when_the_call_returns(tmp_path: Path) -> None:
    with closing(in_drawing(tmp_path / "j")) as journal, closing(sqlite3.connect(tmp_path / "j")) as other:
        journal.promise("1", strokes=9, certain=2, possible=4)
        assert other.execute("SELECT * FROM ink").fetchall() == [("1", 9, 2, 4)]


def test_a_promise_is_never_taken_back_by_another(tmp_path: Path) -> None:
    with closing(in_drawing(tmp_path / "j")) as journal:
        journal.promise("1", strokes=9, certain=2, possible=4)
        journal.promise("1", strokes=9, certain=1, possible=3)
    with closing(Journal(tmp_path / "j")) as journal:
        (job,) = journal.jobs()
        assert (job.strokes, job.certain, job.possible) == (9, 2, 4)


def test_a_promise_that_a_full_disk_refuses_is_none(tmp_path: Path) -> None:
    with closing(in_drawing(tmp_path / "j")) as journal:
        with full_disk(64), pytest.raises(DiskTrouble, match="free the disk"):
            journal.promise("1", strokes=9, certain=0, possible=4)
        assert journal.jobs()[0].possible == 0


def test_the_end_of_a_drawing_says_what_its_verdict_knows(tmp_path: Path) -> None:
    with closing(in_drawing(tmp_path / "j")) as journal:
        journal.promise("1", strokes=9, certain=0, possible=8)
        journal.end_drawing("1", State.INTERRUPTED, "alarm", certain=3, possible=5, reason=LOST)
    with closing(Journal(tmp_path / "j")) as journal:
        assert journal.jobs()[0].on_paper == "of 9 strokes 3 are certainly drawn, none from 5 on is touched"
        assert journal.jobs()[0].state is State.INTERRUPTED


def test_an_end_that_a_full_disk_refuses_has_not_happened(tmp_path: Path) -> None:
    with closing(in_drawing(tmp_path / "j")) as journal:
        journal.promise("1", strokes=9, certain=0, possible=8)
        with full_disk(64), pytest.raises(DiskTrouble):
            journal.end_drawing("1", State.INTERRUPTED, "alarm", certain=3, possible=5, reason=LOST)
        assert (journal.jobs()[0].state, journal.jobs()[0].possible) == (State.DRAWING, 8)
        journal.end_drawing("1", State.INTERRUPTED, "alarm", certain=3, possible=5, reason=LOST)


def test_a_sheet_on_which_nothing_was_drawn_is_unused_again(tmp_path: Path) -> None:
    with closing(in_drawing(tmp_path / "j")) as journal:
        journal.step("1", State.PLANNED)
        assert not journal.kept.of("").sheet_used
    with closing(Journal(tmp_path / "j")) as journal:
        assert not journal.kept.of("").sheet_used


def test_a_read_only_journal_says_what_to_do(tmp_path: Path) -> None:
    with closing(in_drawing(tmp_path / "j")) as journal:
        journal._rows.execute("PRAGMA query_only=ON")
        with pytest.raises(DiskTrouble, match=r"readonly.*make its folder writable"):
            journal.step("1", State.FAILED)


def test_a_journal_that_cannot_be_made_says_what_to_do() -> None:
    with pytest.raises(DiskTrouble, match=r"cannot be opened .*make its folder writable"):
        Journal(Path("/proc/linedrawd-journal"))


def test_a_journal_on_a_file_system_that_became_read_only_still_tells_what_it_knows(tmp_path: Path) -> None:
    with closing(in_drawing(tmp_path / "j")) as journal:
        journal._rows.execute("PRAGMA query_only=ON")
        for write in (
            lambda: journal.promise("1", strokes=9, certain=0, possible=4),
            lambda: journal.end_drawing("1", State.DONE, "", certain=9, possible=9),
            lambda: journal.hold("plotter", "a person stopped it"),
        ):
            with pytest.raises(DiskTrouble, match="make its folder writable"):
                write()
        assert (journal.jobs()[0].state, journal.jobs()[0].possible) == (State.DRAWING, 0)
        assert journal.kept.of("plotter").held == "a person stopped it"


def test_a_clock_that_jumps_changes_no_order(tmp_path: Path) -> None:
    times = iter([5e9, -7.0, 0.0])
    with closing(Journal(tmp_path / "j", now=lambda: next(times))) as journal:
        for job in "abc":
            journal.add(job, f"{job}.png")
    with closing(Journal(tmp_path / "j")) as journal:
        assert [job.id for job in journal.jobs()] == ["a", "b", "c"]


V1 = "CREATE TABLE events (number INTEGER PRIMARY KEY, at_s REAL NOT NULL, job TEXT NOT NULL, state TEXT NOT NULL, "
INK = "CREATE TABLE ink (job TEXT PRIMARY KEY, strokes INTEGER NOT NULL, certain INTEGER NOT NULL, possible INTEGER "
ROWS_1 = [("1", "queued", "a.png"), ("1", "drawing", ""), ("2", "queued", "b.png")]


def older(path: Path, rows_then: list[tuple[str, str, str]] = ROWS_1, *, version: int = 1) -> None:
    with closing(sqlite3.connect(path, isolation_level=None)) as rows:
        rows.execute(V1 + "words TEXT NOT NULL)")
        for job, state, words in rows_then:
            rows.execute("INSERT INTO events (at_s, job, state, words) VALUES (1.0, ?, ?, ?)", (job, state, words))
        if version == 2:
            rows.execute(INK + "NOT NULL)")
            rows.execute("INSERT INTO ink VALUES ('1', 9, 3, 5)")
        rows.execute(f"PRAGMA user_version={version}")


def test_a_journal_without_reasons_is_migrated_and_knows_no_place(tmp_path: Path) -> None:
    then = [("1", "queued", "a.png"), ("1", "drawing", ""), ("1", "interrupted", "cut"), ("2", "queued", "b.png")]
    older(tmp_path / "j", then, version=2)
    with closing(Journal(tmp_path / "j")) as journal:
        cut, queued = journal.jobs()
        assert (cut.state, cut.reason, cut.certain) == (State.INTERRUPTED, Reason.POSITION_UNKNOWN, 3)
        assert (queued.state, queued.reason) == (State.QUEUED, Reason.NONE)
        journal.step("1", State.INTERRUPTED, "known again", reason=Reason.POSITION_KNOWN)
    with closing(Journal(tmp_path / "j")) as journal:
        assert journal.jobs()[0].reason is Reason.POSITION_KNOWN
    with closing(sqlite3.connect(tmp_path / "j.version-2")) as backup:
        assert backup.execute("PRAGMA user_version").fetchone() == (2,)


def test_a_journal_without_names_tells_of_every_machine_what_it_told_of_the_one(tmp_path: Path) -> None:
    then = [("1", "queued", "a.png"), ("1", "planning", ""), ("1", "planned", ""), ("1", "drawing", "")]
    older(tmp_path / "j", [*then, ("", "held", "stopped")], version=2)
    with closing(Journal(tmp_path / "j")) as journal:
        assert [(journal.kept.of(name).held, journal.kept.of(name).sheet_used) for name in ("left", "right")] == [
            ("stopped", True)
        ] * 2
        journal.go("left")
        journal.new_sheet("right")
    with closing(Journal(tmp_path / "j")) as journal:
        assert (journal.kept.of("left").held, journal.kept.of("left").sheet_used) == ("", True)
        assert (journal.kept.of("right").held, journal.kept.of("right").sheet_used) == ("stopped", False)


def test_a_journal_of_an_older_version_is_migrated_and_kept(tmp_path: Path) -> None:
    older(tmp_path / "j")
    with closing(Journal(tmp_path / "j")) as journal:
        drawn, queued = journal.jobs()
        assert (drawn.possible, drawn.on_paper) == (UNTOLD, "how far it came is not known")
        assert queued.possible == 0
    with closing(sqlite3.connect(tmp_path / "j.version-1")) as backup:
        assert backup.execute("PRAGMA user_version").fetchone() == (1,)
        assert len(backup.execute("SELECT * FROM events").fetchall()) == 3


def test_a_migration_that_a_full_disk_breaks_off_leaves_the_old_one(tmp_path: Path) -> None:
    older(tmp_path / "j")
    with full_disk(64), pytest.raises(DiskTrouble):
        Journal(tmp_path / "j")
    with closing(Journal(tmp_path / "j")) as journal:
        assert len(journal.jobs()) == 2


def test_a_damaged_journal_is_set_aside_and_no_earlier_one_is_overwritten(tmp_path: Path) -> None:
    said: list[str] = []
    for _ in range(2):
        (tmp_path / "j").write_bytes(b"not a database" * 100)
        open_journal(tmp_path / "j", say=lambda words, level: said.append(words)).close()
    assert (tmp_path / "j.corrupt-1").read_bytes() == (tmp_path / "j.corrupt-2").read_bytes()
    assert "kept as j.corrupt-2" in said[1]


def test_a_journal_of_which_a_page_was_overwritten_is_damaged(tmp_path: Path) -> None:
    in_drawing(tmp_path / "j").close()
    pages = bytearray((tmp_path / "j").read_bytes())
    pages[4096 : 2 * 4096] = bytes(4096)
    (tmp_path / "j").write_bytes(pages)
    with pytest.raises(DamagedJournal):
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
