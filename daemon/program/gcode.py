"""A toolpath as G-code for GRBL."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeAlias

from daemon.program.moves import Written, pen_change, written
from daemon.shapes import Program, ProgramLine, Stroke, Toolpath


@dataclass(frozen=True, slots=True)
class ZPen:
    """The pen hangs on the Z axis; up is +Z. It is lowered no faster than plunge_mm_s."""

    up_mm: float = 5.0
    down_mm: float = 0.0
    plunge_mm_s: float = 10.0


@dataclass(frozen=True, slots=True)
class ServoPen:
    """The pen hangs on a servo at the spindle output; up_s and down_s are S words, numbers for the controller.

    dwell_s: time that the servo is given to get there.
    """

    up_s: float
    down_s: float
    dwell_s: float = 0.3


Pen: TypeAlias = ZPen | ServoPen

_HEAD = "G21 G90"


def write_gcode(toolpath: Toolpath, *, pen: Pen, draw_mm_s: float) -> Program:
    """Disengage; for each stroke travel, engage, draw, disengage; park, also before M0 where the pen is changed.

    Positions in mm with 3 decimals. Every line states both of its coordinates, so that none depends on what another
    line left; F stands once a stroke, G1, G2 and G3 where they change. Arcs are G2 and G3 with I and J, the way from
    their start to their centre; rounding leaves their ends 0.002 mm off their circles at most, where GRBL refuses
    0.005 (error:33), and none is a whole turn. A stroke of one point is a dot: the pen goes down and up. A servo's turn
    and the dwell behind it share a line: of the words of one the controller takes S and M3 first, then G4 (RS274/NGC,
    order of execution), and moves only in the next. No M2 at the end: GRBL would switch the spindle output, and with
    it a servo, off. Dialect: GRBL 1.1, also taken by grblHAL.
    Raises ValueError when draw_mm_s or the pen's plunge_mm_s is not positive.
    """
    if draw_mm_s <= 0 or (isinstance(pen, ZPen) and pen.plunge_mm_s <= 0):
        raise ValueError(f"a pen cannot be moved at draw_mm_s = {draw_mm_s} with {pen}: give speeds above 0")
    lines = [ProgramLine(_HEAD), *map(ProgramLine, _disengage(pen))]
    park = f"G0 {_position(*toolpath.park_mm)}"
    for index, stroke in enumerate(toolpath.strokes):
        lines += pen_change(toolpath, index, park)
        lines += [ProgramLine(text, index) for text in _stroke(stroke, pen, draw_mm_s)]
    lines.append(ProgramLine(park))
    return Program(tuple(lines), len(toolpath.strokes), toolpath.passes)


def lower_lines(pen: Pen) -> tuple[str, ...]:
    """Lines that put the pen onto the sheet where it stands."""
    return _engage(pen)


def lift_lines(pen: Pen) -> tuple[str, ...]:
    """Lines that raise the pen whatever the controller was told before."""
    return (_HEAD, *_disengage(pen))


def _stroke(stroke: Stroke, pen: Pen, draw_mm_s: float) -> Iterator[str]:
    """Each line of one stroke, from the travel to it to the lifted pen."""
    first_mm: list[float] = stroke.points[0].tolist()
    yield f"G0 {_position(*first_mm)}"
    yield from _engage(pen)
    feed, before = f" F{_number(60 * draw_mm_s)}", ""
    for word, places in map(_words, written(stroke)):
        yield f"{places}{feed}" if word == before else f"{word} {places}{feed}"
        feed, before = "", word
    yield from _disengage(pen)


def _words(move: Written) -> tuple[str, str]:
    """How the pen is moved, and where to."""
    if move.to_centre is None:
        return "G1", _position(*move.end)
    i_mm, j_mm = move.to_centre
    return ("G2" if move.clockwise else "G3"), f"{_position(*move.end)} I{_coordinate(i_mm)} J{_coordinate(j_mm)}"


def _engage(pen: Pen) -> tuple[str, ...]:
    match pen:
        case ZPen(down_mm=down_mm, plunge_mm_s=plunge_mm_s):
            return (f"G1 Z{_coordinate(down_mm)} F{_number(60 * plunge_mm_s)}",)
        case ServoPen(down_s=down_s, dwell_s=dwell_s):
            return (f"M3 S{_number(down_s)} G4 P{_number(dwell_s)}",)


def _disengage(pen: Pen) -> tuple[str, ...]:
    match pen:
        case ZPen(up_mm=up_mm):
            return (f"G0 Z{_coordinate(up_mm)}",)
        case ServoPen(up_s=up_s, dwell_s=dwell_s):
            return (f"M3 S{_number(up_s)} G4 P{_number(dwell_s)}",)


def _position(x_mm: float, y_mm: float) -> str:
    return f"X{_coordinate(x_mm)} Y{_coordinate(y_mm)}"


def _coordinate(value_mm: float) -> str:
    return f"{round(value_mm, 3) + 0.0:.3f}"  # + 0.0: no "-0.000"


def _number(value: float) -> str:
    """Three decimals at most, no exponent: GRBL refuses one."""
    return f"{value:.3f}".rstrip("0").rstrip(".")
