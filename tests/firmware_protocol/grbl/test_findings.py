"""What a controller has otherwise than a drawing wants it, and the command that mends it."""

from __future__ import annotations

import pytest

from firmware_protocol.grbl.findings import Needs, findings, needs_of
from firmware_protocol.grbl.path import Modal, Path

GOOD = {1: 255.0, 10: 3.0, 13: 0.0, 20: 0.0, 22: 0.0, 23: 0.0, 30: 1000.0, 31: 0.0, 32: 0.0}
TRAVEL = {130: 200.0, 131: 200.0, 132: 50.0}
PAGE = ((10.0, 20.0, 0.0), (110.0, 170.0, 5.0))
SERVO = frozenset({30.0, 90.0})
HOMED = GOOD | TRAVEL | {20: 1.0, 22: 1.0}


def commands(settings: dict[int, float], needs: Needs) -> list[tuple[str, bool]]:
    return [(finding.command, finding.blocks) for finding in findings(settings, needs)]


def test_a_controller_that_is_set_up_has_no_findings() -> None:
    assert findings(GOOD | TRAVEL, Needs(PAGE, SERVO)) == []


@pytest.mark.parametrize(
    ("setting", "command", "blocks"),
    [
        ({1: 25.0}, "$1=255", False),
        ({10: 1.0}, "$10=3", False),
        ({13: 1.0}, "$13=0", False),
        ({30: 60.0}, "$30=90", True),
        ({31: 50.0}, "$31=0", True),
        ({31: 1000.0}, "$31=0", True),
        ({32: 1.0}, "$32=0", True),
    ],
)
def test_each_setting_that_deviates_names_the_command_that_mends_it(
    setting: dict[int, float], command: str, blocks: bool
) -> None:
    assert commands(GOOD | setting, Needs(PAGE, SERVO)) == [(command, blocks)]
    (finding,) = findings(GOOD | setting, Needs(PAGE, SERVO))
    assert command in finding.why


@pytest.mark.parametrize("setting", [{30: 60.0}, {31: 50.0}, {32: 1.0}])
def test_a_pen_without_a_servo_does_not_care_for_the_spindle(setting: dict[int, float]) -> None:
    assert findings(GOOD | setting, Needs(PAGE)) == []


@pytest.mark.parametrize(("firmware", "found"), [("Grbl 1.1h", 0), ("Grbl 1.0c", 1), ("GrblHAL 1.1f", 1)])
def test_another_firmware_is_told(firmware: str, found: int) -> None:
    assert len(findings(GOOD, Needs(firmware=firmware))) == found


def test_a_homed_machine_counts_below_zero_and_needs_an_offset_for_positive_places() -> None:
    x, y, z = findings(HOMED, Needs(PAGE))
    assert (x.blocks, x.command) == (True, "G10 L2 P1 X-200")
    assert "from 10 to 110 mm" in x.why
    assert "from -200 to 0 mm" in x.why
    assert (y.command, z.command) == ("G10 L2 P1 Y-200", "G10 L2 P1 Z-50")


@pytest.mark.parametrize(("offset", "found"), [((-200.0, -200.0, -5.0), 0), ((-95.0, -200.0, -5.0), 1)])
def test_the_work_offset_counts(offset: tuple[float, float, float], found: int) -> None:
    assert len(findings(HOMED, Needs(PAGE, offset_mm=offset))) == found


def test_a_build_that_homes_to_zero_counts_above_it_on_axes_that_home_downwards() -> None:
    assert findings(HOMED | {23: 7.0}, Needs(PAGE, letters="VZ")) == []
    assert len(findings(HOMED | {23: 6.0}, Needs(PAGE, letters="VZ"))) == 1


def test_a_drawing_larger_than_the_travel_has_no_command() -> None:
    finding = findings(HOMED | {130: 90.0}, Needs(PAGE, offset_mm=(-90.0, -200.0, -5.0)))[0]
    assert (finding.blocks, finding.command) == (True, "")
    assert "scale the page" in finding.why


def test_without_homing_the_travel_is_only_advice() -> None:
    (finding,) = findings(GOOD | TRAVEL | {131: 100.0}, Needs(PAGE))
    assert (finding.about, finding.blocks, finding.command) == ("$131", False, "")


def test_what_a_program_needs_is_read_from_its_lines() -> None:
    lines = ["G21 G90", "M3 S30", "G0 X10 Y0", "M3 S90", "G1 X20 F600", "G2 X30 Y0 I5 J0", "M5", "S5"]
    needs = needs_of(Path(lines, Modal(place=(0.0, 0.0, 0.0)), steps_mm=(250.0, 250.0, 250.0)))
    assert needs.speeds == SERVO
    assert needs.extent_mm == ((10.0, 0.0, 0.0), (30.0, 5.0, 0.0))
