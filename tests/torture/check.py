"""What must be true after every kill: of the pictures, of the ink, and of what is said about both."""

from __future__ import annotations

import hashlib
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from daemon.errors import LinedrawError
from daemon.jobs.folder import source_of
from daemon.jobs.states import State
from tests.torture.rig import Daemon, Machine, Sheet
from tests.torture.sheet import Inked, Line, strokes_of, whose
from tests.torture.told import Told, faults_of, told

PLANNERS = 2
"""So many workers die over a picture before its job fails, as it is meant to; the picture stays in its folder."""

ON_ITS_WAY_S = 5.0
"""A picture may be between the inbox and its folder for so long; what is lost or doubled stays so."""


@dataclass(slots=True)
class Found:
    """What was found wrong, each once: by what it is, in words."""

    lost: dict[str, str] = field(default_factory=dict)
    doubled: dict[str, str] = field(default_factory=dict)
    wrong_prefix: dict[str, str] = field(default_factory=dict)
    other: dict[str, str] = field(default_factory=dict)

    @property
    def count(self) -> int:
        return sum(map(len, (self.lost, self.doubled, self.wrong_prefix, self.other)))

    def last_line(self, kills: int) -> str:
        lost, doubled, wrong = len(self.lost), len(self.doubled), len(self.wrong_prefix)
        return f"kills {kills}, lost {lost}, doubled {doubled}, wrong prefix {wrong}"


class Checks:
    """Compares what lies in the state folder with the pictures that were dropped and with the ink."""

    def __init__(self, daemon: Daemon, machines: Sequence[Machine]) -> None:
        self._daemon, self._machines = daemon, machines
        self._dropped: dict[str, str] = {}
        self._programs: dict[str, list[Line]] = {}
        self.known: dict[str, list[Inked | None]] = {machine.name: [] for machine in machines}
        """What each line of ink is, on the sheet of each machine."""
        self.found = Found()
        self.cancelled: set[str] = set()
        self.planners_killed: Counter[str] = Counter()
        """How often the worker was killed over each job: one of them is made good, a second one fails the job."""

    def dropped(self, picture: Path, name: str) -> None:
        """A picture is about to be put into the inbox under this name."""
        self._dropped[_hash(picture)] = name

    def all(self) -> None:
        """Look at everything. The daemon may be at work meanwhile: only what is over is judged."""
        jobs = told(self._daemon.journal)
        # What is certain is on the sheet later; what is there is of a job, and promised, later still.
        sheets = {machine.name: machine.sheet() for machine in self._machines}
        later = told(self._daemon.journal)
        self._know_ink(later, sheets)
        self._check_ink(jobs)
        self._check_promises(later)
        self._check_pictures(jobs)
        for wrong in faults_of(self._daemon.journal):
            self.found.other[wrong] = wrong

    def at_the_end(self) -> None:
        """Nothing is under way any more: every job is over, and none has ended before its first ink by our doing."""
        jobs = told(self._daemon.journal)
        inked = {known.job for known in self._inked()}
        for job in jobs.values():
            if not job.over:
                self.found.lost[job.id] = f"job {job.id} is still {job.state.value}: {job.words}"
            elif job.state is State.FAILED and job.id not in inked and self.planners_killed[job.id] < PLANNERS:
                self.found.lost[job.id] = f"job {job.id} failed before its first ink: {job.words}"
            elif job.state is State.CANCELLED and job.id not in self.cancelled:
                self.found.lost[job.id] = f"job {job.id} was cancelled by nobody: {job.words}"

    def _check_pictures(self, jobs: dict[str, Told]) -> None:
        """Every dropped picture is a job or lies in the inbox, once. One that is on its way is looked at again."""
        wrong, until = self._wrong_pictures(), time.monotonic() + ON_ITS_WAY_S
        while wrong and time.monotonic() < until:
            time.sleep(0.1)
            wrong = {key: words for key, words in self._wrong_pictures().items() if key in wrong}
        for (kind, name), words in wrong.items():
            getattr(self.found, kind)[name] = words
        for job in jobs.values():
            if source_of(self._daemon.jobs / job.id) is None:
                self.found.lost[job.id] = f"job {job.id} has no picture in its folder"

    def _wrong_pictures(self) -> dict[tuple[str, str], str]:
        here = [path for path in self._daemon.inbox.iterdir() if path.is_file()]
        here += [path for folder in self._daemon.jobs.iterdir() if (path := source_of(folder))]
        copies = Counter(_hash(path) for path in here)
        wrong = {}
        for key, name in self._dropped.items():
            if copies[key] == 0:
                wrong["lost", name] = f"the picture {name} is nowhere"
            elif copies[key] > 1:
                wrong["doubled", name] = f"the picture {name} is there {copies[key]} times"
        return wrong

    def _know_ink(self, jobs: dict[str, Told], sheets: dict[str, Sheet]) -> None:
        programs = {job.id: self._program(job.id) for job in jobs.values() if State.DRAWING in job.states}
        for machine, sheet in sheets.items():
            self._identify(self.known[machine], sheet.lines, programs)
        self.check_times()

    def _check_ink(self, jobs: dict[str, Told]) -> None:
        for job in jobs.values():
            if job.over:
                self._check_words(job)
            if missing := set(range(job.certain)) - self._strokes(job, whole=True):
                self._wrong(job, f"strokes {sorted(missing)}, certain in the journal, are not there whole")

    def check_times(self) -> None:
        """Every line of ink is a stroke, each stroke is there once, and those of a job are on one sheet."""
        for machine, lines in self.known.items():
            for number, known in enumerate(lines):
                if known is None:
                    words = f"line {number} of the ink of {machine} is of no stroke of any job"
                    self.found.wrong_prefix[f"line {machine} {number}"] = words
        for (job, stroke), times in Counter((known.job, known.stroke) for known in self._inked()).items():
            if times > 1:
                self.found.doubled[f"{job} {stroke}"] = f"stroke {stroke} of job {job} was inked {times} times"
        on = Counter(job for lines in self.known.values() for job in {known.job for known in lines if known})
        for job, machines in on.items():
            if machines > 1:
                self.found.doubled[job] = f"ink of job {job} is on the sheets of {machines} machines"

    def _check_promises(self, jobs: dict[str, Told]) -> None:
        """No stroke was touched before the journal said that it may be."""
        for job in jobs.values():
            if beyond := {stroke for stroke in self._strokes(job) if stroke >= job.possible}:
                self._wrong(job, f"strokes {sorted(beyond)} were touched without a word in the journal")

    def _inked(self) -> Iterator[Inked]:
        """Every line of ink that is known, of all machines."""
        return (known for lines in self.known.values() for known in lines if known)

    def _identify(self, known: list[Inked | None], lines: list[Line], programs: dict[str, list[Line]]) -> None:
        """The last line may have grown since, every other one is known once and for ever."""
        recent = dict(list(programs.items())[-6:])
        for line in lines[max(0, len(known) - 1) :]:
            found = whose(line, recent) or whose(line, programs)
            if known and line is lines[len(known) - 1]:
                known[-1] = found
            else:
                known.append(found)

    def _strokes(self, job: Told, *, whole: bool = False) -> set[int]:
        """Those of this job that are on the sheet, all or the whole ones."""
        inked = (known for known in self._inked() if known.job == job.id)
        return {known.stroke for known in inked if known.whole or not whole}

    def _check_words(self, job: Told) -> None:
        touched = self._strokes(job)
        if job.said is None:
            if touched:
                self._wrong(job, f"strokes {sorted(touched)} are touched")
            return
        certain, possible = job.said
        if missing := set(range(certain)) - self._strokes(job, whole=True):
            self._wrong(job, f"strokes {sorted(missing)} are not there whole")
        if beyond := {stroke for stroke in touched if stroke >= possible}:
            self._wrong(job, f"strokes {sorted(beyond)} are touched")

    def _wrong(self, job: Told, but: str) -> None:
        self.found.wrong_prefix[job.id] = f"job {job.id} says '{job.words}', but {but}"

    def _program(self, job: str) -> list[Line]:
        """Of a job that is or was drawn: its program no longer changes."""
        if job not in self._programs:
            try:
                self._programs[job] = strokes_of(self._daemon.jobs / job / "program.gcode")
            except LinedrawError as error:
                self.found.other[job] = f"job {job} was drawn without a program that can be read: {error}"
                return []
        return self._programs[job]


def _hash(path: Path) -> str:
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except FileNotFoundError:
        return ""  # It has just been claimed.
