"""`linedrawd replay`: a recording of a machine is fed to the session again."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from daemon.jobs.devices import replayed
from daemon.machine.recorder import read_recording
from daemon.machine.replay import Happened, Replay
from firmware_protocol.session import Accepted, Status

_SHOWN_BYTES = 60


def add_parser(subparsers: Any) -> None:
    words = "feed a recording to the session and print what it says about it"
    parser = subparsers.add_parser(
        "replay",
        help=words,
        description=words[0].upper() + words[1:] + ". No machine is needed, and no time passes.",
        epilog="example:\n  linedrawd draw cat.png --device grbl --record plotter.txt\n  linedrawd replay plotter.txt",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("file", metavar="FILE", type=Path, help="written by --record")
    parser.add_argument("-v", "--verbose", action="store_true", help="acknowledged lines and status reports too")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """0 when this version says to the machine what was said then, 1 when it does not. Raises LinedrawError."""
    differences, began_s = 0, None
    for happened in Replay(replayed).run(read_recording(args.file)):
        began_s = happened.at_s if began_s is None else began_s
        differences += happened.differs is not None
        for line in _lines(happened, verbose=args.verbose):
            print(f"{happened.at_s - began_s:10.3f}  {line}")
    print(f"{differences} times something else is said than was" if differences else "the same is said as was")
    return 1 if differences else 0


def _lines(happened: Happened, *, verbose: bool) -> list[str]:
    lines = [str(event) for event in happened.events if verbose or not isinstance(event, Accepted | Status)]
    if happened.differs:
        now, then = (repr(data[:_SHOWN_BYTES]) for data in happened.differs)
        lines.append(f"says {now}, said {then}")
    return lines
