"""What a machine is told so that a toolpath comes out as it is meant, by the errors its settings state."""

from __future__ import annotations

from daemon.config import Machine, Sheet
from daemon.jobs.sheet import corner_mm, reach_low_mm, reach_mm
from daemon.shapes import Toolpath
from daemon.toolpath.correct import Correction, corrected
from daemon.toolpath.reach import check_reach


def told(toolpath: Toolpath, sheet: Sheet, machine: Machine) -> Toolpath:
    """The toolpath for the machine itself. Raises OutOfReach where the correction leads out of its reach."""
    errors = Correction(machine.scale_x, machine.scale_y, machine.skew_deg, machine.backlash_mm, corner_mm(machine))
    moved = corrected(toolpath, errors)
    if moved is not toolpath:
        check_reach(
            moved.strokes,
            reach_mm=reach_mm(machine),
            reach_low_mm=reach_low_mm(sheet, machine),
            park_mm=moved.park_mm,
        )
    return moved
