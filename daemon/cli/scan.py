"""`linedrawd scan`: what lies on the scanner comes into the inbox."""

from __future__ import annotations

import argparse
import signal
from contextlib import closing
from typing import Any

from daemon.cli.options import add_places, settings_of
from daemon.control import NoDaemon, Order, give_order
from daemon.jobs.folder import make_folder
from daemon.jobs.scanning import scanner_of

EXAMPLES = """examples:
  linedrawd scan                      # by the running daemon, as its settings say
  linedrawd scan --scanner sane       # where no daemon runs: the only scanner there is
  linedrawd scan --scanner airscan:e0:Office
Each page of a feeder is a picture of its own. `scanimage -L` lists the scanners, docs/scanner.md tells the settings.
"""


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser(
        "scan",
        help="scan a page, or all in the feeder, into the inbox",
        description="Scan a page, or all in the feeder, into the inbox. The running daemon does it; where none runs, "
        "this command does, and the pages wait in the inbox.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_scanner(parser)
    add_places(parser)
    parser.set_defaults(run=run)


def add_scanner(parser: argparse.ArgumentParser) -> None:
    """Which scanner."""
    words = "sane: the only scanner that SANE finds; or its name, as `scanimage -L` lists it; none"
    parser.add_argument("--scanner", metavar="NAME", default=argparse.SUPPRESS, help=words)


def run(args: argparse.Namespace) -> int:
    """0 when all pages came. Raises the LinedrawError that says why not."""
    # Whatever ends this command ends the scan with it.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    settings = settings_of(args)
    try:
        print(give_order(settings.paths.control, Order(order="scan")))
    except NoDaemon:
        with closing(scanner_of(settings)) as scanner:
            make_folder(settings.paths.inbox)
            print(f"{scanner.scan()} {settings.paths.inbox}, where they wait for a daemon")
    return 0
