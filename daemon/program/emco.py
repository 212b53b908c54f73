"""A toolpath as a program for the control of an EMCO Concept Mill 250."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TypeAlias

from daemon.errors import OutOfReach, SettingsError
from daemon.program.gcode import ZPen
from daemon.program.moves import Written, pen_change, written
from daemon.shapes import Program, ProgramLine, Stroke, Toolpath
from firmware_protocol.emco.blocks import arc, number, rapid, straight
from firmware_protocol.emco.dialects import DIALECTS, RAPID_MM_MIN, TRAVEL_MM, Dialect, DialectName
from firmware_protocol.errors import LocalProtocolError

Place: TypeAlias = tuple[float, float]

_END = ("M5", "M9", "M30")
"""One M word a block, as many controls want it. M5 and M9: no spindle and no coolant, whatever was on before."""


def write_emco(toolpath: Toolpath, *, dialect: DialectName, name: str, pen: ZPen, draw_mm_s: float) -> Program:
    """Head; lift; for each stroke travel, lower, draw, lift; park; M5, M9, M30. Where the pen is changed: park, M0.

    name: of the program, in capitals; `Dialect.name_from` makes one. Positions in mm with at most 3 decimals, always
    with a point; every block states both of its coordinates. The program chooses no tool, starts no spindle and no
    coolant, and has no block numbers (a control counts them to 9999 at most). G54 must put X0 Y0 at the sheet's
    origin and Z0 at its surface. Arcs are G2 and G3 with I and J counted from their start; rounding leaves their ends
    0.002 mm off their circles at most, and none is a whole turn. Raises OutOfReach, naming the first stroke for which
    the travel of the axes does not suffice wherever G54 lies; SettingsError for a name or a speed that the control
    does not take; ValueError when draw_mm_s or the pen's plunge_mm_s is not positive.
    """
    if draw_mm_s <= 0 or pen.plunge_mm_s <= 0:
        raise ValueError(f"a pen cannot be moved at draw_mm_s = {draw_mm_s} with {pen}: give speeds above 0")
    _check_speeds(draw_mm_s=draw_mm_s, plunge_mm_s=pen.plunge_mm_s)
    _check_travel(toolpath, pen)
    spoken = DIALECTS[dialect]
    lines = [ProgramLine(text) for text in (*_head(spoken, name), *lift_lines(dialect, pen))]
    for index, stroke in enumerate(toolpath.strokes):
        note = spoken.note(f"{toolpath.passes.get(index, '')} PEN".upper())
        lines += pen_change(toolpath, index, _rapid(toolpath.park_mm), note=note)
        lines += [ProgramLine(text, index) for text in _stroke(stroke, pen, draw_mm_s)]
    end = (_rapid(toolpath.park_mm), *_END, *spoken.tail)
    return Program((*lines, *map(ProgramLine, end)), len(toolpath.strokes), toolpath.passes)


def lift_lines(dialect: DialectName, pen: ZPen) -> tuple[str, ...]:
    """Blocks that raise the pen whatever was programmed before."""
    return (f"G90 G17 {DIALECTS[dialect].metric} G94 G64", f"G54 {rapid(z=pen.up_mm)}")


def stop_lines(dialect: DialectName, pen: ZPen) -> tuple[str, ...]:
    """What ends a program that was broken off: the pen is raised, and the control knows that no more comes."""
    return (*lift_lines(dialect, pen), *_END, *DIALECTS[dialect].tail)


def _head(spoken: Dialect, name: str) -> tuple[str, ...]:
    try:
        return spoken.head(name)
    except LocalProtocolError as error:
        raise SettingsError(str(error)) from error


def _stroke(stroke: Stroke, pen: ZPen, draw_mm_s: float) -> Iterator[str]:
    """Each block of one stroke, from the travel to it to the lifted pen. A stroke of one point is a dot."""
    x_mm, y_mm = stroke.points[0].tolist()
    yield _rapid((x_mm, y_mm))
    yield straight(z=pen.down_mm, feed_mm_min=60 * pen.plunge_mm_s)
    feed = f" F{number(60 * draw_mm_s)}"
    for block in map(_block, written(stroke)):
        yield block + feed
        feed = ""
    yield rapid(z=pen.up_mm)


def _block(move: Written) -> str:
    if move.to_centre is None:
        return straight(x=move.end[0], y=move.end[1])
    return arc(move.end, move.to_centre, clockwise=move.clockwise)


def _rapid(place: Place) -> str:
    return rapid(x=place[0], y=place[1])


def _check_speeds(**speeds_mm_s: float) -> None:
    for name, mm_s in speeds_mm_s.items():
        if 60 * mm_s > RAPID_MM_MIN:
            raise SettingsError(
                f"{name} = {mm_s:g} is more than the machine's {RAPID_MM_MIN / 60:g} mm/s: make it smaller"
            )


def _check_travel(toolpath: Toolpath, pen: ZPen) -> None:
    """Where G54 lies is the control's to know, so what is checked is the room that everything together takes."""
    if max(pen.up_mm, pen.down_mm, 0.0) - min(pen.up_mm, pen.down_mm, 0.0) > TRAVEL_MM[2]:
        raise OutOfReach(
            f"the pen is lifted from {pen.down_mm:g} to {pen.up_mm:g} mm, Z travels {TRAVEL_MM[2]:g}: lift less"
        )
    low, high = [0.0, 0.0], [0.0, 0.0]
    for what, places in _everything(toolpath):
        for axis in (0, 1):
            low[axis] = min(low[axis], *(place[axis] for place in places))
            high[axis] = max(high[axis], *(place[axis] for place in places))
            if high[axis] - low[axis] > TRAVEL_MM[axis] + 1e-6:
                raise OutOfReach(
                    f"with {what} the drawing reaches from {'XY'[axis]} {low[axis]:.1f} to {high[axis]:.1f} mm, the "
                    f"machine travels {TRAVEL_MM[axis]:g} mm: make the box smaller or move it towards the origin"
                )


def _everything(toolpath: Toolpath) -> Iterator[tuple[str, Sequence[Place]]]:
    for index, stroke in enumerate(toolpath.strokes):
        yield f"stroke {index}", [(x_mm, y_mm) for x_mm, y_mm in stroke.points.tolist()]
    yield "the park position", [toolpath.park_mm]
