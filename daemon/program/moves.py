"""The moves of a stroke to the last decimal that a program shows."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from daemon.shapes import Arc, Line, ProgramLine, Stroke, Toolpath
from firmware_protocol.pens import PEN_CHANGE

_DECIMALS = 3


class Written(NamedTuple):
    """A move to `end`, (x, y) in mm. to_centre: the way from its start to the centre of its arc; None: it is straight.

    Ends have three decimals; with as many in `to_centre` an arc's end is 0.002 mm off its circle at most.
    """

    end: tuple[float, float]
    to_centre: tuple[float, float] | None = None
    clockwise: bool = False


def written(stroke: Stroke) -> Iterator[Written]:
    """The moves from the stroke's first point on, in three decimals; those that do not show in them are left out.

    No arc of a toolpath is a whole turn, and one that has shrunk to nothing would be read as one.
    """
    moves = stroke.moves or [Line((x_mm, y_mm)) for x_mm, y_mm in stroke.points[1:].tolist()]
    first_x_mm, first_y_mm = stroke.points[0].tolist()
    at = _rounded((first_x_mm, first_y_mm))
    for move in moves:
        end = _rounded(move.end)
        if end == at:
            continue
        if isinstance(move, Arc):
            yield Written(end, (move.centre[0] - at[0], move.centre[1] - at[1]), move.clockwise)
        else:
            yield Written(end)
        at = end


def pen_change(toolpath: Toolpath, stroke: int, *lines: str, note: str = "") -> list[ProgramLine]:
    """What is said before the pen of this stroke is put in: `lines` park the machine, then it waits; mostly nothing.

    They belong to the stroke before: a program that goes on from this one begins with its pen. note: behind the stop.
    """
    if not stroke or stroke not in toolpath.passes:
        return []
    return [ProgramLine(text, stroke - 1) for text in (*lines, f"{PEN_CHANGE} {note}".rstrip())]


def _rounded(place: tuple[float, float]) -> tuple[float, float]:
    return round(place[0], _DECIMALS), round(place[1], _DECIMALS)
