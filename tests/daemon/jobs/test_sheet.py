"""The box lies inwards from the corner of the sheet where the origin is."""

from __future__ import annotations

import pytest

from daemon.config import DobotMachine, EmcoMachine, GrblMachine, Machine, Sheet
from daemon.jobs.sheet import box_origin_mm, homes, reach_low_mm


@pytest.mark.parametrize(
    ("corner", "box", "low"),
    [
        ("lower left", (10, 20), (0, 0)),
        ("lower right", (-70, 20), (-200, 0)),
        ("upper left", (10, -60), (0, -100)),
        ("upper right", (-70, -60), (-200, -100)),
    ],
)
def test_from_each_corner_box_and_reach_run_into_the_sheet(
    corner: str, box: tuple[float, float], low: tuple[float, float]
) -> None:
    sheet = Sheet.model_validate({"box_mm": (60, 40), "box_origin_mm": (10, 20), "corner": corner})
    machine = GrblMachine(reach_mm=(200, 100))
    assert box_origin_mm(sheet, machine) == box
    assert reach_low_mm(sheet, machine) == low


def test_homed_the_corner_lies_where_the_settings_say_and_the_reach_begins_at_nought() -> None:
    sheet = Sheet(box_mm=(60, 40), box_origin_mm=(10, 20), corner="lower right")
    machine = GrblMachine(origin="homed", origin_mm=(150, 5))
    assert box_origin_mm(sheet, machine) == (80, 25)
    assert reach_low_mm(sheet, machine) == (0, 0)


def test_homed_the_reach_ends_at_nought_where_the_corner_lies_below_it() -> None:
    machine = GrblMachine(origin="homed", origin_mm=(-190, -90), reach_mm=(200, 100))
    assert reach_low_mm(Sheet(), machine) == (-200, -100)


@pytest.mark.parametrize(
    ("machine", "knows"),
    [
        (GrblMachine(), False),
        (GrblMachine(home="start", origin="homed", origin_mm=(-200.0, -200.0)), True),
        (EmcoMachine(device="emco"), True),
        (DobotMachine(device="dobot"), True),
        (DobotMachine(device="dobot", home="never"), False),
    ],
)
def test_a_machine_knows_its_origin_by_itself_where_it_homes_and_counts_from_there(
    machine: Machine, knows: bool
) -> None:
    assert homes(machine) is knows
