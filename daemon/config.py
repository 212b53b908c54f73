"""The settings: one TOML file, the command line and the environment, read here and nowhere else, checked once."""

from __future__ import annotations

import difflib
import os
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, field_validator, model_validator

from daemon.errors import SettingsError
from daemon.places import usual_file, usual_paths

DEFAULT_MACHINE = "plotter"
"""What the machine is called where no file names one."""
SIMULATED_GRBL = "sim://grbl"
_PAPER_UP_MM = -5.0
Positive: TypeAlias = Annotated[float, Field(gt=0)]
PairMm: TypeAlias = tuple[float, float]


class Section(BaseModel):
    """Unknown keys, infinities and later changes are errors."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class Paths(Section):
    """Where everything lies; nothing is written anywhere else."""

    state_dir: Path
    inbox: Path
    log_dir: Path
    runtime_dir: Path

    @property
    def jobs(self) -> Path:
        return self.state_dir / "jobs"

    @property
    def journal(self) -> Path:
        return self.state_dir / "journal.sqlite"

    @property
    def status(self) -> Path:
        return self.runtime_dir / "status.json"

    @property
    def control(self) -> Path:
        return self.runtime_dir / "control.sock"


class Intake(Section):
    settle_s: Annotated[float, Field(ge=0, le=600)] = 1.0
    """How long size and time of a file must stay the same; three times as long where nobody said it was closed."""
    max_megapixels: Positive = 100.0


class Planning(Section):
    """Limits of the worker process, how it reads a page, and whether it says why in explain.json."""

    memory_mb: Annotated[int, Field(ge=128)] = 1024
    time_limit_s: Positive = 300.0
    threads: Annotated[int, Field(ge=1, le=64)] = 1
    ahead: Annotated[int, Field(ge=1)] = 2  # jobs that are planned before the machine is free for them
    graph: Literal["repaired", "paper"] = "repaired"
    explain: bool = False


class Sheet(Section):
    """Where on the sheet a picture is drawn, in mm inwards from the corner where the origin lies, and how exactly."""

    box_mm: tuple[Positive, Positive] = (64.0, 64.0)
    box_origin_mm: PairMm = (25.0, 25.0)
    corner: Literal["lower left", "lower right", "upper left", "upper right"] = "lower left"
    """The sheet's corner where the origin lies; x still runs to the right and y up."""
    size: Literal["fit", "true"] = "fit"
    """"fit": as large as the box; "true": as large as the picture's resolution says, in the middle of the box."""
    margin_mm: Annotated[float, Field(ge=0)] = 0.0
    rotate: Literal[0, 90, 180, 270] = 0
    """Degrees clockwise."""
    mirror: bool = False
    """Left and right exchanged, before it is turned."""
    error_mm: Positive = 0.05

    @model_validator(mode="after")
    def _room_inside_the_margin(self) -> Sheet:
        if 2 * self.margin_mm >= min(self.box_mm):
            raise ValueError(f"margin_mm = {self.margin_mm:g} leaves no room in box_mm: make it smaller")
        return self


class ZPenSettings(Section):
    """The pen hangs on the Z axis; up is +Z, only the paper's own machine has it at Z-5."""

    kind: Literal["z"]
    up_mm: float = 5.0
    down_mm: float = 0.0
    plunge_mm_s: Positive = 10.0


class ServoPenSettings(Section):
    """The pen hangs on a servo driven by the spindle output: `M3 S...`."""

    kind: Literal["servo"]
    up_s: Annotated[float, Field(ge=0)] = 0.0
    """The S word that lifts the pen; a number for the controller, no time."""
    down_s: Annotated[float, Field(ge=0)] = 1000.0
    """The S word that lowers it."""
    dwell_s: Annotated[float, Field(ge=0, le=10)] = 0.2
    """Seconds the servo takes."""


PenSettings: TypeAlias = Annotated[ZPenSettings | ServoPenSettings, Field(discriminator="kind")]


def _known_device(device: Any) -> Any:
    if device in ("emco", "dobot"):
        raise ValueError(f"device '{device}' comes with a later version: this one drives 'grbl'")
    return device


class Machine(Section):
    """One machine. Reach, origin and park are in machine mm; the sheet's lower left corner lies at `origin_mm`."""

    device: Annotated[Literal["grbl"], BeforeValidator(_known_device)] = "grbl"
    url: str = "auto"
    baud: Annotated[int, Field(gt=0)] = 115200
    flow: Literal["count", "line"] = "count"
    reach_mm: tuple[Positive, Positive] = (200.0, 200.0)
    origin: Literal["here", "homed"] = "here"
    origin_mm: PairMm = (0.0, 0.0)
    park_mm: PairMm = (0.0, 0.0)
    draw_mm_s: Annotated[float, Field(gt=0, le=1000)] = 20.0
    resolution_mm: Annotated[float, Field(ge=0, le=1)] = 0.02
    """Shorter moves are not sent: the length of a few steps of the motors."""
    pen: PenSettings = ZPenSettings(kind="z")
    dialect: Literal["grbl", "paper"] = "grbl"
    units: Literal["mm", "cm", "inch"] = "mm"
    """Of a program in the paper's dialect, which does not say its units itself."""
    sheet: Literal["ask", "feed", "auto"] = "auto"
    """"ask": wait for a person after each drawing; "feed": draw on; "auto": feed on a simulated machine, else ask."""
    lift_after_restart: bool = True

    @field_validator("url")
    @classmethod
    def _way_to_a_machine(cls, url: str) -> str:
        url = f"serial://{url}" if url.startswith("/") else url
        if url != "auto" and not url.startswith(("serial:///", "tcp://", "sim://")):
            raise ValueError(
                f"'{url}' is no way to a machine: use auto, serial:///dev/NAME, tcp://HOST:PORT or sim://grbl"
            )
        if url.startswith("sim://") and url.partition("?")[0] != SIMULATED_GRBL:
            raise ValueError(f"'{url}' is not simulated: use {SIMULATED_GRBL}")
        return url

    @model_validator(mode="after")
    def _up_is_above_down(self) -> Machine:
        pen = self.pen
        if isinstance(pen, ZPenSettings) and pen.up_mm <= pen.down_mm and self.dialect != "paper":
            raise ValueError(f"pen.up_mm = {pen.up_mm:g} must be above pen.down_mm = {pen.down_mm:g}")
        return self

    def check_streamable(self) -> None:
        """Raises SettingsError when its programs are files for another machine: they press the pen down or shrink."""
        paper, pen = self.dialect == "paper", self.pen
        if paper and not (isinstance(pen, ZPenSettings) and pen.up_mm == _PAPER_UP_MM):
            raise SettingsError("dialect = 'paper' lifts to Z-5: say pen.up_mm = -5 if that is up, or dialect = 'grbl'")
        if paper and self.units != "mm":
            raise SettingsError(f"units = '{self.units}' is for files, a GRBL counts in mm: say units = 'mm'")

    @property
    def simulated(self) -> bool:
        return self.url.startswith("sim://")

    @property
    def asks_for_sheets(self) -> bool:
        return self.sheet == "ask" or (self.sheet == "auto" and not self.simulated)


class Settings(Section):
    paths: Paths
    intake: Intake = Intake()
    planning: Planning = Planning()
    sheet: Sheet = Sheet()
    machines: dict[Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]{1,32}$")], Machine]

    @field_validator("machines")
    @classmethod
    def _one_machine(cls, machines: dict[str, Machine]) -> dict[str, Machine]:
        if len(machines) != 1:
            raise ValueError(f"{len(machines)} machines are set, this version drives one: keep one [machines.NAME]")
        return machines

    @property
    def machine_name(self) -> str:
        return next(iter(self.machines))


@dataclass(frozen=True, slots=True)
class Options:
    """What the command line says; it wins over the file, the file over the environment."""

    config: Path | None = None
    device: str | None = None
    port: str | None = None
    state_dir: Path | None = None
    inbox: Path | None = None
    log_dir: Path | None = None


def load_settings(
    options: Options, *, environment: Mapping[str, str] = os.environ, machine_needed: bool = False
) -> Settings:
    """Everything that is set, checked. Raises SettingsError, which names the file, the section, the key and the cure.

    machine_needed: a machine must have been named, by `--device`, `--port` or a `[machines.NAME]` section.
    """
    file = options.config or usual_file(environment)
    raw = _read_toml(file) if file else {}
    if machine_needed and not (raw.get("machines") or options.device or options.port):
        raise SettingsError("no machine is set: give --device grbl (or --device sim), or a [machines.NAME] section")
    place = str(file) if file else "settings"
    try:
        return Settings.model_validate(_with_machine(_with_paths(raw, options, environment), options))
    except ValidationError as error:
        raise SettingsError(_explain(error, place)) from None


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
    said = {name: getattr(options, name) or given.get(name) for name in ("state_dir", "inbox", "log_dir")}
    usual = usual_paths(environment, str(said["state_dir"]) if said["state_dir"] else None)
    paths = usual | given | {name: value for name, value in said.items() if value}
    paths.setdefault("inbox", f"{paths['state_dir']}/inbox")
    return raw | {"paths": {name: _absolute(value) for name, value in paths.items()}}


def _absolute(value: Any) -> Any:
    return Path(value).expanduser().absolute() if isinstance(value, str | Path) else value


def _with_machine(raw: dict[str, Any], options: Options) -> dict[str, Any]:
    machines = raw.get("machines") or {DEFAULT_MACHINE: {}}
    said = _said_of_machine(options)
    if not isinstance(machines, dict) or not said:
        return raw | {"machines": machines}
    return raw | {"machines": {name: _merged(machine, said) for name, machine in machines.items()}}


def _merged(machine: Any, said: dict[str, Any]) -> Any:
    return machine | said if isinstance(machine, dict) else machine


def _said_of_machine(options: Options) -> dict[str, Any]:
    said: dict[str, Any] = {"url": options.port} if options.port else {}
    if options.device == "sim":
        return {"device": "grbl", "url": SIMULATED_GRBL} | said
    return said | ({"device": options.device} if options.device else {})


def _explain(error: ValidationError, place: str) -> str:
    return "; ".join(_explain_one(item["loc"], item["type"], item["msg"], place) for item in error.errors())


def _explain_one(loc: tuple[int | str, ...], kind: str, words: str, place: str) -> str:
    *section, key = [str(part) for part in loc] or ["?"]
    where = f"{place}: [{'.'.join(section)}] {key}" if section else f"{place}: {key}"
    if kind == "extra_forbidden":
        known = _known_names(loc)
        near = difflib.get_close_matches(key, known, n=1, cutoff=0.5)
        return f"{where} is unknown: " + (f"did you mean {near[0]}?" if near else f"known are {', '.join(known)}")
    return f"{where}: {words.removeprefix('Value error, ')}"


def _known_names(loc: tuple[int | str, ...]) -> list[str]:
    model: Any = Settings
    match loc:
        case ("machines", _, "pen", kind, _):
            model = ZPenSettings if kind == "z" else ServoPenSettings
        case ("machines", _, _):
            model = Machine
        case (str() as section, _):
            model = Settings.model_fields[section].annotation
    return list(model.model_fields)
