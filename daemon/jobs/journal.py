"""The journal: every step of every job as a row that is never changed, durable before anything follows from it."""

from __future__ import annotations

import sqlite3
import threading
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from daemon.errors import DiskTrouble
from daemon.jobs.states import State, check_step

VERSION = 1
SCHEMA = """
CREATE TABLE IF NOT EXISTS events (
    number INTEGER PRIMARY KEY, at_s REAL NOT NULL, job TEXT NOT NULL, state TEXT NOT NULL, words TEXT NOT NULL
)
"""
_SHEET, _HELD, _GO = "new sheet", "held", "go"
"""Stand in the place of a state in the rows that belong to no job."""


@dataclass(frozen=True, slots=True)
class Job:
    """What the journal knows of one job: its last step and the words that were said with it."""

    id: str
    name: str
    state: State
    words: str
    changed_s: float


class Journal:
    """Append-only, SQLite with WAL and synchronous=FULL: a step that was recorded survives a power cut.

    Every method may be called from any thread and raises DiskTrouble where the file cannot be read or written; the
    step has then not happened. `sheet_used` is true from the first drawing after a new sheet came in; `held` says why
    no job may start, and is empty when they may.
    """

    def __init__(self, path: Path, *, now: Callable[[], float] = time.time) -> None:
        self._path, self._now, self._lock = path, now, threading.RLock()
        self._jobs: dict[str, Job] = {}
        self._counts: Counter[State] = Counter()
        self.sheet_used, self.held = False, ""
        try:
            self._rows = sqlite3.connect(path, isolation_level=None, check_same_thread=False)
            self._prepare()
        except sqlite3.Error as error:
            raise DiskTrouble(f"the journal {path} cannot be opened ({error}): free the disk or move it away") from None

    def _prepare(self) -> None:
        (version,) = self._rows.execute("PRAGMA user_version").fetchone()
        if version > VERSION:
            raise DiskTrouble(f"the journal {self._path} is of a newer version ({version}): install that version again")
        self._rows.execute("PRAGMA journal_mode=WAL")
        self._rows.execute("PRAGMA synchronous=FULL")
        self._rows.execute(SCHEMA)
        self._rows.execute(f"PRAGMA user_version={VERSION}")
        for at_s, job, state, words in self._rows.execute(
            "SELECT at_s, job, state, words FROM events ORDER BY number"
        ).fetchall():
            if job:
                self._remember(at_s, job, state, words)
            else:
                self._note(state, words)

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

    def add(self, job_id: str, name: str) -> Job:
        """A new job, queued. `name` is what the person called the picture."""
        with self._lock:
            if job_id in self._jobs:
                raise ValueError(f"job {job_id} is there already")
            return self._append(job_id, State.QUEUED.value, name)

    def step(self, job_id: str, state: State, words: str = "") -> Job:
        """The job goes on to `state`. Raises ValueError when the table of states lacks that step."""
        with self._lock:
            check_step(self._jobs[job_id].state, state)
            return self._append(job_id, state.value, words)

    def new_sheet(self) -> None:
        """A person has put a new sheet in."""
        with self._lock:
            self._insert("", _SHEET, "")
            self._note(_SHEET, "")

    def hold(self, words: str) -> None:
        """No job may start, also after a restart. Holds for this daemon even when DiskTrouble is raised."""
        with self._lock:
            self.held = words
            self._insert("", _HELD, words)

    def go(self) -> None:
        with self._lock:
            self._insert("", _GO, "")
            self._note(_GO, "")

    def close(self) -> None:
        with self._lock:
            self._rows.close()

    def _append(self, job_id: str, state: str, words: str) -> Job:
        return self._remember(self._insert(job_id, state, words), job_id, state, words)

    def _insert(self, job_id: str, state: str, words: str) -> float:
        at_s = self._now()
        try:
            self._rows.execute(
                "INSERT INTO events (at_s, job, state, words) VALUES (?, ?, ?, ?)", (at_s, job_id, state, words)
            )
        except sqlite3.Error as error:
            raise DiskTrouble(f"the journal {self._path} cannot be written ({error}): free the disk") from None
        return at_s

    def _remember(self, at_s: float, job_id: str, state: str, words: str) -> Job:
        before = self._jobs.get(job_id, Job(job_id, words, State.QUEUED, "", at_s))
        said = "" if job_id not in self._jobs else words
        self._counts[State(state)] += 1
        if job_id in self._jobs:
            self._counts[before.state] -= 1
        self._jobs[job_id] = replace(before, state=State(state), words=said, changed_s=at_s)
        self.sheet_used = self.sheet_used or state == State.DRAWING.value
        return self._jobs[job_id]

    def _note(self, what: str, words: str) -> None:
        if what == _SHEET:
            self.sheet_used = False
        else:
            self.held = words if what == _HELD else ""
