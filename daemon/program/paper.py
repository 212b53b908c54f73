"""A toolpath in the form that the paper writes (Raghav et al. 2020, Sec. 3.4)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal, TypeAlias

from daemon.program.moves import pen_change
from daemon.shapes import Program, ProgramLine, Stroke, Toolpath

Units: TypeAlias = Literal["mm", "cm", "inch"]

_MM_PER: dict[Units, float] = {"mm": 1.0, "cm": 10.0, "inch": 25.4}
_AWAY_MM = -5.0
"""On the paper's machine Z falls when the pen leaves the work."""


def write_paper(toolpath: Toolpath, *, units: Units = "mm", draw_mm_s: float = 20.0) -> Program:
    """Disengage; for each stroke the first vertex, engage (`G01 Z0`), the other vertices, disengage (`G00 Z-5`).

    Positions with two decimals in the machine's own units, which the program does not choose: the controller must be
    set to them; the park position has no place in this form. Two things are added so that controllers take it: one F,
    in units a minute, at the head, and M30 at the end. `Z-5` means 5 mm *away from* the work: never send it to a
    machine on which up is +Z.
    """
    per_unit = _MM_PER[units]
    away = f"G00 Z{round(_AWAY_MM / per_unit, 2):g}"
    lines = [ProgramLine(f"F{60 * draw_mm_s / per_unit:.2f}"), ProgramLine(away)]
    for index, stroke in enumerate(toolpath.strokes):
        lines += pen_change(toolpath, index)
        lines += [ProgramLine(text, index) for text in _stroke(stroke, per_unit, away)]
    lines.append(ProgramLine("M30"))
    return Program(tuple(lines), len(toolpath.strokes), toolpath.passes)


def _stroke(stroke: Stroke, mm_per_unit: float, away: str) -> Iterator[str]:
    first, *rest = (
        f"X{_coordinate(x_mm / mm_per_unit)} Y{_coordinate(y_mm / mm_per_unit)}"
        for x_mm, y_mm in stroke.points.tolist()
    )
    yield first
    yield "G01 Z0"
    yield from rest
    yield away


def _coordinate(value: float) -> str:
    return f"{round(value, 2) + 0.0:.2f}"  # + 0.0: no "-0.00"
