"""What a device can be moved to do without a drawing, as programs without strokes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol, TypeAlias

from daemon.config import DobotMachine, GrblMachine
from daemon.errors import LinedrawError
from daemon.jobs.pens import pen_of
from daemon.program.gcode import lift_lines, lower_lines
from daemon.shapes import Program, ProgramLine
from firmware_protocol.dobot.commands import MOVL_XYZ
from firmware_protocol.dobot.kinematics import Reach
from firmware_protocol.ink import Vector

PointMm: TypeAlias = tuple[float, float]
HOME_GRBL, HOME_DOBOT = "$H", "HOME 0"
"""The line that finds the home of each."""


def homed_first(program: Program, home: str) -> Program:
    """The program with the line before it that finds the machine's home."""
    return replace(program, lines=(ProgramLine(home), *program.lines))


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
        self._machine, self._pen = machine, pen_of(machine.pen)

    def home(self) -> Program:
        if self._machine.home == "never":
            raise LinedrawError("homing is switched off in the settings: say home = 'start' in [machines.NAME]")
        return _program(HOME_GRBL)

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


class DobotMoves:
    """In commands for the arm's queue. `at_mm` and points are in mm of the sheet, heights those of the arm."""

    def __init__(self, machine: DobotMachine) -> None:
        self._machine, self._reach = machine, Reach.between(machine.pen.down_mm, machine.pen.up_mm)

    def home(self) -> Program:
        return _program(HOME_DOBOT)

    def travel(self, points_mm: Sequence[PointMm]) -> Program:
        return _program(*(self._to(point, self._machine.pen.up_mm) for point in points_mm))

    def jog(self, by_mm: PointMm, at_mm: Vector | None) -> Program:
        x_mm, y_mm = _known(at_mm)
        return self.travel([(x_mm + by_mm[0], y_mm + by_mm[1])])

    def pen_up(self, at_mm: Vector | None) -> Program:
        return self.travel([_known(at_mm)])

    def pen_down(self, seconds: float, at_mm: Vector | None) -> Program:
        place, pen = _known(at_mm), self._machine.pen
        return _program(
            self._to(place, pen.up_mm),
            self._to(place, pen.down_mm),
            f"WAIT {round(1000 * seconds)}",
            self._to(place, pen.up_mm),
        )

    def check_origin(self, at_mm: Vector) -> None:
        x_mm, y_mm = self._on_arm((at_mm[0], at_mm[1]))
        raise LinedrawError(
            f"an arm knows its own place, and the pen stands at ({x_mm:g}, {y_mm:g}) mm of it: "
            f"write sheet_origin_mm = [{x_mm:g}, {y_mm:g}] into [machines.NAME] and start again"
        )

    def _on_arm(self, place: PointMm) -> PointMm:
        return place[0] + self._machine.sheet_origin_mm[0], place[1] + self._machine.sheet_origin_mm[1]

    def _to(self, place: PointMm, height_mm: float) -> str:
        target = self._on_arm(place)
        if self._reach is None or not self._reach.holds(target, target):
            raise LinedrawError(
                f"({place[0]:g}, {place[1]:g}) mm of the sheet is out of the arm's reach: choose another place"
            )
        return f"PTP {MOVL_XYZ} {target[0]:.3f} {target[1]:.3f} {height_mm:.3f} 0.000"


class NoMoves:
    """Of a machine that takes whole programs only; `why` says what to do instead."""

    def __init__(self, why: str) -> None:
        self._why = why

    def home(self) -> Program:
        raise LinedrawError(self._why)

    def travel(self, points_mm: Sequence[PointMm]) -> Program:
        raise LinedrawError(self._why)

    def jog(self, by_mm: PointMm, at_mm: Vector | None) -> Program:
        raise LinedrawError(self._why)

    def pen_up(self, at_mm: Vector | None) -> Program:
        raise LinedrawError(self._why)

    def pen_down(self, seconds: float, at_mm: Vector | None) -> Program:
        raise LinedrawError(self._why)

    def check_origin(self, at_mm: Vector) -> None:
        raise LinedrawError(self._why)


def homing(moves: Moves) -> Sequence[ProgramLine]:
    """The lines that find the machine's home; none where it has no such."""
    try:
        return moves.home().lines
    except LinedrawError:
        return ()


def _known(at_mm: Vector | None) -> PointMm:
    if at_mm is None:
        raise LinedrawError("the machine does not say where its pen stands: home it first")
    return at_mm[0], at_mm[1]


def _program(*lines: str) -> Program:
    return Program(tuple(map(ProgramLine, lines)), 0)
