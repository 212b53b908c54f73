"""Cut between every two writes: no picture is lost, none is there twice, no stroke is drawn twice, and what is said
of the sheet is true.
"""

from __future__ import annotations

import os
import shutil
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import closing, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest

from daemon.config import GrblMachine
from daemon.jobs.allotment import Allotment
from daemon.jobs.desk import Desk
from daemon.jobs.drawing import Drawing
from daemon.jobs.folder import CLAIMED, JobFolders, write_durably
from daemon.jobs.journal import Journal
from daemon.jobs.kept_ink import Reports
from daemon.jobs.moves import GrblMoves
from daemon.jobs.orders import Places
from daemon.jobs.planning import Planning
from daemon.jobs.states import State
from daemon.jobs.station import Station
from daemon.machine.link import Promise, promise_nothing
from daemon.program.file import load_program
from daemon.shapes import Program
from firmware_protocol.session import Ended, Verdict
from tests.daemon.jobs.bench import InstantMachine
from tests.daemon.jobs.cuts import Cut, Disk
from tests.daemon.jobs.planners import PROGRAM

PICTURES = ("a.png", "b.png", "c.png")
STROKES = 3
THIRD = "(stroke 2)\nG0 X1 Y8\nG1 Z0 F600\nG1 X9 Y8 F1200\nG0 Z5\n(no stroke)\nG0 X0 Y0\n"


class Plotter(InstantMachine):
    """Counts how often each stroke of each picture leaves for it. One picture's drawing ends in an alarm."""

    def __init__(self, sent: Counter[tuple[str, int]], reach: Callable[[str], None]) -> None:
        super().__init__()
        self.sent, self.reach, self.picture, self.alarm_in = sent, reach, "", ""

    def draw(self, program: Program, promise: Promise = promise_nothing) -> Ended:
        promised = 0
        for stroke in range(program.strokes):
            if stroke >= promised:
                promised = promise(stroke + 1, max(0, stroke - 1))
            self.reach("before a byte")
            self.sent[self.picture, stroke] += 1
            self.reach("after a byte")
            if (self.picture, stroke) == (self.alarm_in, 1):
                return Ended(Verdict.ALARM, 0, 2, False, False, "alarm: look")
        return Ended(Verdict.FINISHED, program.strokes, program.strokes, True, True, "drawn")


class Planner:
    def plan(self, source: Path, folder: Path, machine: str, *, planned: Callable[[], None], **options: Any) -> None:
        write_durably(folder / "report.json", b"{}")
        write_durably(
            folder / "program.gcode", PROGRAM.replace("(linedrawd: 2", "(linedrawd: 3").encode() + THIRD.encode()
        )
        planned()


class House:
    """One daemon on a folder, without threads."""

    def __init__(self, root: Path, sent: Counter[tuple[str, int]], reach: Callable[[str], None] = lambda name: None):
        self.root, self.inbox = root, root / "inbox"
        self.journal = Journal(root / "journal.sqlite")
        self.journal._rows.execute("PRAGMA synchronous=OFF")
        told: dict[str, Any] = {"say": lambda words, **values: None, "show": lambda **values: None}
        self.desk = Desk(self.journal, JobFolders(root / "jobs"), **told)
        self.station = Station(self.desk, "plotter", show=told["show"], asks_for_sheets=False)
        self.planning = Planning(self.desk, Planner(), Allotment(self.desk))  # type: ignore[arg-type]
        self.machine = Plotter(sent, reach)
        self.drawing = Drawing(
            self.station,
            opened=self.machine.open,
            load=self._load,
            reports=Reports(lambda folder: None, lambda folder: None),
            moves=GrblMoves(GrblMachine()),
            places=Places((0.0, 0.0), lambda job: [], lambda: Program((), 0)),
        )

    def _load(self, path: Path) -> Program:
        self.machine.picture = (path.parent / "source.png").read_text()
        return load_program(path)

    def recover(self) -> None:
        self.desk.folders.finish_claims(self.inbox)
        self.desk.recover()

    def live(self) -> None:
        """From the inbox to the paper; a person says `go` after every fault."""
        self.recover()
        for picture in sorted(self.inbox.glob("*.png")):
            self.desk.add(self.desk.folders.take(picture), picture.name)
        for _ in range(2 * len(PICTURES) + 2):
            self.planning.turn()
            if self.station.held:
                self.station.go()
            self.drawing.turn()

    def places_of(self, picture: str) -> int:
        hidden = list(self.inbox.glob(f"{CLAIMED}*"))
        folders = [file for file in (self.root / "jobs").glob("*/source*") if file.suffix != ".part"]
        return sum(file.read_text() == picture for file in [*self.inbox.glob("*.png"), *folders, *hidden])


def with_pictures(root: Path) -> Path:
    (root / "inbox").mkdir(parents=True)
    for picture in PICTURES:
        (root / "inbox" / picture).write_text(picture)
    return root


def lived(root: Path, disk: Disk) -> Counter[tuple[str, int]]:
    """What has been sent to the machine until the disk was cut off."""
    sent: Counter[tuple[str, int]] = Counter()
    with suppress(Cut):
        house = House(root, sent, disk.reach)
        house.machine.alarm_in = "b.png"
        with closing(house.journal):
            house.live()
    return sent


@pytest.fixture
def folder(tmp_path: Path) -> Iterator[Path]:
    """In memory where there is such a place: what is tried here does without a real disk's patience."""
    shm = Path("/dev/shm")
    with TemporaryDirectory(dir=shm if os.access(shm, os.W_OK) else tmp_path) as name:
        yield Path(name)


@pytest.fixture(scope="module")
def writes(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    root = with_pictures(tmp_path_factory.mktemp("whole"))
    with pytest.MonkeyPatch.context() as patch:
        disk = Disk(None, patch)
        sent = lived(root, disk)
    assert set(sent.values()) == {1}
    assert len(sent) == 8
    return disk.names


def check_after(root: Path, sent: Counter[tuple[str, int]], where: str) -> None:
    """What a restart finds, and what becomes of it when a person lets everything go on."""
    at_cut = Counter(sent)
    house = House(root, sent)
    house.recover()
    for picture in PICTURES:
        assert house.places_of(picture) == 1, f"{picture} {where}"
    for job in house.journal.jobs():
        source = (root / "jobs" / job.id / "source.png").read_text()
        drawn = sum(at_cut[source, stroke] for stroke in range(STROKES))
        assert job.certain <= drawn <= job.possible, f"{job} {where}"
        if drawn and job.state is not State.DONE:
            assert job.state is State.INTERRUPTED, f"{job} {where}"
    house.live()
    for picture in PICTURES:
        assert house.places_of(picture) == 1, f"{picture} {where}"
    assert max(sent.values()) == 1, f"{sent} {where}"
    jobs = house.journal.jobs()
    assert len(jobs) == len(PICTURES), f"{jobs} {where}"
    for job in jobs:
        source = (root / "jobs" / job.id / "source.png").read_text()
        begun = any(at_cut[source, stroke] for stroke in range(STROKES))
        whole = all(sent[source, stroke] for stroke in range(STROKES))
        promised = job.possible > 0
        assert whole if job.state is State.DONE else (job.state is State.INTERRUPTED and (begun or promised)), where
    house.journal.close()


@pytest.mark.parametrize("power", [False, True], ids=["killed", "without power"])
def test_a_cut_between_any_two_writes_loses_nothing_and_repeats_nothing(
    writes: list[str], folder: Path, power: bool
) -> None:
    for number, name in enumerate(writes):
        root = with_pictures(folder / str(number))
        with pytest.MonkeyPatch.context() as patch:
            disk = Disk(number, patch)
            sent = lived(root, disk)
        assert disk.dead
        if power:
            disk.lose_what_is_not_durable()
        check_after(root, sent, f"at write {number} ({name})")
        shutil.rmtree(root)


def test_the_points_are_those_that_there_are(writes: list[str]) -> None:
    """A write that goes past the counted ones would be cut nowhere."""
    assert {"rename", "fsync", "mkdir", "open", "journal", "before a byte", "after a byte"} <= set(writes)
    assert len(writes) > 100


@pytest.mark.parametrize("lost", ["journal.sqlite", "journal.sqlite-wal"])
def test_a_cut_together_with_a_lost_journal_repeats_nothing(writes: list[str], folder: Path, lost: str) -> None:
    for number in range(0, len(writes), 3):
        root = with_pictures(folder / str(number))
        with pytest.MonkeyPatch.context() as patch:
            sent = lived(root, Disk(number, patch))
        for file in root.glob(f"{lost}*"):
            file.unlink()
        house = House(root, sent)
        house.live()
        assert max(sent.values()) == 1, number
        assert all(house.places_of(picture) == 1 for picture in PICTURES), number
        house.journal.close()
        shutil.rmtree(root)


def test_a_log_of_the_journal_that_is_torn_anywhere_leaves_the_steps_before(tmp_path: Path) -> None:
    path = tmp_path / "j"
    with closing(Journal(path)):
        pass
    journal = Journal(path)
    journal._rows.execute("PRAGMA wal_autocheckpoint=0")
    journal.add("1", "a.png")
    for state in (State.PLANNING, State.PLANNED, State.DRAWING):
        journal.step("1", state)
    journal.promise("1", strokes=9, certain=2, possible=4)
    database, log = path.read_bytes(), (tmp_path / "j-wal").read_bytes()
    journal.close()
    seen: list[tuple[int, int]] = []
    frame = 24 + 4096
    cuts = {32 + frame * number + more for number in range(len(log) // frame + 1) for more in (-1, 0, 1, 24, 2000)}
    for size in sorted(cut for cut in cuts if 0 <= cut <= len(log)):
        (tmp_path / "torn").write_bytes(database)
        (tmp_path / "torn-wal").write_bytes(log[:size])
        with closing(Journal(tmp_path / "torn")) as torn:
            rows = torn._rows.execute("SELECT count(*) FROM events").fetchone()[0]
            seen.append((rows, torn.jobs()[0].possible if rows else 0))
        for file in tmp_path.glob("torn*"):
            file.unlink()
    assert seen == sorted(seen)
    assert {(0, 0), (1, 0), (2, 0), (3, 0), (4, 0), (4, 4)} == set(seen)
