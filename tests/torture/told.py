"""What the journal tells of every job, read while the daemon is at work on it."""

from __future__ import annotations

import re
import sqlite3
from contextlib import closing
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from daemon.jobs.states import ALLOWED, OVER, State

_FIGURES = re.compile(r"of \d+ strokes (\d+) are certainly drawn, none from (\d+) on is touched")
_STATES = {state.value for state in State}
_ALL = re.compile(r"all (\d+) strokes are drawn")


@dataclass(frozen=True, slots=True)
class Told:
    """A job's steps, the words of the last one, and how many strokes are certainly drawn and may be touched.

    begun_on: the machine of each time that its drawing began.
    """

    id: str
    states: tuple[State, ...]
    words: str
    certain: int = 0
    possible: int = 0
    begun_on: tuple[str, ...] = ()

    @property
    def state(self) -> State:
        return self.states[-1]

    @property
    def over(self) -> bool:
        """No ink comes any more, unless a person wants it."""
        return self.state in OVER

    @property
    def said(self) -> tuple[int, int] | None:
        """What people are told: how many are certainly drawn, and after how many none is touched; None: nothing."""
        if every := _ALL.search(self.words):
            return int(every[1]), int(every[1])
        if figures := _FIGURES.search(self.words):
            return int(figures[1]), int(figures[2])
        return None


def told(journal: Path) -> dict[str, Told]:
    """Every job, in the order in which they came; none while the journal cannot be read."""
    try:
        with closing(sqlite3.connect(f"file:{journal}?mode=ro", uri=True)) as rows:
            events = rows.execute(
                "SELECT job, state, words, machine FROM events WHERE job <> '' ORDER BY number"
            ).fetchall()
            ink = {job: figures for job, *figures in rows.execute("SELECT job, certain, possible FROM ink")}
    except sqlite3.Error:
        return {}  # It is just being made.
    jobs: dict[str, Told] = {}
    for job, name, words, machine in events:
        if name in _STATES:
            before = jobs.get(job, Told(job, (), ""))
            begun_on = (*before.begun_on, machine) if name == State.DRAWING.value else before.begun_on
            jobs[job] = Told(job, (*before.states, State(name)), words, *ink.get(job, (0, 0)), begun_on)
    return jobs


def faults_of(journal: Path) -> list[str]:
    """Whatever is wrong with the journal itself: its file, and steps that the table of states lacks."""
    with closing(sqlite3.connect(f"file:{journal}?mode=ro", uri=True)) as rows:
        checked = [row[0] for row in rows.execute("PRAGMA integrity_check")]
    wrong = [] if checked == ["ok"] else [f"the journal is corrupt: {checked[0]}"]
    for job in told(journal).values():
        for before, after in pairwise(job.states):
            if after not in ALLOWED[before]:
                wrong.append(f"job {job.id} went from {before.value} to {after.value}")
    return wrong
