"""The paper's own form of a program."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from daemon.program.file import program_text
from daemon.program.paper import Units, write_paper
from firmware_protocol.grbl.simulator.planner import line_ends
from tests.daemon.program.examples import TOOLPATH


@pytest.mark.parametrize("units", ["mm", "cm", "inch"])
def test_the_program_is_the_golden_one(units: Units, golden: Callable[[str, str], None]) -> None:
    golden(f"paper_{units}.gcode", program_text(write_paper(TOOLPATH, units=units)))


@pytest.mark.parametrize(
    ("units", "away", "x"), [("mm", "-5", "41.25"), ("cm", "-0.5", "4.12"), ("inch", "-0.2", "1.62")]
)
def test_positions_and_the_lifted_pen_are_scaled(units: Units, away: str, x: str) -> None:
    texts = [line.text for line in write_paper(TOOLPATH, units=units).lines]
    assert texts[1] == f"G00 Z{away}"
    assert any(text.startswith(f"X{x} ") for text in texts)


def test_a_stroke_is_first_vertex_engage_the_rest_disengage() -> None:
    stroke = [line.text for line in write_paper(TOOLPATH).lines if line.stroke == 0]
    assert stroke == ["X30.00 Y40.00", "G01 Z0", "X30.00 Y50.50", "X41.25 Y50.50", "G00 Z-5"]


def test_grbl_takes_every_line() -> None:
    assert line_ends([line.text for line in write_paper(TOOLPATH).lines])[-1].position_mm[2] == -5
