"""What the settings of a machine mean: its programs, their seconds, and the conversation with it."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

from daemon.config import GrblMachine, Machine, ServoPenSettings, ZPenSettings
from daemon.errors import SettingsError
from daemon.jobs.moves import GrblMoves, Moves
from daemon.jobs.open_machine import OpenMachine
from daemon.jobs.pens import pen_of
from daemon.machine.open import Conversation, open_machine
from daemon.machine.ports import find_grbl
from daemon.machine.serial_port import Framing, adapters
from daemon.program.gcode import lift_lines, write_gcode
from daemon.program.paper import write_paper
from daemon.shapes import Program, ProgramLine, Toolpath
from daemon.usb import inventory
from firmware_protocol.grbl.session import GrblSession
from firmware_protocol.grbl.simulator.planner import line_times_s
from firmware_protocol.ink import PenRule
from firmware_protocol.session import Event

HOME = "$H"


def program_of(toolpath: Toolpath, machine: Machine, name: str) -> Program:
    """The toolpath in the language of this machine. name: of the picture; some controls show it.

    Raises LinedrawError where the machine cannot draw it.
    """
    match machine:
        case GrblMachine():
            return _grbl_program(toolpath, machine)
    raise _unknown(machine)


def seconds_of(program: Program, machine: Machine) -> float:
    """How long the program takes on a machine with usual speeds and accelerations; 0 where nothing is known of it."""
    lines = [line.text for line in program.lines]
    match machine:
        case GrblMachine():
            return line_times_s([line for line in lines if line != HOME])[-1]
    raise _unknown(machine)


def opened(machine: Machine, hear: Callable[[Event], None], still: bool) -> OpenMachine:
    """The machine, its port open and nothing said yet; `still`: nothing moves by itself, so it is not homed.

    Raises NoMachine and SettingsError.
    """
    match machine:
        case GrblMachine():
            return open_machine(
                machine.url if machine.url != "auto" else find_grbl(adapters(), on_usb=inventory().ids),
                _grbl(machine, home=machine.home != "never" and not still),
                framing=Framing(machine.baud),
                touches=touches(machine),
                heard=hear,
            )
    raise _unknown(machine)


def moves_of(machine: Machine) -> Moves:
    """What a person may have it do between jobs."""
    match machine:
        case GrblMachine():
            return GrblMoves(machine)
    raise _unknown(machine)


def touches(machine: GrblMachine) -> PenRule:
    """When the pen of the simulated machine is on the sheet."""
    pen = machine.pen
    if isinstance(pen, ZPenSettings):
        return PenRule(down_at_mm=pen.down_mm, up_is_minus=pen.up_mm < pen.down_mm)
    assert isinstance(pen, ServoPenSettings)
    return PenRule(down_s=pen.down_s, up_s=pen.up_s)


def _grbl_program(toolpath: Toolpath, machine: GrblMachine) -> Program:
    if machine.dialect == "paper":
        program = write_paper(toolpath, units=machine.units, draw_mm_s=machine.draw_mm_s)
    else:
        program = write_gcode(toolpath, pen=pen_of(machine), draw_mm_s=machine.draw_mm_s)
    if machine.home != "job":
        return program
    return Program((ProgramLine(HOME), *program.lines), program.strokes)


def _grbl(machine: GrblMachine, *, home: bool) -> Conversation[GrblSession]:
    return Conversation(
        lambda now: GrblSession(
            now=now,
            flow=machine.flow,
            lift=lift_lines(pen_of(machine)),
            lift_after_restart=machine.lift_after_restart,
            home=home,
        ),
        _grbl_times,
        _grbl_check,
        # Every job ends with the pen up, one without lines too.
        lift=Program((), 0) if machine.lift_after_restart else None,
        moved=_moved if machine.origin == "here" else None,
    )


def _grbl_check(session: GrblSession) -> Sequence[str]:
    settings = (f"${number}={value:g}" for number, value in sorted(session.settings.items()))
    return [f"firmware: {session.firmware}", *settings]


def _moved(line: str, by_mm: tuple[float, float]) -> str:
    """Relative moves (G91) stay what they are."""
    if "G91" in line:
        return line
    more_mm = dict(zip("XY", by_mm, strict=True))
    return re.sub(r"([XY])(-?[\d.]+)", lambda found: f"{found[1]}{float(found[2]) + more_mm[found[1]]:.3f}", line)


def _grbl_times(session: GrblSession, lines: Sequence[str]) -> Sequence[float]:
    """Homing takes no time: nobody knows from where it begins."""
    skipped = 1 if lines and lines[0] == HOME else 0
    return [0.0] * skipped + line_times_s(lines[skipped:], session.settings)


def _unknown(machine: Machine) -> SettingsError:
    return SettingsError(f"device {machine.device} is not driven by this version: say device = 'grbl'")
