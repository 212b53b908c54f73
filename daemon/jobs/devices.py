"""The table of the devices: what the settings of each mean for its programs and for the conversation with it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol, TypeAlias, TypeVar

from pydantic import TypeAdapter, ValidationError

from daemon.config import AnyMachine, DobotMachine, EmcoMachine, GrblMachine, Machine
from daemon.errors import LinedrawError
from daemon.jobs import dobot, emco, grbl
from daemon.jobs.moves import Moves
from daemon.jobs.open_machine import OpenMachine
from daemon.machine.open import Conversation, Record
from daemon.machine.recorder import Recorder
from daemon.shapes import Program, Toolpath
from firmware_protocol.errors import ProtocolError
from firmware_protocol.session import Event, Session

M_contra = TypeVar("M_contra", bound=Machine, contravariant=True)
Hear: TypeAlias = Callable[[Event], None]


class Device(Protocol[M_contra]):
    """What a module of a device offers."""

    def program_of(self, toolpath: Toolpath, machine: M_contra, name: str) -> Program: ...

    def times_s(self, lines: list[str]) -> list[float]: ...

    def opened(self, machine: M_contra, hear: Hear, *, still: bool, record: Record) -> OpenMachine: ...

    def conversation(self, machine: M_contra, *, still: bool) -> Conversation[Any]: ...

    def check(self, machine: M_contra) -> None: ...

    def moves_of(self, machine: M_contra) -> Moves: ...


DEVICES: dict[type[Machine], Device[Any]] = {GrblMachine: grbl, EmcoMachine: emco, DobotMachine: dobot}


def program_of(toolpath: Toolpath, machine: Machine, name: str) -> Program:
    """The toolpath in the language of this machine. name: of the job, `NUMBER-PICTURE`; some controls show it.

    Raises LinedrawError where the machine cannot draw it.
    """
    return _device(machine).program_of(toolpath, machine, name)


def times_of(program: Program, machine: Machine) -> list[float]:
    """When each line will have been drawn, in s, at usual speeds; empty where the model does not know."""
    try:
        return _device(machine).times_s([line.text for line in program.lines])
    except (ProtocolError, ValueError):
        return []


def seconds_of(program: Program, machine: Machine) -> float:
    """How long the program takes on a machine with usual speeds and accelerations; 0 where the model does not know."""
    return next(reversed(times_of(program, machine)), 0.0)


def opened(
    machine: Machine,
    hear: Hear,
    still: bool,
    recorder: Recorder | None = None,
    turned: Callable[[], None] | None = None,
) -> OpenMachine:
    """The machine, its port open and nothing said yet; `still`: nothing moves by itself, so it is not homed.

    turned: see `Link`. Raises NoMachine and SettingsError.
    """
    record = Record(recorder, {"machine": machine.model_dump(mode="json"), "still": still}, turned)
    return _device(machine).opened(machine, hear, still=still, record=record)


def replayed(settings: dict[str, Any], now: float) -> tuple[Session, Callable[[float], None] | None]:
    """The session that was recorded with these settings, and how it homes. Raises LinedrawError for strange ones."""
    try:
        machine = TypeAdapter[Machine](AnyMachine).validate_python(settings["machine"])
        conversation = _device(machine).conversation(machine, still=bool(settings["still"]))
    except (ValidationError, KeyError, TypeError) as error:
        raise LinedrawError(f"the recording is of another version ({error}): use that version") from None
    session, home = conversation.session(now), conversation.home
    return session, None if home is None else (lambda at_s: home(session, at_s))


def check(machine: Machine) -> None:
    """Raises SettingsError when nothing can be sent to it by these settings; ports are looked for later."""
    machine.check_streamable()
    _device(machine).check(machine)


def moves_of(machine: Machine) -> Moves:
    """What a person may have it do between jobs."""
    return _device(machine).moves_of(machine)


def _device(machine: Machine) -> Device[Any]:
    return DEVICES[type(machine)]
