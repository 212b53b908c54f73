"""The pen that the settings describe."""

from __future__ import annotations

from daemon.config import Machine, ZPenSettings
from daemon.program.gcode import Pen, ServoPen, ZPen


def pen_of(machine: Machine) -> Pen:
    """What program/ writes for and what lifts it."""
    pen = machine.pen
    if isinstance(pen, ZPenSettings):
        return ZPen(pen.up_mm, pen.down_mm, pen.plunge_mm_s)
    return ServoPen(pen.up_s, pen.down_s, pen.dwell_s)
