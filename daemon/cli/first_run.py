"""What `linedrawd setup` does: it asks, writes, goes around the box, and draws the test card."""

from __future__ import annotations

import argparse
import os
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal, TypeVar

from daemon.cli.card import attended, draw, only_machine, our_machine, settings_file, write
from daemon.config import DEFAULT_MACHINE, SIMULATED_GRBL, GrblMachine, Options, Settings, load_settings
from daemon.errors import LinedrawError, SettingsError
from daemon.jobs.card import draw_card
from daemon.jobs.devices import moves_of
from daemon.jobs.sheet import box_origin_mm
from daemon.machine.ports import DOBOT_IDS, GRBL_IDS, find_dobot, find_grbl
from daemon.machine.serial_port import adapters
from daemon.setup.edit import Values, lines_of, without_keys
from daemon.setup.first_run import Answers, settings_from
from daemon.setup.paper import PAPERS_MM, paper_mm
from daemon.usb import inventory

T = TypeVar("T")
_DEVICES = {"grbl": "a plotter with GRBL", "emco": "an EMCO Concept Mill", "dobot": "a Dobot Magician",
            "sim": "a simulated plotter"}  # fmt: skip
_PEN = {"z": ("mm of Z", 5.0, 0.0), "servo": ("S of the servo", 0.0, 1000.0)}
_DOBOT_UP_MM = 10.0


def first_run(args: argparse.Namespace) -> int:
    """0 when all of it was done, 1 when a person said that the frame does not lie on the sheet."""
    file = settings_file(args, dict(os.environ))
    asked = _Asked(args, file)
    answers = replace(asked.answers(), shares=asked.others)
    values: Values = settings_from(answers)
    print(f"\n{lines_of(values)}\n")
    if file.exists() and not args.overwrite and not asked.agrees(f"{file} is there: change these keys in it?", no=True):
        raise SettingsError(f"{file} stays as it is: say --overwrite to change it, or --config and another file")
    write(file, values, text=asked.text_for(answers), tell=False)
    settings = _settings(args, file, answers.name)
    if not args.no_frame and not _frame(settings, asked):
        print(f"move the sheet, or change box_origin_mm and box_mm in {file}, and run this again with --overwrite")
        return 1
    if not args.no_card and asked.agrees("draw the test card now?"):
        draw(settings, corrected=False)
    print(_next_steps(args, file))
    return 0


class _Asked:
    """Questions to a person, on the terminal; what is an option already is not asked."""

    def __init__(self, args: argparse.Namespace, file: Path) -> None:
        self._args = args
        self._text = file.read_text(encoding="utf-8") if file.exists() else ""
        try:
            self._machines: dict[str, Any] = tomllib.loads(self._text).get("machines", {})
        except tomllib.TOMLDecodeError as error:
            raise SettingsError(f"{file} is not TOML ({error}): correct that place") from None

    def answers(self) -> Answers:
        name = self._args.name or next(iter(self._machines), DEFAULT_MACHINE)
        said = self._ask("device", f"which machine: {_listed(_DEVICES)}?", "grbl", _one_of(list(_DEVICES)))
        device: Any = "grbl" if said == "sim" else said
        url = SIMULATED_GRBL if said == "sim" else self._url(device)
        kind: Any = self._ask("pen", "what lifts the pen, z or servo?", "z", _one_of(["z", "servo"])) \
            if device == "grbl" else "z"  # fmt: skip
        unit, up, down = _PEN[kind]
        up = _DOBOT_UP_MM if device == "dobot" else up
        pen_up = self._ask("pen_up", f"{unit} where it is lifted?", up, float)
        pen_down = self._ask("pen_down", f"{unit} where it draws?", down, float)
        if device == "dobot":
            return Answers(name, device, url, kind, pen_up, pen_down)
        usual = (200.0, 200.0) if device == "grbl" else (350.0, 250.0)
        reach_mm = self._ask("reach", "how far does it get in X and Y, in mm?", usual, _pair)
        sheet_mm = self._ask(
            "paper", f"which sheet lies under the pen: {', '.join(PAPERS_MM)}, or as 210x297?", paper_mm("A4"), paper_mm
        )
        if device == "emco":
            return Answers(name, device, url, kind, pen_up, pen_down, sheet_mm, reach_mm)
        words = (
            "where does it count from: here (the pen stands on the sheet's lower left corner when linedrawd starts), "
            "or homed (it has limit switches)?"
        )
        origin: Any = self._ask("origin", words, "here", _one_of(["here", "homed"]))
        corner_mm = (0.0, 0.0)
        if origin == "homed":
            words = "where does the sheet's lower left corner lie on the homed machine, X and Y in mm?"
            corner_mm = self._ask("origin_mm", words, corner_mm, _pair)
        return Answers(name, device, url, kind, pen_up, pen_down, sheet_mm, reach_mm, origin, corner_mm)

    @property
    def others(self) -> bool:
        """The file tells of more machines than the one that is set up."""
        return bool(set(self._machines) - {self._args.name or next(iter(self._machines), DEFAULT_MACHINE)})

    def text_for(self, answers: Answers) -> str:
        """The file's text; what it says of a machine or a pen of another kind is put behind a #."""
        old, section, text = self._machines.get(answers.name, {}), f"machines.{answers.name}", self._text
        if old.get("device", "grbl") != answers.device:
            text = without_keys(text, section)
        if old.get("device", "grbl") != answers.device or old.get("pen", {}).get("kind", "z") != answers.pen:
            text = without_keys(text, f"{section}.pen")
        return text

    def agrees(self, question: str, *, no: bool = False) -> bool:
        """no: without an answer it is no."""
        if self._args.yes:
            return not no
        said = _heard(f"{question} [{'y/N' if no else 'Y/n'}] ").lower()
        return said.startswith("y") if said else not no

    def _url(self, device: Literal["grbl", "emco", "dobot"]) -> str:
        if device == "emco":
            return self._ask("port", "how is it reached: file:///FOLDER, serial:///dev/NAME?", "auto", _url)
        if not getattr(self._args, "port", None):
            print(_found(device))
        return self._ask("port", "its port; auto: found by itself each time?", "auto", _url)

    def _ask(self, option: str, question: str, usual: T, read: Callable[[str], T]) -> T:
        given = getattr(self._args, option, None)
        if given is not None:
            return read(f"{given}")
        while not self._args.yes:
            said = _heard(f"{question} [{_shown(usual)}] ")
            if not said:
                break
            try:
                return read(said)
            except (SettingsError, ValueError) as error:
                print(f"  {error}")
        return usual


def _heard(question: str) -> str:
    """What a person types; "" where nobody does."""
    try:
        return input(question).strip()
    except EOFError:
        print()
        return ""


def _found(device: Literal["grbl", "dobot"]) -> str:
    """What looks like it on the USB, in a sentence."""
    ids = GRBL_IDS if device == "grbl" else DOBOT_IDS
    ports = [port for port in adapters() if (port.vid, port.pid) in ids]
    try:
        path = find_grbl(ports, on_usb=inventory().ids) if device == "grbl" else find_dobot(ports)
    except LinedrawError as error:
        return f"  {error}"
    place = next((port.place for port in ports if port.path == path), "?")
    return f"  found: {path}, at USB {place.partition(':')[0]}"


def _frame(settings: Settings, asked: _Asked) -> bool:
    """Whether the box lies on the sheet, as far as anybody has looked."""
    name, machine = only_machine(settings)
    sheet = settings.sheet_of(name)
    (left, bottom), (width, height) = box_origin_mm(sheet, machine), sheet.box_mm
    if machine.device == "emco":
        print("an EMCO goes around no frame: compare the first program with the sheet at its control")
        return True
    if isinstance(machine, GrblMachine) and machine.origin == "here":
        print("put the pen above the sheet's lower left corner now, its tip just clear of the sheet")
    if not asked.agrees(f"go around the box of {width:g} x {height:g} mm with the pen up?"):
        return True
    corners = [(left, bottom), (left + width, bottom), (left + width, bottom + height), (left, bottom + height)]
    program = moves_of(machine).travel([*corners, corners[0], machine.park_mm])
    with our_machine(settings) as found:
        attended(found, lambda: draw_card([program], found))
    return asked.agrees("did the pen stay above the sheet?")


def _settings(args: argparse.Namespace, file: Path, name: str) -> Settings:
    given = (key for key in ("state_dir", "log_dir", "inbox") if getattr(args, key, None))
    folders: dict[str, Any] = {key: Path(getattr(args, key)) for key in given}
    return load_settings(Options(config=file, machine=name, **folders), one_machine=True)


def _next_steps(args: argparse.Namespace, file: Path) -> str:
    said = f" --config {file}" if getattr(args, "config", None) else ""
    return (
        "\nnext:\n"
        f"  linedrawd doctor{said}   # looks at everything\n"
        f"  linedrawd calibrate SCAN.png{said}   # a scan of the card tells what the machine does wrong\n"
        f"  linedrawd{said}   # draws what is dropped into the inbox; the service: sudo systemctl start linedrawd"
    )


def _listed(names: dict[str, str]) -> str:
    return ", ".join(f"{name} ({words})" for name, words in names.items())


def _one_of(names: Sequence[str]) -> Callable[[str], str]:
    def read(said: str) -> str:
        if said not in names:
            raise SettingsError(f"'{said}' is none of {', '.join(names)}: say one of them")
        return said

    return read


def _pair(said: str) -> tuple[float, float]:
    try:
        x, y = (float(part) for part in said.lower().replace(",", "x").split("x"))
    except ValueError:
        raise SettingsError(f"'{said}' is no pair: write it as 200x150") from None
    return x, y


def _url(said: str) -> str:
    return f"serial://{said}" if said.startswith("/") else said


def _shown(usual: object) -> str:
    return "x".join(f"{part:g}" for part in usual) if isinstance(usual, tuple) else f"{usual}"
