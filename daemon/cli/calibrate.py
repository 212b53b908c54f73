"""`linedrawd calibrate`: what it is told."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from daemon.cli.options import add_machine, add_places, add_which
from daemon.setup.paper import PAPERS_MM

EXAMPLES = f"""examples:
  linedrawd calibrate                           # 1. draw the test card, as the machine draws it by itself
  linedrawd calibrate scan.png                  # 2. a scan of it: what is wrong is written into the settings
  linedrawd calibrate --corrected               # 3. draw it again, corrected
  linedrawd calibrate scan2.png --check         # 4. how far its marks still lie off; nothing is written
  linedrawd calibrate photo.jpg --paper A5      # a photo of the whole sheet on a darker table
  linedrawd calibrate photo.jpg --known-mm 60.4 # its frame measured with a ruler, from side to side
A scan says its resolution itself. Scanners err by some tenths of a per cent: where that matters, measure the frame.
Sizes of sheets: {", ".join(PAPERS_MM)}, or WIDTHxHEIGHT in mm.
"""


def add_parser(subparsers: Any) -> None:
    words = "draw the test card; then, with its picture, measure scale, skew and backlash"
    parser = subparsers.add_parser(
        "calibrate",
        help=words,
        description=words[0].upper() + words[1:] + ", and write them into the settings.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("picture", metavar="PICTURE", nargs="?", type=Path, help="a scan or photo of the drawn card")
    parser.add_argument("--known-mm", type=float, metavar="MM", help="how wide the card's frame was measured to be")
    parser.add_argument("--paper", metavar="SIZE", help="the size of the sheet, all of which is in the photo")
    parser.add_argument("--card", metavar="SIZE", help="of the card, if not the one that [sheet] has room for")
    parser.add_argument("--check", action="store_true", help="only tell how far the marks lie off; write nothing")
    parser.add_argument("--corrected", action="store_true", help="draw the card with the corrections that are set")
    add_which(parser)
    add_machine(parser)
    add_places(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """0 when it is drawn or measured. Raises LinedrawError."""
    # OpenCV is loaded by this command alone: the daemon's own process does without.
    from daemon.cli.calibration import calibrate  # noqa: PLC0415

    return calibrate(args)
