"""`linedrawd simulate`: a simulated machine for any sender."""

from __future__ import annotations

import argparse
import json
import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from daemon.cli import simulate_ctl
from daemon.errors import DiskTrouble
from daemon.machine.pseudo_terminal import serve
from daemon.machine.simulated import simulator_of

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
        description="Serve a simulated plotter in real time until SIGTERM or Ctrl-C. Each opening of the pseudo "
        "terminal resets it, as opening the port of an Arduino does.",
        epilog=_EXAMPLE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    machines = parser.add_subparsers(required=True, metavar="grbl|ctl")
    _add_machine(machines)
    simulate_ctl.add_parser(machines)


def _add_machine(machines: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = machines.add_parser(
        "grbl",
        help="a plotter with GRBL 1.1h",
        epilog=_EXAMPLE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--pty", required=True, type=Path, metavar="LINK", help="symbolic link to the pseudo terminal")
    parser.add_argument("--ink", type=Path, metavar="FILE", help="write what was drawn there at the end, as JSON in mm")
    parser.add_argument(
        "--url",
        default="sim://grbl",
        metavar="URL",
        help="settings, pen and faults: sim://grbl?110=3000&pen_z=0&hang=9",
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Serve until a signal comes. Returns the exit code. Raises SettingsError and DiskTrouble."""
    simulator = simulator_of(args.url)
    with _stop_on_signals() as stop_fd:
        print(f"simulated GRBL at {args.pty}, Ctrl-C ends it", flush=True)
        serve(simulator, args.pty, stop_fd=stop_fd)
    if args.ink:
        _write_ink(args.ink, simulator.ink)
    return 0


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


def _write_ink(path: Path, polylines: list[list[tuple[float, float]]]) -> None:
    try:
        path.write_text(json.dumps({"polylines_mm": polylines}) + "\n")
    except OSError as error:
        raise DiskTrouble(f"{path} cannot be written ({error.strerror}): choose another place for the ink") from error
