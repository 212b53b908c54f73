"""An EMCO Concept Mill by its settings."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from urllib.parse import urlsplit

from daemon.config import EmcoMachine
from daemon.errors import LinedrawError
from daemon.jobs.moves import NoMoves
from daemon.jobs.open_machine import OpenMachine
from daemon.jobs.pens import z_pen_of
from daemon.machine.file_drop import FileDrop
from daemon.machine.link import Promise, promise_nothing
from daemon.machine.open import Conversation, Record, open_machine
from daemon.machine.ports import named
from daemon.machine.serial_port import Framing, adapters
from daemon.machine.simulated import simulator_by
from daemon.program.emco import stop_lines, write_emco
from daemon.shapes import Program, Toolpath
from firmware_protocol.emco.dialects import DIALECTS
from firmware_protocol.emco.line_format import FORMATS
from firmware_protocol.emco.session import BlockSession, Control, XonXoffSession
from firmware_protocol.emco.simulator.motion import line_times_s
from firmware_protocol.emco.simulator.simulator import EmcoSimulator, simulator_from
from firmware_protocol.ink import PenRule, Vector
from firmware_protocol.session import Ended, Event, Verdict
from firmware_protocol.simulator import Simulator

_WHOLE = "an EMCO takes whole programs only: move it at its control"
_FEED = "the feed of an EMCO is overridden at its control: turn the operator's override switch there"
_PARITY = {"none": "N", "even": "E"}


def program_of(toolpath: Toolpath, machine: EmcoMachine, name: str) -> Program:
    number, _, rest = name.partition("-")
    called = (rest, int(number)) if number.isdecimal() else (name, 1)
    return write_emco(
        toolpath,
        dialect=machine.dialect,
        name=DIALECTS[machine.dialect].name_from(*called),
        pen=z_pen_of(machine.pen),
        draw_mm_s=machine.draw_mm_s,
    )


def times_s(lines: list[str]) -> list[float]:
    return line_times_s(lines)


def opened(machine: EmcoMachine, hear: Callable[[Event], None], *, still: bool, record: Record) -> OpenMachine:
    if machine.link == "file":
        return FileMachine(Path(urlsplit(machine.url).path), heard=hear)
    line = FORMATS[machine.preset]
    return open_machine(
        named(machine.url, adapters),
        conversation(machine, still=still),
        framing=Framing(machine.baud, line.bits, _PARITY[line.parity], line.stop),
        simulate=lambda: _simulated(machine),
        heard=hear,
        record=record,
    )


def conversation(machine: EmcoMachine, *, still: bool) -> Conversation[XonXoffSession | BlockSession]:
    return Conversation(
        lambda now: _session(machine, now),
        lambda session, lines: line_times_s(lines),
        lambda session, program: [
            f"link: {machine.link}, {machine.preset} at {machine.baud} baud; nothing is said back"
        ],
        own_feed=_FEED,
    )


def check(machine: EmcoMachine) -> None:
    if machine.simulated:
        _simulated(machine)


def moves_of(machine: EmcoMachine) -> NoMoves:
    return NoMoves(_WHOLE)


class FileMachine(FileDrop):
    """A folder takes programs, and nothing else that a person may ask of a machine."""

    def draw(self, program: Program, promise: Promise = promise_nothing) -> Ended:
        """The whole program is handed over at once, so all of it is promised first."""
        try:
            promise(program.strokes, 0)
        except LinedrawError as error:
            return Ended(Verdict.STOPPED, 0, 0, position_known=True, pen_lifted=False, why=str(error))
        return super().draw(program)

    @property
    def rests(self) -> str:
        return ""

    def position_mm(self) -> Vector | None:
        return None

    def count_from(self, corner_mm: tuple[float, float]) -> None:
        raise LinedrawError(_WHOLE)

    def home(self, program: Program) -> Ended:
        raise LinedrawError(_WHOLE)

    def check(self, program: Program) -> Sequence[str]:
        return [f"folder: {self.name}; nothing is said back"]

    def lift(self) -> bool:
        return False

    def pause(self, *, at_once: bool) -> None:
        raise LinedrawError("a program that was dropped into a folder cannot be paused from here: use feed hold")

    def resume(self) -> None:
        raise LinedrawError("a program that was dropped into a folder cannot be paused from here: press START")

    def feed(self, percent: int) -> None:
        raise LinedrawError(_FEED)


def _session(machine: EmcoMachine, now: float) -> XonXoffSession | BlockSession:
    control = Control(
        on_stop=stop_lines(machine.dialect, z_pen_of(machine.pen)),
        holds_bytes=machine.holds_bytes,
        holds_blocks=machine.holds_blocks,
    )
    if machine.link == "blocks":
        return BlockSession(
            now=now,
            times=line_times_s,
            ack=machine.ack.encode("latin-1"),
            nak=machine.nak.encode("latin-1"),
            answer_within_s=machine.answer_within_s,
            retries=machine.retries,
            control=control,
        )
    return XonXoffSession(
        now=now,
        times=line_times_s,
        bytes_per_s=FORMATS[machine.preset].bytes_per_s(machine.baud),
        wait_for_xon=machine.wait_for_xon,
        chunk_bytes=machine.chunk_bytes,
        xoff_limit_s=machine.xoff_limit_s,
        control=control,
    )


def _simulated(machine: EmcoMachine) -> Simulator:
    """A control that is set up as the settings say, where its URL says nothing else."""
    usual = {"dialect": machine.dialect, "link": machine.link, "baud": str(machine.baud), "format": machine.preset}
    usual |= {"ack": machine.ack.encode("latin-1").hex(), "nak": machine.nak.encode("latin-1").hex()}
    pen = PenRule(down_at_mm=machine.pen.down_mm)

    def simulate(options: Mapping[str, str]) -> EmcoSimulator:
        return simulator_from({**usual, **options}, pen=pen)

    return simulator_by(simulate, machine.url)
