"""The settings from the file, the command line and the environment, checked once."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, ValidationError, field_validator, model_validator

from daemon.config.button import Button
from daemon.config.explain import explain
from daemon.config.machine import SIMULATED_GRBL, AnyMachine
from daemon.config.paths import Paths, paths_of
from daemon.config.pens import Pens
from daemon.config.scanner import Scanner
from daemon.config.section import Section
from daemon.config.several import check_inboxes, check_ways
from daemon.config.sheet import Intake, Keep, Planning, Sheet
from daemon.errors import SettingsError, unknown
from daemon.places import usual_file

DEFAULT_MACHINE = "plotter"
"""What the machine is called where no file names one."""


class Settings(Section):
    """Everything that can be set."""

    paths: Paths
    intake: Intake = Intake()
    keep: Keep = Keep()
    planning: Planning = Planning()
    sheet: Sheet = Sheet()
    pens: Pens = Pens()
    scanner: Scanner = Scanner(kind="none")
    button: Button = Button(kind="none")
    machines: dict[Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]{1,32}$")], AnyMachine]

    @field_validator("machines")
    @classmethod
    def _told_apart(cls, machines: dict[str, AnyMachine]) -> dict[str, AnyMachine]:
        if not machines:
            raise ValueError("no machine is set: write a [machines.NAME] section")
        check_ways(machines)
        return machines

    @model_validator(mode="after")
    def _inboxes_and_boxes(self) -> Settings:
        check_inboxes(self.inboxes)
        for name in self.machines:
            self.sheet_of(name)
        self.button.check(list(self.machines), scans=self.scanner.kind != "none")
        return self

    @property
    def inboxes(self) -> dict[str, Path]:
        """The folders that pictures are dropped into, by the machine that draws what comes there; "": that of all."""
        own = {name: machine.inbox for name, machine in self.machines.items() if machine.inbox}
        beside = self.paths.inbox.parent
        return {"": self.paths.inbox} | {name: beside / Path(inbox).expanduser() for name, inbox in own.items()}

    @property
    def sharing(self) -> frozenset[str]:
        """The machines that draw what comes in by the inbox of all: those without their own, or all where all have."""
        return frozenset(self.machines) - frozenset(self.inboxes) or frozenset(self.machines)

    def sheet_of(self, machine: str) -> Sheet:
        """The sheet of this machine: as [sheet] says, but for what its own section says."""
        own = self.machines[machine].model_dump(include={"box_mm", "box_origin_mm", "corner"}, exclude_none=True)
        return Sheet.model_validate(self.sheet.model_dump() | own) if own else self.sheet


@dataclass(frozen=True, slots=True)
class Options:
    """What the command line says; it wins over the file, the file over the environment."""

    config: Path | None = None
    device: str | None = None
    port: str | None = None
    state_dir: Path | None = None
    inbox: Path | None = None
    log_dir: Path | None = None
    scanner: str | None = None
    """"sane", "none", or the name of a scanner of SANE's."""
    machine: str | None = None
    """The one machine that is meant, where several are set: there is no other one then."""


def load_settings(
    options: Options,
    *,
    environment: Mapping[str, str] = os.environ,
    machine_needed: bool = False,
    one_machine: bool = False,
) -> Settings:
    """Everything that is set, checked. Raises SettingsError, which names the file, the section, the key and the cure.

    machine_needed: a machine must have been named, by `--device`, `--port` or a `[machines.NAME]` section.
    one_machine: it must be clear which one is meant.
    """
    file = options.config or usual_file(environment)
    raw = _read_toml(file) if file else {}
    if machine_needed and not (raw.get("machines") or options.device or options.port):
        raise SettingsError("no machine is set: give --device grbl (or --device sim), or a [machines.NAME] section")
    place = str(file) if file else "settings"
    try:
        settings = Settings.model_validate(
            _with_scanner(_with_machine(_with_paths(raw, options, environment), options), options)
        )
    except ValidationError as error:
        raise SettingsError(explain(error, place, Settings.model_fields)) from None
    if one_machine and len(settings.machines) > 1:
        raise SettingsError(f"which machine? say --machine and one of {', '.join(settings.machines)}")
    return settings


def _read_toml(file: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise SettingsError(f"{file} cannot be read ({error.strerror}): give another file with --config") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise SettingsError(f"{file} is not TOML ({error}): correct that place") from None


def _with_paths(raw: dict[str, Any], options: Options, environment: Mapping[str, str]) -> dict[str, Any]:
    given = raw.get("paths", {})
    if not isinstance(given, dict):
        return raw
    said = {"state_dir": options.state_dir, "inbox": options.inbox, "log_dir": options.log_dir}
    return raw | {"paths": paths_of(given, said, environment)}


def _with_scanner(raw: dict[str, Any], options: Options) -> dict[str, Any]:
    said, given = options.scanner, raw.get("scanner", {})
    if said is None or not isinstance(given, dict):
        return raw
    wanted = {"kind": said} if said in ("sane", "none") else {"kind": "sane", "device": said}
    return raw | {"scanner": given | wanted}


def _with_machine(raw: dict[str, Any], options: Options) -> dict[str, Any]:
    machines = raw.get("machines") or {DEFAULT_MACHINE: {}}
    if not isinstance(machines, dict):
        return raw | {"machines": machines}
    if options.machine is not None:
        if options.machine not in machines:
            raise SettingsError(unknown(f"the machine {options.machine}", options.machine, list(machines)))
        machines = {options.machine: machines[options.machine]}
        raw = _with_button_of_no_other(raw)
    said = _said_of_machine(options)
    if said and len(machines) > 1:
        raise SettingsError(
            f"--device and --port tell of one machine, {len(machines)} are set ({', '.join(machines)}): "
            "say it in their sections"
        )
    return raw | {"machines": {name: _merged(machine, said) for name, machine in machines.items()}}


def _with_button_of_no_other(raw: dict[str, Any]) -> dict[str, Any]:
    """The button may be that of a machine which is not meant."""
    button = raw.get("button")
    return raw | {"button": button | {"machine": ""}} if isinstance(button, dict) else raw


def _merged(machine: Any, said: dict[str, Any]) -> Any:
    return machine | said if isinstance(machine, dict) else machine


def _said_of_machine(options: Options) -> dict[str, Any]:
    said: dict[str, Any] = {"url": options.port} if options.port else {}
    if options.device == "sim":
        return {"device": "grbl", "url": SIMULATED_GRBL} | said
    return said | ({"device": options.device} if options.device else {})
