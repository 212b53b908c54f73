"""A program on disk, and back."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from daemon.errors import DiskTrouble, LinedrawError
from daemon.program.file import load_program, parse_program, program_text
from daemon.program.gcode import ZPen, write_gcode
from daemon.shapes import Program, ProgramLine
from tests.daemon.program.examples import TOOLPATH

lines = st.builds(
    ProgramLine,
    st.from_regex(r"[GMXYZF][0-9]{1,4}( [XYF]-?[0-9]{1,3}\.[0-9]{3})*", fullmatch=True),
    st.none() | st.integers(0, 5),
)
programs = st.builds(Program, st.lists(lines, max_size=20).map(tuple), st.integers(6, 9))


@given(programs)
def test_what_is_written_is_read_back(program: Program) -> None:
    assert parse_program(program_text(program)) == program


def test_a_saved_program_is_loaded_with_its_strokes(tmp_path: Path) -> None:
    program = write_gcode(TOOLPATH, pen=ZPen(), draw_mm_s=20)
    (tmp_path / "program.gcode").write_text(program_text(program))
    assert load_program(tmp_path / "program.gcode") == program


def test_comments_are_for_people_and_never_in_the_program() -> None:
    program = parse_program("(linedrawd: 1 strokes)\n(stroke 0)\nG0 X1 (wow!)\n; Ärger?\n(no stroke)\nG0 X0\n")
    assert program.lines == (ProgramLine("G0 X1", 0), ProgramLine("G0 X0"))


@pytest.mark.parametrize("text", ["", "G0 X1\n"])
def test_a_file_of_another_maker_is_refused(text: str) -> None:
    with pytest.raises(LinedrawError, match="line 1: expected"):
        parse_program(text)


def test_a_file_with_other_bytes_is_refused(tmp_path: Path) -> None:
    (tmp_path / "program.gcode").write_bytes(b"(linedrawd: 1 strokes)\n\xc3\x84")
    with pytest.raises(LinedrawError, match="byte 23"):
        load_program(tmp_path / "program.gcode")


def test_a_file_that_is_missing_is_disk_trouble(tmp_path: Path) -> None:
    with pytest.raises(DiskTrouble, match="cannot read"):
        load_program(tmp_path / "gone" / "program.gcode")


def test_streaming_a_saved_program_loads_no_numpy() -> None:
    code = "import sys, daemon.program.file; sys.exit('numpy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
