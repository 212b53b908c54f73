"""The journal: every step of every job as a row that is never changed, durable before anything follows from it."""

from __future__ import annotations

import sqlite3
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from daemon.durable import sync_folder
from daemon.errors import DiskTrouble
from daemon.jobs.kept import GO, HELD, SHEET, KeptOfMachines
from daemon.jobs.states import UNDER_THE_PEN, Reason, State, check_step, ink_in_words, meaning_of

VERSION = 3
SCHEMA = (
    """
CREATE TABLE IF NOT EXISTS events (
    number INTEGER PRIMARY KEY, at_s REAL NOT NULL, job TEXT NOT NULL, state TEXT NOT NULL, words TEXT NOT NULL,
    machine TEXT NOT NULL DEFAULT '', reason TEXT NOT NULL DEFAULT ''
)
""",
    """
CREATE TABLE IF NOT EXISTS ink (
    job TEXT PRIMARY KEY, strokes INTEGER NOT NULL, certain INTEGER NOT NULL, possible INTEGER NOT NULL
)
""",
)
"""events only grows; machine: the one that a row is about, "" where it is about none. ink has one row for each job
that may have touched a sheet: how far its pen may have come."""

UNTOLD = 2**31 - 1
"""Stands for strokes that may be drawn where nobody has written down how many."""
_DAMAGED = (sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB)


@dataclass(frozen=True, slots=True)
class Job:
    """What the journal knows of one job: its last step and the words that were said with it.

    The first `certain` of its `strokes` are certainly drawn, and none from number `possible` on has been touched; all
    are 0 while no ink can be on the sheet. machine: it is planned for this one, or was begun on it. bound_to: the one
    machine that may draw it, because a person said so; "" where any may.
    """

    id: str
    name: str
    state: State
    words: str
    changed_s: float
    strokes: int = 0
    certain: int = 0
    possible: int = 0
    machine: str = ""
    bound_to: str = ""
    reason: Reason = Reason.NONE

    @property
    def on_paper(self) -> str:
        """Which strokes are certainly, possibly and not drawn, in words."""
        if self.possible == UNTOLD:
            return "how far it came is not known"
        return ink_in_words(self.strokes, self.certain, self.possible)


class DamagedJournal(DiskTrouble):
    """The file is no journal, or no longer one."""


class Journal:
    """Append-only, SQLite with WAL and synchronous=FULL: a step that was recorded survives a power cut.

    Every method may be called from any thread and raises DiskTrouble where the file cannot be read or written; the
    step has then not happened. `kept` is what is remembered of each machine. Times are for people: the order is that
    of the rows.
    """

    def __init__(self, path: Path, *, now: Callable[[], float] = time.time) -> None:
        """Raises DamagedJournal where the file is none, DiskTrouble where it is of a newer version or not to be had."""
        self._path, self._now, self._lock = path, now, threading.RLock()
        self._jobs: dict[str, Job] = {}
        self._counts: Counter[State] = Counter()
        self.kept = KeptOfMachines()
        try:
            self._rows = sqlite3.connect(path, isolation_level=None, check_same_thread=False)
            try:
                self._prepare()
            except BaseException:
                self._rows.close()
                raise
        except sqlite3.Error as error:
            damaged = getattr(error, "sqlite_errorcode", 0) & 0xFF in _DAMAGED
            kind = DamagedJournal if damaged else DiskTrouble
            raise kind(f"the journal {path} cannot be opened ({error}): {_remedy(error)}, or move it away") from None

    def _prepare(self) -> None:
        (version,) = self._rows.execute("PRAGMA user_version").fetchone()
        if version > VERSION:
            raise DiskTrouble(f"the journal {self._path} is of a newer version ({version}): install that version again")
        (found,) = self._rows.execute("PRAGMA quick_check(1)").fetchone()
        if found != "ok":
            raise DamagedJournal(f"the journal {self._path} is damaged ({found}): move it away")
        self._rows.execute("PRAGMA journal_mode=WAL")
        self._rows.execute("PRAGMA synchronous=FULL")
        if version < VERSION:
            self._make(version)
        self._read()

    def _make(self, version: int) -> None:
        """The tables of this version, out of an older version's or of nothing; all of it or nothing."""
        if version:
            _back_up(self._rows, self._path.with_name(f"{self._path.name}.version-{version}"))
        with self._together():
            for table in SCHEMA:
                self._rows.execute(table)
            if 0 < version < 3:
                # There was one machine then, "" stands for it, and nobody has written down why a job was interrupted.
                for column in ("machine", "reason"):
                    self._rows.execute(f"ALTER TABLE events ADD COLUMN {column} TEXT NOT NULL DEFAULT ''")
                self._rows.execute("UPDATE events SET reason = 'position unknown' WHERE state = 'interrupted'")
            if version == 1:
                # It did not write down how far a drawing came, so that every stroke of one that was begun is possible.
                self._rows.execute(
                    "INSERT OR IGNORE INTO ink SELECT DISTINCT job, 0, 0, ? FROM events WHERE state = ?",
                    (UNTOLD, State.DRAWING.value),
                )
            self._rows.execute(f"PRAGMA user_version={VERSION}")

    def _read(self) -> None:
        rows = self._rows.execute("SELECT at_s, job, state, words, machine, reason FROM events ORDER BY number")
        for at_s, job, state, words, machine, reason in rows:
            if job:
                self._remember(at_s, job, state, words, machine, Reason(reason))
            else:
                self.kept.note(machine, state, words)
        for job, *extent in self._rows.execute("SELECT job, strokes, certain, possible FROM ink").fetchall():
            self._know(job, *extent)

    def jobs(self, *states: State) -> list[Job]:
        """The jobs in one of these states (none given: all), in the order in which they came."""
        with self._lock:
            return [job for job in self._jobs.values() if not states or job.state in states]

    def count(self, *states: State) -> int:
        """How many jobs are in one of these states, without looking at each."""
        with self._lock:
            return sum(self._counts[state] for state in states)

    def job(self, job_id: str) -> Job | None:
        with self._lock:
            return self._jobs.get(job_id)

    def add(self, job_id: str, name: str, *, bound_to: str = "") -> Job:
        """A new job, queued. `name` is what the person called the picture. bound_to: the machine that shall draw it."""
        with self._lock:
            if job_id in self._jobs:
                raise ValueError(f"job {job_id} is there already")
            return self._append(job_id, State.QUEUED.value, name, bound_to)

    def adopt(self, job: Job) -> None:
        """Take over a job as its folder tells it, after a journal was lost."""
        with self._lock, self._together():
            self._insert_ink(job.id, job.strokes, job.certain, job.possible)
            self._insert(job.id, State.QUEUED.value, job.name, job.bound_to)
            self._insert(job.id, job.state.value, job.words, job.machine, job.reason)
        self._put(job)

    def step(
        self, job_id: str, state: State, words: str = "", *, reason: Reason = Reason.NONE, machine: str = ""
    ) -> Job:
        """The job goes on to `state`, for or on this machine where one is named.

        Raises ValueError when the tables lack that step, or the state that reason.
        """
        with self._lock:
            check_step(self._jobs[job_id].state, state)
            meaning_of(state, reason)
            return self._append(job_id, state.value, words, machine, reason)

    def promise(self, job_id: str, *, strokes: int, certain: int, possible: int) -> None:
        """Before a byte of them is sent: the strokes before number `possible` may come onto the sheet.

        strokes: of the whole job. certain: how many are certainly drawn. What has been written is never taken back.
        """
        with self._lock:
            before = self._jobs[job_id]
            extent = max(before.strokes, strokes), max(before.certain, certain), max(before.possible, possible)
            self._insert_ink(job_id, *extent)
            self._know(job_id, *extent)

    def end_drawing(
        self, job_id: str, state: State, words: str, *, certain: int, possible: int, reason: Reason = Reason.NONE
    ) -> Job:
        """The step that ends a drawing, and what is known then of the sheet, in one."""
        with self._lock:
            before = self._jobs[job_id]
            check_step(before.state, state)
            meaning_of(state, reason)
            extent = before.strokes, certain, possible
            with self._together():
                self._insert_ink(job_id, *extent)
                at_s = self._insert(job_id, state.value, words, reason=reason)
            self._remember(at_s, job_id, state.value, words, "", reason)
            return self._know(job_id, *extent)

    def new_sheet(self, machine: str) -> None:
        """A person has put a new sheet in."""
        self._note(machine, SHEET)

    def hold(self, machine: str, words: str) -> None:
        """It begins no job, also after a restart. Holds for this daemon even when DiskTrouble is raised."""
        with self._lock:
            self.kept.note(machine, HELD, words)
            self._insert("", HELD, words, machine)

    def go(self, machine: str) -> None:
        self._note(machine, GO)

    def _note(self, machine: str, what: str) -> None:
        with self._lock:
            self._insert("", what, "", machine)
            self.kept.note(machine, what, "")

    def close(self) -> None:
        with self._lock:
            self._rows.close()

    def _append(self, job_id: str, state: str, words: str, machine: str, reason: Reason = Reason.NONE) -> Job:
        at_s = self._insert(job_id, state, words, machine, reason)
        return self._remember(at_s, job_id, state, words, machine, reason)

    def _insert(self, job_id: str, state: str, words: str, machine: str = "", reason: Reason = Reason.NONE) -> float:
        values = (self._now(), job_id, state, words, machine, reason.value)
        insert = "INSERT INTO events (at_s, job, state, words, machine, reason) VALUES (?, ?, ?, ?, ?, ?)"
        self._write(insert, values)
        return values[0]

    def _insert_ink(self, job_id: str, strokes: int, certain: int, possible: int) -> None:
        self._write("INSERT OR REPLACE INTO ink VALUES (?, ?, ?, ?)", (job_id, strokes, certain, possible))

    @contextmanager
    def _together(self) -> Iterator[None]:
        """Everything in the block is written, or nothing of it."""
        self._write("BEGIN IMMEDIATE")
        try:
            yield
            self._write("COMMIT")
        except BaseException:
            if self._rows.in_transaction:
                self._rows.execute("ROLLBACK")
            raise

    def _write(self, statement: str, values: tuple[float | str, ...] = ()) -> None:
        try:
            self._rows.execute(statement, values)
        except sqlite3.Error as error:
            raise DiskTrouble(f"the journal {self._path} cannot be written ({error}): {_remedy(error)}") from None

    def _remember(self, at_s: float, job_id: str, state: str, words: str, machine: str, reason: Reason) -> Job:
        before = self._jobs.get(job_id)
        if before is None:
            return self._put(Job(job_id, words, State(state), "", at_s, bound_to=machine))
        machine = machine or before.machine
        if state == State.DRAWING.value and before.state is not State.PAUSED:
            self.kept.began(machine)
        elif before.state in UNDER_THE_PEN and state == State.PLANNED.value:
            self.kept.undone(machine)
        after = replace(before, state=State(state), words=words, changed_s=at_s, machine=machine, reason=reason)
        return self._put(after)

    def _put(self, job: Job) -> Job:
        if job.id in self._jobs:
            self._counts[self._jobs[job.id].state] -= 1
        self._counts[job.state] += 1
        self._jobs[job.id] = job
        return job

    def _know(self, job_id: str, strokes: int, certain: int, possible: int) -> Job:
        known = self._jobs[job_id] = replace(self._jobs[job_id], strokes=strokes, certain=certain, possible=possible)
        return known


def _back_up(rows: sqlite3.Connection, copy: Path) -> None:
    """A copy of the whole journal, durable before anything is changed."""
    part = copy.with_name(copy.name + ".part")
    part.unlink(missing_ok=True)
    with closing(sqlite3.connect(part)) as to:
        to.execute("PRAGMA synchronous=FULL")
        rows.backup(to)
    part.rename(copy)
    sync_folder(copy.parent)


def _remedy(error: sqlite3.Error) -> str:
    closed = getattr(error, "sqlite_errorcode", 0) & 0xFF in (sqlite3.SQLITE_READONLY, sqlite3.SQLITE_CANTOPEN)
    return "make its folder writable" if closed else "free the disk"
