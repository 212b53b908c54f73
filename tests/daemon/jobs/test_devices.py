"""What the settings of a machine mean."""

from __future__ import annotations

import pytest

from daemon.config import GrblMachine
from daemon.jobs.devices import program_of, seconds_of
from daemon.jobs.grbl import moved
from tests.daemon.program.examples import TOOLPATH


def test_a_machine_that_homes_before_each_job_has_it_in_its_program() -> None:
    plain, homed = (program_of(TOOLPATH, GrblMachine(home=home), "cat.png") for home in ("never", "job"))  # type: ignore[arg-type]
    assert [line.text for line in homed.lines] == ["$H", *(line.text for line in plain.lines)]
    assert seconds_of(homed, GrblMachine(home="job")) == seconds_of(plain, GrblMachine()) > 0


@pytest.mark.parametrize(
    ("line", "elsewhere"),
    [
        ("G0 X1.000 Y-2.500", "G0 X11.000 Y-7.500"),
        ("X3 Y4", "X13.000 Y-1.000"),
        ("G1 Z0.000 F600", "G1 Z0.000 F600"),
        ("G91 G0 X1.000 Y1.000", "G91 G0 X1.000 Y1.000"),
        ("M3 S650", "M3 S650"),
    ],
)
def test_a_displaced_line_has_other_places_and_nothing_else(line: str, elsewhere: str) -> None:
    assert moved(line, (10.0, -5.0)) == elsewhere
