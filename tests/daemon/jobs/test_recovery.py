"""What a start finds: strokes are told as they are, and what no folder can prove to be blank is not drawn again."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from daemon.jobs.promise import Ahead
from daemon.jobs.record import RECORD_NAME
from daemon.jobs.states import State
from daemon.shapes import Program, ProgramLine
from firmware_protocol.session import Ended, Verdict
from tests.daemon.jobs.bench import Bench, fault

NAMES = ("done", "cut", "begun", "planned", "dropped")


def without_journal(bench: Bench) -> Bench:
    """As `restarted`, but the journal is no longer there."""
    bench.journal.close()
    for file in bench.root.glob("journal.sqlite*"):
        file.unlink()
    return bench.restarted()


def test_a_cut_before_the_first_stroke_lets_the_job_wait_for_its_turn(bench: Bench) -> None:
    bench.planned()
    bench.station.begin_drawing()
    after = bench.restarted()
    assert (after.states(), after.station.held) == (["planned"], "")
    after.drawing.turn()
    assert after.states() == ["done"]
    after.journal.close()


def test_a_cut_after_it_says_what_may_be_on_the_sheet(bench: Bench) -> None:
    bench.planned()
    bench.begun(certain=1, possible=2)
    after = bench.restarted()
    assert after.states() == ["interrupted"]
    assert "of 2 strokes 1 are certainly drawn, none from 2 on is touched" in after.words()
    after.journal.close()


def test_a_locked_machine_is_not_asked_for_ever_to_lift_its_pen(bench: Bench) -> None:
    bench.planned("cut.png")
    bench.begun()
    bench.planned("next.png")
    after = bench.restarted()
    after.machine.locked = True
    after.drawing.turn()
    assert after.station.cut_off
    after.runner.go()
    for _ in range(3):
        after.now_s += 30.0
        after.drawing.turn()
    assert (after.states(), after.machine.lifted) == (["interrupted", "done"], 0)
    after.journal.close()


def test_a_fault_before_the_first_stroke_holds_but_loses_nothing(bench: Bench) -> None:
    bench.machine.endings = [Ended(Verdict.ALARM, 0, 0, False, False, "alarm: look")]
    bench.planned()
    bench.drawing.turn()
    assert (bench.states(), bench.station.held) == (["planned"], "alarm: look")
    bench.runner.go()
    bench.drawing.turn()
    assert bench.states() == ["done"]


def test_a_lost_journal_is_made_again_from_the_folders_and_nothing_is_drawn_twice(bench: Bench) -> None:
    bench.planned("done.png")
    bench.drawing.turn()
    bench.machine.endings = [fault(Verdict.SILENT)]
    bench.planned("cut.png")
    bench.drawing.turn()
    bench.runner.go()
    bench.planned("begun.png")
    bench.begun()
    bench.planned("planned.png")
    bench.drop("dropped.png")
    after = without_journal(bench)
    assert after.states() == ["done", "interrupted", "interrupted", "queued", "queued"]
    assert [job.name for job in after.journal.jobs()] == [
        f"{n}.png" for n in ["done", "cut", "begun", "planned", "dropped"]
    ]
    assert (after.journal.jobs()[1].certain, after.journal.jobs()[1].possible) == (1, 2)
    assert "how far this drawing came" in after.words(2)
    assert "the journal was lost" in after.station.held
    after.journal.close()


def test_a_planned_folder_without_a_record_is_not_drawn_by_itself(bench: Bench) -> None:
    job = bench.planned()
    (bench.desk.folders.path(job) / RECORD_NAME).unlink()
    after = without_journal(bench)
    assert after.states() == ["interrupted"]
    after.journal.close()


@pytest.mark.parametrize("text", ["", "{", "[]", "null", '{"state": "dancing"}'])
def test_a_record_that_cannot_be_read_is_not_trusted(bench: Bench, text: str) -> None:
    job = bench.drop()
    (bench.desk.folders.path(job) / RECORD_NAME).write_text(text)
    after = without_journal(bench)
    assert after.states() == ["interrupted"]
    after.journal.close()


def test_a_folder_that_was_deleted_by_hand_fails_its_job_alone(bench: Bench) -> None:
    first = bench.planned("a.png")
    bench.planned("b.png")
    shutil.rmtree(bench.desk.folders.path(first))
    for _ in range(2):
        bench.drawing.turn()
    assert bench.states() == ["failed", "done"]
    assert "deleted by hand" in bench.words(0)


def test_a_folder_that_was_deleted_meanwhile_fails_its_job_at_the_start(bench: Bench) -> None:
    shutil.rmtree(bench.desk.folders.path(bench.drop()))
    after = bench.restarted()
    assert (after.states(), "deleted by hand" in after.words()) == (["failed"], True)
    after.journal.close()


class Clocked:
    """Promises, with the time at which each was written."""

    def __init__(self, strokes: int, *, stroke_s: float, known: bool = True) -> None:
        self.now_s, self.written, self.strokes = 0.0, [(0.0, 0)], strokes
        self.stroke_s, lines = stroke_s, tuple(ProgramLine("G1", stroke) for stroke in range(strokes))
        times = [stroke_s * (stroke + 1) for stroke in range(strokes)] if known else []
        self.ahead = Ahead(self._write, Program(lines, strokes), times, now=lambda: self.now_s)

    def _write(self, certain: int, possible: int) -> None:
        self.written.append((self.now_s, possible))

    def draw(self) -> None:
        promised = 0
        for stroke in range(1, self.strokes + 1):
            if stroke > promised:
                promised = self.ahead(stroke, 0)
                assert promised >= stroke
            self.now_s += self.stroke_s

    def most_in_a_second(self, *, after_s: float) -> int:
        times = [at for at, _ in self.written[1:] if at >= after_s]
        return max((sum(at <= other < at + 1.0 for other in times) for at in times), default=0)


@pytest.mark.parametrize("stroke_s", [0.01, 0.1, 0.4, 0.9, 3.0])
def test_there_are_at_most_two_promises_a_second(stroke_s: float) -> None:
    clocked = Clocked(600, stroke_s=stroke_s)
    clocked.draw()
    assert clocked.most_in_a_second(after_s=0.0) <= 2
    assert clocked.written[-1][1] == 600


def test_where_nobody_knows_the_times_promises_grow_until_they_are_seldom() -> None:
    clocked = Clocked(4000, stroke_s=0.005, known=False)
    clocked.draw()
    assert clocked.most_in_a_second(after_s=3.0) <= 2


def test_what_fills_the_buffers_at_the_start_is_two_promises() -> None:
    clocked = Clocked(40, stroke_s=8.0)
    promised = 0
    for stroke in range(1, 6):
        promised = clocked.ahead(stroke, 0) if stroke > promised else promised
    assert len(clocked.written[1:]) == 2


def test_long_strokes_are_promised_one_by_one() -> None:
    clocked = Clocked(5, stroke_s=8.0)
    clocked.draw()
    assert [possible for _, possible in clocked.written[1:]] == [1, 2, 3, 4, 5]


def test_the_end_is_recorded_in_the_folder(bench: Bench) -> None:
    job = bench.planned()
    record: Path = bench.desk.folders.path(job) / RECORD_NAME
    seen: list[bool] = []
    bench.machine.while_drawing = lambda: seen.append('"drawing"' in record.read_text())
    bench.drawing.turn()
    assert seen == [True]
    assert f'"{State.DONE.value}"' in record.read_text()
