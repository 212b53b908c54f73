"""Where the box of a sheet lies in machine mm, and how far the machine reaches from its origin."""

from __future__ import annotations

from daemon.config import DobotMachine, EmcoMachine, GrblMachine, Machine, Sheet

_BEYOND_EVERY_ARM_MM = 1000.0
"""An arm reaches no rectangle: program/dobot.py checks each point by its joints."""


def corner_mm(machine: Machine) -> tuple[float, float]:
    """Where the sheet's corner lies in machine mm: where the pen stands or, homed, at origin_mm."""
    return machine.origin_mm if isinstance(machine, GrblMachine) and machine.origin == "homed" else (0.0, 0.0)


def box_origin_mm(sheet: Sheet, machine: Machine) -> tuple[float, float]:
    """The box's lower left corner in machine mm."""
    corner_x_mm, corner_y_mm = corner_mm(machine)
    x_mm, y_mm = sheet.box_origin_mm
    if sheet.corner.endswith("right"):
        x_mm = -x_mm - sheet.box_mm[0]
    if sheet.corner.startswith("upper"):
        y_mm = -y_mm - sheet.box_mm[1]
    return corner_x_mm + x_mm, corner_y_mm + y_mm


def reach_mm(machine: Machine) -> tuple[float, float]:
    """Width and height of the rectangle that the machine goes to."""
    if isinstance(machine, GrblMachine | EmcoMachine):
        return machine.reach_mm
    return 2 * _BEYOND_EVERY_ARM_MM, 2 * _BEYOND_EVERY_ARM_MM


def reach_low_mm(sheet: Sheet, machine: Machine) -> tuple[float, float]:
    """The smallest x and y the machine goes to: from a pen put on the sheet's corner the reach runs into the sheet."""
    if isinstance(machine, DobotMachine):
        return -_BEYOND_EVERY_ARM_MM, -_BEYOND_EVERY_ARM_MM
    width_mm, height_mm = reach_mm(machine)
    if isinstance(machine, GrblMachine) and machine.origin == "homed":
        # Homed, GRBL counts from minus its travel to nought, unless it has been given a work offset.
        x_mm, y_mm = machine.origin_mm
        return -width_mm if x_mm < 0 else 0.0, -height_mm if y_mm < 0 else 0.0
    return (
        -width_mm if sheet.corner.endswith("right") else 0.0,
        -height_mm if sheet.corner.startswith("upper") else 0.0,
    )


def homes(machine: Machine) -> bool:
    """It knows where the sheet's origin is whenever its port has been opened: by switches, or by its control's G54."""
    if isinstance(machine, GrblMachine | DobotMachine):
        return machine.home != "never" and counts_from_home(machine)
    return True


def counts_from_home(machine: Machine) -> bool:
    """Homed, it knows where the sheet's origin is."""
    return isinstance(machine, DobotMachine) or (isinstance(machine, GrblMachine) and machine.origin == "homed")


def holds_box(sheet: Sheet, machine: Machine) -> bool:
    """The machine reaches all of the box; an arm may still not reach every point of it."""
    left, bottom = box_origin_mm(sheet, machine)
    low, reach = reach_low_mm(sheet, machine), reach_mm(machine)
    right, top = left + sheet.box_mm[0], bottom + sheet.box_mm[1]
    return left >= low[0] and bottom >= low[1] and right <= low[0] + reach[0] and top <= low[1] + reach[1]
