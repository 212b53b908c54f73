"""`linedrawd setup`: what it is told."""

from __future__ import annotations

import argparse
from typing import Any

from daemon.cli.options import add_machine, add_places
from daemon.setup.paper import PAPERS_MM

EXAMPLES = """examples:
  linedrawd setup                                      # asks, shows, writes, and draws a test card
  linedrawd setup --device grbl --paper A4 --yes       # asks nothing: what is not said is usual
  linedrawd setup --device grbl --pen servo --pen-up 200 --pen-down 800 --origin homed --origin-mm=-190x-280
  linedrawd setup --device sim --yes --config try.toml # on a simulated machine
A settings file that is there keeps everything else it says, and a copy of it is kept.
"""


def add_parser(subparsers: Any) -> None:
    words = "the first run: which machine, sheet and pen; then a frame and a test card"
    parser = subparsers.add_parser(
        "setup",
        help=words,
        description="Ask for machine, port, sheet, pen and origin, write the settings, go around the sheet's box with "
        "the pen up, and draw a test card. Each question is an option as well.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    group = parser.add_argument_group("answers")
    group.add_argument("--name", metavar="NAME", help="of the machine's section in the settings")
    group.add_argument("--paper", metavar="SIZE", help=f"{', '.join(PAPERS_MM)}, or as 210x297; 'A4 landscape'")
    group.add_argument("--reach", metavar="WxH", help="how far the machine gets in X and Y, in mm")
    group.add_argument("--pen", choices=["z", "servo"], help="what lifts the pen: the Z axis or a servo")
    group.add_argument("--pen-up", type=float, metavar="N", help="mm of Z, or the servo's S, where it is lifted")
    group.add_argument("--pen-down", type=float, metavar="N", help="where it draws")
    group.add_argument("--origin", choices=["here", "homed"], help="where the pen stands at the start, or switches")
    group.add_argument("--origin-mm", metavar="XxY", help="the sheet's corner on a homed machine")
    group.add_argument("-y", "--yes", action="store_true", help="ask nothing, and take what is usual")
    group.add_argument("--overwrite", action="store_true", help="a settings file that is there may be changed")
    group.add_argument("--no-frame", action="store_true", help="do not go around the box")
    group.add_argument("--no-card", action="store_true", help="do not draw the test card")
    add_machine(parser)
    add_places(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """0 when the settings are written, and the machine did what it was asked. Raises LinedrawError."""
    # numpy is loaded by this command alone: the daemon's own process does without.
    from daemon.cli.first_run import first_run  # noqa: PLC0415

    return first_run(args)
