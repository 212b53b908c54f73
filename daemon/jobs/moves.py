"""What a device can be moved to do without a drawing, as programs without strokes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, TypeAlias

from daemon.config import GrblMachine
from daemon.errors import LinedrawError
from daemon.jobs.pens import pen_of
from daemon.program.gcode import lift_lines, lower_lines
from daemon.shapes import Program, ProgramLine
from firmware_protocol.ink import Vector

PointMm: TypeAlias = tuple[float, float]


class Moves(Protocol):
    """Programs for a person who stands beside the machine. Each raises LinedrawError where the device has no such."""

    def home(self) -> Program:
        """Find the machine's home."""

    def travel(self, points_mm: Sequence[PointMm]) -> Program:
        """Along these points of the sheet, pen up."""

    def jog(self, by_mm: PointMm, at_mm: Vector | None) -> Program:
        """By so much from where the pen stands, pen up."""

    def pen_up(self, at_mm: Vector | None) -> Program:
        """Lift the pen where it stands."""

    def pen_down(self, seconds: float, at_mm: Vector | None) -> Program:
        """Lower the pen where it stands, for so long: one that is left standing blots."""

    def check_origin(self, at_mm: Vector) -> None:
        """Raises LinedrawError, which says what to write, where the settings say where the sheet's corner lies."""


class GrblMoves:
    """In G-code."""

    def __init__(self, machine: GrblMachine) -> None:
        self._machine, self._pen = machine, pen_of(machine)

    def home(self) -> Program:
        if self._machine.home == "never":
            raise LinedrawError("homing is switched off in the settings: say home = 'start' in [machines.NAME]")
        return _program("$H")

    def travel(self, points_mm: Sequence[PointMm]) -> Program:
        return _program(*lift_lines(self._pen), *(f"G0 X{x_mm:.3f} Y{y_mm:.3f}" for x_mm, y_mm in points_mm))

    def jog(self, by_mm: PointMm, at_mm: Vector | None) -> Program:
        return _program(*lift_lines(self._pen), f"G91 G0 X{by_mm[0]:.3f} Y{by_mm[1]:.3f}", "G90")

    def pen_up(self, at_mm: Vector | None) -> Program:
        return _program(*lift_lines(self._pen))

    def pen_down(self, seconds: float, at_mm: Vector | None) -> Program:
        return _program(*lift_lines(self._pen), *lower_lines(self._pen), f"G4 P{seconds:.2f}")

    def check_origin(self, at_mm: Vector) -> None:
        if self._machine.origin == "homed":
            raise LinedrawError(
                f"this machine counts from its home, and the pen stands at ({at_mm[0]:g}, {at_mm[1]:g}) mm: "
                f"write origin_mm = [{at_mm[0]:g}, {at_mm[1]:g}] into [machines.NAME] and start again"
            )


def _program(*lines: str) -> Program:
    return Program(tuple(map(ProgramLine, lines)), 0)
