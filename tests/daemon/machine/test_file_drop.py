"""Programs are handed over as whole files, and what happens to them then is called an estimate."""

from __future__ import annotations

import os
import threading
from pathlib import Path

import numpy as np
import pytest

from daemon.errors import MachineFault, NoMachine
from daemon.machine.file_drop import FileDrop
from daemon.program.emco import write_emco
from daemon.program.gcode import ZPen
from daemon.shapes import Program, ProgramLine, Stroke, Toolpath
from firmware_protocol.emco.dialects import DialectName
from firmware_protocol.session import Ended, Event, Ready, Sent, Verdict

LINE = Toolpath((Stroke(np.array([[1.0, 1], [41, 1]])), Stroke(np.array([[1.0, 5], [41, 5]]))), np.zeros((2, 3)))


def program(dialect: DialectName = "fanuc", name: str = "O0001") -> Program:
    return write_emco(LINE, dialect=dialect, name=name, pen=ZPen(), draw_mm_s=10)


class Drop:
    """A folder that is waited for in no time; `stopped`: somebody stops while it is waited."""

    def __init__(self, folder: Path, *, stopped: bool = False, replace: bool = False) -> None:
        self.folder, self.stopped = folder, stopped
        self.events: list[Event] = []
        self.waited_s: list[float] = []
        self.machine = FileDrop(folder, heard=self.events.append, replace=replace, until_stopped=self._wait)

    def _wait(self, asked: threading.Event, seconds: float) -> bool:
        self.waited_s.append(seconds)
        if self.stopped:
            self.machine.stop()
        return asked.is_set()

    def draw(self, what: Program | None = None) -> Ended:
        return self.machine.draw(what or program())

    @property
    def files(self) -> list[str]:
        return sorted(os.listdir(self.folder))


def test_the_whole_program_lies_in_the_folder_under_its_name(tmp_path: Path) -> None:
    drop = Drop(tmp_path)
    drop.draw()
    assert drop.files == ["O0001.NC"]
    assert (tmp_path / "O0001.NC").read_bytes().splitlines() == [line.text.encode() for line in program().lines]


def test_a_siemens_program_is_called_by_its_head(tmp_path: Path) -> None:
    drop = Drop(tmp_path)
    drop.draw(program("siemens", "LD_CAT"))
    assert drop.files == ["LD_CAT.MPF"]


def test_sent_is_said_first_and_drawn_is_an_estimate_after_its_time(tmp_path: Path) -> None:
    drop = Drop(tmp_path)
    drop.machine.connect()
    end = drop.draw()
    assert [type(event) for event in drop.events] == [Ready, Sent, Ended]
    assert (end.verdict, end.strokes_certain, end.strokes_possible, end.estimated) == (Verdict.FINISHED, 0, 2, True)
    (waited_s,) = drop.waited_s
    # Two lines of 40 mm at 10 mm/s, the pen lowered twice, and the way there.
    assert 8 < waited_s < 18


def test_a_program_of_the_same_name_that_differs_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "O0001.NC").write_text("%\nO0001\n(mine)\nM30\n%\n")
    end = Drop(tmp_path).draw()
    assert (end.verdict, end.strokes_possible) == (Verdict.REJECTED, 0)
    assert "move it away" in end.why
    assert "(mine)" in (tmp_path / "O0001.NC").read_text()


def test_it_is_replaced_where_that_is_wanted(tmp_path: Path) -> None:
    (tmp_path / "O0001.NC").write_text("old")
    assert Drop(tmp_path, replace=True).draw().verdict is Verdict.FINISHED
    assert (tmp_path / "O0001.NC").read_text().startswith("%")


def test_the_same_program_may_be_dropped_again(tmp_path: Path) -> None:
    drop = Drop(tmp_path)
    assert [drop.draw().verdict, drop.draw().verdict] == [Verdict.FINISHED] * 2


def test_a_stop_takes_the_file_back_and_says_what_nobody_knows(tmp_path: Path) -> None:
    drop = Drop(tmp_path, stopped=True)
    end = drop.draw()
    assert drop.files == []
    assert (end.verdict, end.strokes_certain, end.strokes_possible) == (Verdict.STOPPED, 0, 2)
    assert (end.pen_lifted, end.position_known) == (False, False)
    assert "RESET" in end.why


def test_a_stop_does_not_take_away_what_somebody_has_changed(tmp_path: Path) -> None:
    events: list[Event] = []

    def changed(asked: threading.Event, seconds: float) -> bool:
        (tmp_path / "O0001.NC").write_text("(mine)")
        return True

    FileDrop(tmp_path, heard=events.append, until_stopped=changed).draw(program())
    assert (tmp_path / "O0001.NC").read_text() == "(mine)"


def test_a_stop_from_before_is_obeyed_before_anything_is_written(tmp_path: Path) -> None:
    drop = Drop(tmp_path)
    drop.machine.stop()
    assert drop.draw().strokes_possible == 0
    assert drop.files == []
    assert drop.draw().verdict is Verdict.FINISHED


def test_a_program_that_cannot_be_written_leaves_nothing_behind(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    drop = Drop(tmp_path)
    end = drop.draw()
    assert (end.verdict, end.strokes_possible) == (Verdict.UNPLUGGED, 0)
    assert "No space left" in end.why
    assert drop.files == []


def test_the_control_never_sees_a_part_of_a_program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[tuple[list[str], int]] = []
    real = os.fsync

    def look(descriptor: int) -> None:
        seen.append((os.listdir(tmp_path), os.fstat(descriptor).st_ino))
        real(descriptor)

    monkeypatch.setattr(os, "fsync", look)
    Drop(tmp_path).draw()
    # What was written under the other name is, whole, the file that the control sees.
    assert seen[0] == (["O0001.NC.part"], (tmp_path / "O0001.NC").stat().st_ino)


def test_a_missing_folder_is_no_machine(tmp_path: Path) -> None:
    drop = Drop(tmp_path / "share")
    with pytest.raises(NoMachine, match="is no folder"):
        drop.machine.connect()
    with pytest.raises(MachineFault, match="is no folder"):
        drop.machine.listen()


def test_a_program_for_another_controller_is_refused(tmp_path: Path) -> None:
    with pytest.raises(MachineFault, match="begins no program"):
        Drop(tmp_path).draw(Program((ProgramLine("G21 G90"),), 0))
    assert Drop(tmp_path).machine.line_times_s(Program((ProgramLine("G21 G90"),), 0)) == []


def test_the_times_of_the_lines_are_those_of_the_time_model(tmp_path: Path) -> None:
    times = Drop(tmp_path).machine.line_times_s(program())
    assert len(times) == len(program().lines)
    assert list(times) == sorted(times)
