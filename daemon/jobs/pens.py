"""The pen that the settings describe, as program/ wants it."""

from __future__ import annotations

from daemon.config import PenSettings, ZPenSettings
from daemon.program.gcode import Pen, ServoPen, ZPen


def pen_of(pen: PenSettings) -> Pen:
    """What program/ writes for and what lifts it."""
    if isinstance(pen, ZPenSettings):
        return z_pen_of(pen)
    return ServoPen(pen.up_s, pen.down_s, pen.dwell_s)


def z_pen_of(pen: ZPenSettings) -> ZPen:
    return ZPen(pen.up_mm, pen.down_mm, pen.plunge_mm_s)
