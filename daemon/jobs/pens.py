"""The pens that the settings describe: how one is lifted, as program/ wants it, and their colours."""

from __future__ import annotations

from daemon.colours import Pens, rgb_of
from daemon.config import Pens as PensSettings
from daemon.config import PenSettings, ZPenSettings
from daemon.program.gcode import Pen, ServoPen, ZPen


def pen_of(pen: PenSettings) -> Pen:
    """What program/ writes for and what lifts it."""
    if isinstance(pen, ZPenSettings):
        return z_pen_of(pen)
    return ServoPen(pen.up_s, pen.down_s, pen.dwell_s)


def z_pen_of(pen: ZPenSettings) -> ZPen:
    return ZPen(pen.up_mm, pen.down_mm, pen.plunge_mm_s)


def pens_of(said: PensSettings) -> Pens:
    """All that are set, in their order."""
    colours = [rgb_of(colour) for colour in said.colours.values()]
    skip = frozenset(number for number, name in enumerate(said.colours) if name in said.skip)
    return Pens(tuple(said.colours), tuple(rgb for rgb in colours if rgb is not None), skip)
