"""A Dobot Magician by its settings."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from daemon.config import DobotMachine
from daemon.jobs.moves import HOME_DOBOT, DobotMoves, homed_first
from daemon.machine.open import Conversation, OpenedMachine, Record, open_machine
from daemon.machine.ports import find_dobot, named
from daemon.machine.serial_port import Framing, adapters
from daemon.machine.simulated import simulator_by
from daemon.program.dobot import write_dobot
from daemon.shapes import Program, Toolpath
from firmware_protocol.dobot.session import DobotSession
from firmware_protocol.dobot.simulator.forecast import line_times_s
from firmware_protocol.dobot.simulator.options import simulator_from
from firmware_protocol.dobot.simulator.simulator import DobotSimulator
from firmware_protocol.ink import PenRule
from firmware_protocol.session import Event
from firmware_protocol.simulator import Simulator

_FEED = (
    "nobody has documented whether an arm changes the speed of commands that are in its queue: "
    "stop it, and set another draw_mm_s"
)
_TOUCHES_WITHIN_MM = 0.05
"""A simulated pen is on the sheet this far above its height: joint angles are no round numbers."""


def program_of(toolpath: Toolpath, machine: DobotMachine, name: str) -> Program:
    program = write_dobot(
        toolpath,
        sheet_origin_mm=machine.sheet_origin_mm,
        up_mm=machine.pen.up_mm,
        down_mm=machine.pen.down_mm,
        draw_mm_s=machine.draw_mm_s,
        straight=machine.straight,
    )
    return homed_first(program, HOME_DOBOT) if machine.home == "job" else program


def times_s(lines: list[str]) -> list[float]:
    return line_times_s(lines)


def opened(
    machine: DobotMachine, hear: Callable[[Event], None], *, still: bool, record: Record
) -> OpenedMachine[DobotSession]:
    return open_machine(
        find_dobot(adapters()) if machine.url == "auto" else named(machine.url, adapters),
        conversation(machine, still=still),
        # An asserted line can reset the arm's controller, or start its boot loader.
        framing=Framing(machine.baud, dtr=False),
        simulate=lambda: _simulated(machine),
        heard=hear,
        record=record,
    )


def conversation(machine: DobotMachine, *, still: bool) -> Conversation[DobotSession]:
    home = machine.home != "never" and not still
    return Conversation(
        lambda now: DobotSession(now=now, home=home, up_mm=machine.pen.up_mm, sheet_origin_mm=machine.sheet_origin_mm),
        lambda session, lines: line_times_s(lines),
        lambda session, program: [f"firmware: {session.firmware}", f"queue: {session.queue_depth} commands"],
        lift=Program((), 0),
        own_feed=_FEED,
    )


def check(machine: DobotMachine) -> None:
    if machine.simulated:
        _simulated(machine)


def moves_of(machine: DobotMachine) -> DobotMoves:
    return DobotMoves(machine)


def _simulated(machine: DobotMachine) -> Simulator:
    """An arm with its sheet where the settings say, where its URL says nothing else."""
    x_mm, y_mm = machine.sheet_origin_mm
    pen = PenRule(down_at_mm=machine.pen.down_mm + _TOUCHES_WITHIN_MM)

    def simulate(options: Mapping[str, str]) -> DobotSimulator:
        return simulator_from({"origin": f"{x_mm}:{y_mm}", **options}, pen=pen)

    return simulator_by(simulate, machine.url)
