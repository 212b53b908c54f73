"""`linedrawd preview`: one file that shows what would be drawn, and how."""

from __future__ import annotations

import argparse
from contextlib import closing
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from daemon.cli.options import add_page, add_places, add_which, page_of, settings_of
from daemon.errors import DiskTrouble, LinedrawError
from daemon.jobs.arrival import keep_page
from daemon.jobs.pool import Pool

EXAMPLES = """examples:
  linedrawd preview house.png                # house-preview.html, here
  linedrawd preview house.png -o look.html   # open it in any browser, also on a phone
"""


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser(
        "preview",
        help="show in one file what would be drawn",
        description="Write one HTML file that needs no net: the picture, what was understood of it, how it will be "
        "drawn and how long that takes. Nothing moves.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("picture", metavar="PICTURE", type=Path)
    parser.add_argument(
        "-o", "--output", metavar="FILE", type=Path, help="PICTURE-preview.html in this folder where it is left out"
    )
    add_page(parser)
    add_which(parser)
    add_places(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """0 when the file is written. Raises the LinedrawError that says why not."""
    settings = settings_of(args, one_machine=True)
    (machine,) = settings.machines
    picture: Path = args.picture
    if not picture.is_file():
        raise LinedrawError(f"there is no file {picture}: give the path of a picture")
    file: Path = args.output or Path(f"{picture.stem}-preview.html")
    with closing(Pool(settings)) as pool, TemporaryDirectory(prefix="linedrawd-") as folder:
        keep_page(Path(folder), page_of(args, picture))
        pool.plan(picture.absolute(), Path(folder), machine, name=str(picture), progress=lambda _: None)
        _write(file, (Path(folder) / "preview.html").read_bytes())
    print(f"{picture} -> {file}")
    return 0


def _write(file: Path, page: bytes) -> None:
    try:
        file.write_bytes(page)
    except OSError as error:
        raise DiskTrouble(f"{file} cannot be written ({error.strerror}): give another file with -o") from None
