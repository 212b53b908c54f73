"""`linedrawd simulate`: a simulated machine for any sender."""

from __future__ import annotations

import argparse
import os
import signal
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import parse_qsl, urlsplit

from daemon.cli import simulate_ctl
from daemon.errors import SettingsError
from daemon.machine.pseudo_terminal import serve, write_ink
from daemon.machine.simulated import simulator_of
from firmware_protocol.dobot.simulator.options import simulator_from as dobot_from
from firmware_protocol.emco.simulator.simulator import simulator_from as emco_from
from firmware_protocol.simulator import Simulator

_MACHINES = {
    "grbl": ("a plotter with GRBL 1.1h", "110=3000&pen_z=0&hang=9"),
    "emco": ("the control of an EMCO Concept Mill that takes programs", "dialect=fanuc&buffer=256"),
    "dobot": ("a Dobot Magician", "depth=32&first_index=2"),
}
"""Each with what it is and with options as an example."""
_OTHERS: Mapping[str, Callable[[Mapping[str, str]], Simulator]] = {"emco": emco_from, "dobot": dobot_from}
_EXAMPLE = """examples:
  linedrawd simulate grbl --pty /tmp/plotter --ink /tmp/ink.json &
  linedrawd draw cat.png --device grbl --port /tmp/plotter
  linedrawd simulate ctl /tmp/plotter limit x closed      # somebody presses a switch
  linedrawd simulate ctl /tmp/plotter lose byte 12        # the 13th byte from now on never arrives
"""


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add `simulate` to the commands."""
    parser = subparsers.add_parser(
        "simulate",
        help="serve a simulated machine on a pseudo terminal",
        description="Serve a simulated machine in real time until SIGTERM or Ctrl-C. Each opening of the pseudo "
        "terminal resets a GRBL, as opening the port of an Arduino does.",
        epilog=_EXAMPLE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    machines = parser.add_subparsers(required=True, metavar="|".join([*_MACHINES, "ctl"]))
    for machine, (words, options) in _MACHINES.items():
        _add_machine(machines, machine, words, options)
    simulate_ctl.add_parser(machines)


def _add_machine(
    machines: argparse._SubParsersAction[argparse.ArgumentParser], machine: str, words: str, options: str
) -> None:
    parser = machines.add_parser(
        machine, help=words, epilog=_EXAMPLE, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--pty", required=True, type=Path, metavar="LINK", help="symbolic link to the pseudo terminal")
    parser.add_argument("--ink", type=Path, metavar="FILE", help="write what was drawn there at the end, as JSON in mm")
    parser.add_argument(
        "--url",
        default=f"sim://{machine}",
        metavar="URL",
        help=f"settings, pen and faults: sim://{machine}?{options}",
    )
    parser.set_defaults(run=run, machine=machine)


def run(args: argparse.Namespace) -> int:
    """Serve until a signal comes. Returns the exit code. Raises SettingsError and DiskTrouble."""
    simulator = _simulator(args.machine, args.url)
    with _stop_on_signals() as stop_fd:
        print(f"simulated {args.machine} at {args.pty}, Ctrl-C ends it", flush=True)
        serve(simulator, args.pty, stop_fd=stop_fd)
    if args.ink:
        write_ink(args.ink, simulator)
    return 0


def _simulator(machine: str, url: str) -> Simulator:
    if urlsplit(url).netloc != machine:
        raise SettingsError(f"{url} is no simulated {machine}: write sim://{machine}?{_MACHINES[machine][1]}")
    if machine == "grbl":
        return simulator_of(url)
    try:
        return _OTHERS[machine](dict(parse_qsl(urlsplit(url).query, keep_blank_values=True)))
    except ValueError as error:
        raise SettingsError(f"{url}: {error}: write for example {_MACHINES[machine][1]}") from error


@contextmanager
def _stop_on_signals() -> Iterator[int]:
    """A file descriptor that becomes readable on SIGTERM or SIGINT."""
    read_fd, write_fd = os.pipe()
    asked = (signal.SIGTERM, signal.SIGINT)
    before = [signal.signal(number, lambda *_: os.write(write_fd, b"!") and None) for number in asked]
    try:
        yield read_fd
    finally:
        for number, handler in zip(asked, before, strict=True):
            signal.signal(number, handler)
        os.close(read_fd)
        os.close(write_fd)
