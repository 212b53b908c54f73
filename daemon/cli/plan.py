"""`linedrawd plan`: what would be drawn, without a machine."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable
from contextlib import closing
from pathlib import Path
from typing import Any

from daemon.cli.options import add_page, add_places, add_which, page_of, settings_of
from daemon.errors import LinedrawError
from daemon.jobs.arrival import keep_page
from daemon.jobs.folder import make_folder, warnings_of
from daemon.jobs.pool import Pool

EXAMPLES = """examples:
  linedrawd plan house.png -o plans          # plans/house/{drawing.svg,program.gcode,preview.png,...}
  linedrawd plan plan.pdf --page 2 -o plans  # plans/plan-page-2
  linedrawd plan scans/*.png -o plans        # one folder each; the exit code is 1 if some of them failed
"""


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser(
        "plan",
        help="plan pictures without a machine",
        description="Write what would be drawn, for each picture into a folder of its own: strokes.json, drawing.svg, "
        "program.gcode, preview.png, explain.png, report.json.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("pictures", nargs="+", metavar="PICTURE", type=Path)
    parser.add_argument("-o", "--output", metavar="DIR", type=Path, required=True, help="made where it is missing")
    parser.add_argument(
        "--explain", action="store_true", help="write explain.json, too: why each edge was kept or refused"
    )
    add_page(parser)
    add_which(parser)
    add_places(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """0 when all are planned, 1 when some are not; those are named on stderr."""
    settings = settings_of(args, one_machine=True)
    (machine,) = settings.machines
    if args.explain:
        planning = settings.planning.model_copy(update={"explain": True})
        settings = settings.model_copy(update={"planning": planning})
    failed = 0
    with closing(Pool(settings)) as pool:
        for picture, folder in _folders(args.pictures, args.output.absolute(), args.page):
            try:
                _check_exists(picture)
                make_folder(folder)
                keep_page(folder, page_of(args, picture))
                pool.plan(picture.absolute(), folder, machine, name=str(picture), progress=lambda _: None)
            except LinedrawError as error:
                failed += 1
                named = str(error).startswith(str(picture))
                print(error if named else f"{picture}: {error}", file=sys.stderr)
            else:
                print(f"{picture} -> {folder}")
                for words in warnings_of(folder):
                    print(f"{picture}: warning: {words}", file=sys.stderr)
    return 1 if failed else 0


def _check_exists(picture: Path) -> None:
    if not picture.is_file():
        raise LinedrawError("there is no such file: give the path of a picture")


def _folders(pictures: Iterable[Path], output: Path, page: int | None) -> Iterable[tuple[Path, Path]]:
    """Each picture and its folder: its stem, numbered where two pictures of this call share it, and its page."""
    used: set[str] = set()
    for picture in pictures:
        name, number = picture.stem, 1
        while name in used:
            number += 1
            name = f"{picture.stem}-{number}"
        used.add(name)
        yield picture, output / (name if page is None else f"{name}-page-{page}")
