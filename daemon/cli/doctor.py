"""`linedrawd doctor`: what stands between a picture and its drawing, and what to do about it."""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Iterator
from contextlib import closing, suppress
from pathlib import Path
from typing import Any

import daemon.models
from daemon.cli import usb
from daemon.cli.options import add_machine, add_places, read_file, settings_of
from daemon.cli.scan import add_scanner
from daemon.config import Machine, Settings
from daemon.control import NoDaemon, NotAllowed, Order, give_order
from daemon.errors import LinedrawError, MachineFault, NoMachine
from daemon.jobs.devices import check, moves_of, opened
from daemon.jobs.open_machine import OpenMachine
from daemon.jobs.pressing import button_of
from daemon.jobs.scanning import scanner_of
from daemon.jobs.sheet import box_origin_mm, reach_low_mm, reach_mm
from daemon.setup import doctor
from daemon.setup.doctor import Finding
from daemon.shapes import Program

EXAMPLES = """examples:
  linedrawd doctor                  # what the settings, the computer and the machine say
  linedrawd doctor --device sim     # the same for a simulated machine
  linedrawd doctor --json | jq '.[] | select(.state == "wrong")'
It asks the running daemon, and opens the port only where none runs, which resets many controllers. Nothing moves.
"""
_SERVICE = Path("/run/linedrawd/control.sock")
_SIGNS = {"ok": "ok", "better": "better", "wrong": "WRONG"}


def add_parser(subparsers: Any) -> None:
    words = "what keeps it from drawing, and what to do about it"
    parser = subparsers.add_parser(
        "doctor",
        help=words,
        description="Look at settings, folders, disk, clock, memory, network, scanner, button, ports and machines, and "
        "say of each that it is ok, or what to do. The exit code is 1 when something is wrong.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--json", action="store_true", help="as one JSON list")
    add_scanner(parser)
    add_machine(parser)
    add_places(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """0 when nothing is wrong, 1 when something is."""
    told = []
    for each in findings(args):
        told.append(each)
        if not args.json:
            print(line_of(each), flush=True)
    if args.json:
        print(doctor.as_json(told))
    return 1 if any(each.state == "wrong" for each in told) else 0


def line_of(finding: Finding) -> str:
    return f"{_SIGNS[finding.state]:6} {finding.name:16} {finding.words}"


def findings(args: argparse.Namespace, *, ask: bool = True) -> Iterator[Finding]:
    """In the order in which a person would look. ask: machines, which resets many a controller where no daemon runs."""
    try:
        settings = settings_of(args)
    except LinedrawError as error:
        yield Finding("settings", "wrong", str(error))
        yield from _computer()
        return
    yield _settings(args, settings)
    yield from _folders(settings)
    yield from _computer()
    yield from doctor.usb_findings(usb.look())
    yield _scanner(settings)
    runs = _runs(settings.paths.control)
    yield _button(settings, runs=runs)
    yield _daemon(settings, runs=runs)
    for name, machine in settings.machines.items() if ask or runs else ():
        yield from _machine(settings, name, machine, runs=runs)


def _settings(args: argparse.Namespace, settings: Settings) -> Finding:
    file = read_file(args)
    machines = ", ".join(f"{name} ({machine.device})" for name, machine in settings.machines.items())
    return Finding("settings", "ok", f"{file or 'no file, so what is usual'}; {machines}")


def _folders(settings: Settings) -> Iterator[Finding]:
    paths = settings.paths
    yield doctor.folder_finding("state", paths.state_dir)
    for name, inbox in settings.inboxes.items():
        yield doctor.folder_finding(f"{name} inbox".strip(), inbox, group=True)
    yield doctor.folder_finding("log", paths.log_dir)
    yield doctor.folder_finding("runtime", paths.runtime_dir)
    yield doctor.disk_finding(paths.state_dir, free_mb=settings.keep.free_mb)
    newest = paths.journal.stat().st_mtime if paths.journal.exists() else 0.0
    yield doctor.clock_finding(time.time(), newest_s=newest)


def _computer() -> Iterator[Finding]:
    yield doctor.memory_finding(Path("/proc/meminfo").read_text(encoding="ascii"))
    yield doctor.network_finding(Path(daemon.models.__file__).parent)


def _scanner(settings: Settings) -> Finding:
    if settings.scanner.kind == "none":
        return Finding("scanner", "ok", "none is set")
    try:
        with closing(scanner_of(settings)) as scanner:
            return Finding("scanner", "ok", scanner.name())
    except LinedrawError as error:
        return Finding("scanner", "wrong", str(error))


def _button(settings: Settings, *, runs: bool) -> Finding:
    """Only opened: nobody has to press it. runs: a daemon does, which has a pin to itself."""
    said = settings.button
    where = f"line {said.line} at {said.chip}" if said.kind == "gpio" else f"{said.path}, key {said.key}"
    button = button_of(said.model_copy(update={"grab": False}))
    if button is None:
        return Finding("button", "ok", "none is set")
    if runs and said.kind == "gpio":
        return Finding("button", "ok", f"{where}; the daemon has it, linedrawd.log tells of its troubles")
    try:
        with closing(button):
            button.open()
    except LinedrawError as error:
        return Finding("button", "wrong", str(error))
    return Finding("button", "ok", where)


def _runs(control: Path) -> bool:
    """Also one that this user may not ask."""
    try:
        with suppress(NotAllowed):
            give_order(control, Order(order="ping"))
    except NoDaemon:
        return False
    return True


def _daemon(settings: Settings, *, runs: bool) -> Finding:
    if runs:
        return Finding(
            "daemon", "ok", f"runs on {settings.paths.state_dir}; {_status(settings).get('words') or 'idle'}"
        )
    if settings.paths.control != _SERVICE and _runs(_SERVICE):
        return Finding(
            "daemon",
            "wrong",
            f"none runs on {settings.paths.state_dir}, but that of the service does and may hold the port: look at "
            "it with `sudo linedrawd doctor`, or end it with `sudo systemctl stop linedrawd`",
        )
    return Finding("daemon", "ok", f"none runs on {settings.paths.state_dir}, so this command asks the machine itself")


def _status(settings: Settings) -> dict[str, Any]:
    try:
        told = json.loads(settings.paths.status.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return told if isinstance(told, dict) else {}


def _machine(settings: Settings, name: str, machine: Machine, *, runs: bool) -> Iterator[Finding]:
    path = machine.url.removeprefix("serial://")
    if path.startswith("/"):
        yield doctor.port_finding(name, path)
    busy = _status(settings).get("machines", {}).get(name, {}) if runs else {}
    if busy.get("job"):
        yield Finding(f"{name} answers", "ok", f"it draws {busy['job']}: ask again when it has")
        return
    try:
        lines = _asked_by_daemon(settings, name) if runs else _asked(machine)
    except LinedrawError as error:
        yield Finding(f"{name} answers", "wrong", str(error))
        lines = []
    else:
        yield from doctor.answer_findings(name, lines)
    yield from _limits(settings, name, machine, lines)


def _asked_by_daemon(settings: Settings, name: str) -> list[str]:
    which = name if len(settings.machines) > 1 else ""
    return give_order(settings.paths.control, Order(order="check", machine=which)).splitlines()


def _asked(machine: Machine) -> list[str]:
    """The port is opened and nothing moves: the machine is not homed."""
    check(machine)
    with closing(opened(machine, lambda event: None, True)) as found:
        try:
            found.connect()
        except (NoMachine, MachineFault):
            if machine.home == "never" or not _introduced(found):
                raise
            # A machine with switches is locked from its start until it is homed, which would move it.
            return [f"firmware: {_introduced(found)}, locked until linedrawd homes it"]
        return list(found.check(Program((), 0)))


def _introduced(found: OpenMachine) -> str:
    """What a controller has said of itself, though it takes no job now."""
    return str(getattr(getattr(found, "session", None), "firmware", None) or "")


def _limits(settings: Settings, name: str, machine: Machine, lines: list[str]) -> Iterator[Finding]:
    sheet = settings.sheet_of(name)
    (left, bottom), (width, height) = box_origin_mm(sheet, machine), sheet.box_mm
    corners = [(left, bottom), (left + width, bottom), (left + width, bottom + height), (left, bottom + height)]
    told = list(doctor.limit_findings(name, lines, reach_mm=reach_mm(machine), needed_mm=corners))
    low, reach = reach_low_mm(sheet, machine), reach_mm(machine)
    inside = all(low[at] <= corner[at] <= low[at] + reach[at] for corner in corners for at in (0, 1))
    size = f"the box of {width:g} x {height:g} mm"
    if not inside:
        words = f"{size} lies beyond reach_mm: make box_mm smaller in [sheet], or correct reach_mm"
        told.insert(0, Finding(f"{name} limits", "wrong", words))
    elif machine.device == "dobot":
        # An arm reaches no rectangle: its own moves know.
        try:
            moves_of(machine).travel(corners)
        except LinedrawError as error:
            told.append(Finding(f"{name} limits", "wrong", f"{size}: {error}"))
    yield from told or [Finding(f"{name} limits", "ok", f"{size} is within reach")]
