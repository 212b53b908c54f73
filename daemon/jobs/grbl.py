"""A GRBL controller by its settings."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

from daemon.config import GrblMachine, ZPenSettings
from daemon.jobs.moves import HOME_GRBL, GrblMoves, homed_first
from daemon.jobs.pens import pen_of
from daemon.machine.open import Conversation, OpenedMachine, Record, open_machine
from daemon.machine.ports import find_grbl, named
from daemon.machine.serial_port import Framing, adapters
from daemon.machine.simulated import simulator_of
from daemon.program.gcode import lift_lines, write_gcode
from daemon.program.paper import write_paper
from daemon.shapes import Program, Toolpath
from daemon.usb import inventory
from firmware_protocol.grbl.habits import Patience
from firmware_protocol.grbl.sentences import MOTORS_OFF
from firmware_protocol.grbl.session import GrblSession
from firmware_protocol.grbl.simulator.planner import line_times_s
from firmware_protocol.grbl.states import State
from firmware_protocol.ink import PenRule
from firmware_protocol.session import Event


def program_of(toolpath: Toolpath, machine: GrblMachine, name: str) -> Program:
    if machine.dialect == "paper":
        program = write_paper(toolpath, units=machine.units, draw_mm_s=machine.draw_mm_s)
    else:
        program = write_gcode(toolpath, pen=pen_of(machine.pen), draw_mm_s=machine.draw_mm_s)
    return homed_first(program, HOME_GRBL) if machine.home == "job" else program


def times_s(lines: list[str]) -> list[float]:
    return _times(lines, {})


def opened(
    machine: GrblMachine, hear: Callable[[Event], None], *, still: bool, record: Record
) -> OpenedMachine[GrblSession]:
    return open_machine(
        find_grbl(adapters(), on_usb=inventory().ids) if machine.url == "auto" else named(machine.url, adapters),
        conversation(machine, still=still),
        framing=Framing(machine.baud),
        simulate=lambda: simulator_of(machine.url, pen=touches(machine)),
        heard=hear,
        record=record,
    )


def check(machine: GrblMachine) -> None:
    if machine.simulated:
        simulator_of(machine.url)


def moves_of(machine: GrblMachine) -> GrblMoves:
    return GrblMoves(machine)


def touches(machine: GrblMachine) -> PenRule:
    """When the pen of the simulated machine is on the sheet."""
    pen = machine.pen
    if isinstance(pen, ZPenSettings):
        return PenRule(down_at_mm=pen.down_mm, up_is_minus=pen.up_mm < pen.down_mm)
    return PenRule(down_s=pen.down_s, up_s=pen.up_s)


def moved(line: str, by_mm: tuple[float, float]) -> str:
    """The line with other places; relative moves (G91) stay what they are."""
    if "G91" in line:
        return line
    more_mm = dict(zip("XY", by_mm, strict=True))
    return re.sub(r"([XY])(-?[\d.]+)", lambda found: f"{found[1]}{float(found[2]) + more_mm[found[1]]:.3f}", line)


def conversation(machine: GrblMachine, *, still: bool) -> Conversation[GrblSession]:
    return Conversation(
        lambda now: GrblSession(
            now=now,
            flow=machine.flow,
            lift=lift_lines(pen_of(machine.pen)),
            lift_after_restart=machine.lift_after_restart,
            home=machine.home != "never" and not still,
            may_set=machine.may_set,
            dry_run=machine.dry_run,
            patience=Patience(motors_off_after_min=machine.motors_off_after_min),
        ),
        lambda session, lines: _times(lines, session.settings),
        _told,
        # Every job ends with the pen up, one without lines too.
        lift=Program((), 0) if machine.lift_after_restart else None,
        moved=moved if machine.origin == "here" else None,
        home=lambda session, now: session.home(now),
        rests=lambda session: MOTORS_OFF if session.state is State.RESTED else "",
    )


def _times(lines: Sequence[str], settings: dict[int, float]) -> list[float]:
    """Homing takes no time: nobody knows from where it begins."""
    skipped = 1 if lines and lines[0] == HOME_GRBL else 0
    return [0.0] * skipped + line_times_s(lines[skipped:], settings)


def _told(session: GrblSession, program: Program) -> Sequence[str]:
    """Firmware, findings with their cures, and the settings."""
    wanted = [f"wanted otherwise: {each.why}" for each in session.findings(program.lines)]
    settings = (f"${number}={value:g}" for number, value in sorted(session.settings.items()))
    return [f"firmware: {session.firmware}", *(wanted or ["nothing is wanted otherwise"]), *settings]
