"""Options that many commands share, and the settings they lead to."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from daemon.config import Options, Settings, load_settings
from daemon.errors import SettingsError
from daemon.intake.pages import count_pages
from daemon.places import usual_file

_PATHS = ("config", "state_dir", "inbox", "log_dir")


def add_places(parser: argparse.ArgumentParser) -> None:
    """Where the settings are and where everything lies."""
    group = parser.add_argument_group("places")
    group.add_argument("--config", metavar="FILE", default=argparse.SUPPRESS, help="settings (TOML)")
    group.add_argument("--state-dir", metavar="DIR", default=argparse.SUPPRESS, help="inbox, jobs and journal")
    group.add_argument("--inbox", metavar="DIR", default=argparse.SUPPRESS, help="where pictures are dropped")
    group.add_argument("--log-dir", metavar="DIR", default=argparse.SUPPRESS, help="where linedrawd.log is written")


def add_machine(parser: argparse.ArgumentParser) -> None:
    """Which machine, and how to reach it."""
    group = parser.add_argument_group("machine")
    group.add_argument(
        "--device",
        choices=["grbl", "emco", "dobot", "sim"],
        default=argparse.SUPPRESS,
        help="sim is a simulated grbl; a simulated other one has the port sim://emco or sim://dobot",
    )
    group.add_argument(
        "--port",
        metavar="URL",
        default=argparse.SUPPRESS,
        help="auto, serial:///dev/ttyUSB0, tcp://HOST:PORT, file:///FOLDER (emco), sim://grbl; a bare path is serial",
    )
    group.add_argument("-v", "--verbose", action="store_true", default=argparse.SUPPRESS, help="show the log on stderr")


def add_which(parser: argparse.ArgumentParser, words: str = "which machine, where several are set") -> None:
    """The name of a machine's section."""
    parser.add_argument("--machine", metavar="NAME", default=argparse.SUPPRESS, help=words)


def add_page(parser: argparse.ArgumentParser) -> None:
    """One of the pages of a document."""
    parser.add_argument("--page", metavar="N", type=int, help="of a PDF or TIFF of several pages, from 1 on")


def page_of(args: argparse.Namespace, picture: Path) -> int:
    """The page that is wanted. Where nobody has said one says on stderr that there are others. Raises SettingsError."""
    if args.page is not None:
        if args.page < 1:
            raise SettingsError("pages are counted from 1: give --page 1 or more")
        return int(args.page)
    pages = count_pages(picture)
    if pages > 1:
        print(f"{picture} has {pages} pages, the first is taken: --page N takes another", file=sys.stderr)
    return 1


def which_of(args: argparse.Namespace) -> str:
    """The name that was given with `--machine`; "" for none."""
    return str(getattr(args, "machine", None) or "")


def add_record(parser: argparse.ArgumentParser) -> None:
    """Where everything is written down."""
    words = "write every byte to and from the machine, with its time; `linedrawd replay FILE` reads it"
    parser.add_argument("--record", metavar="FILE", type=Path, default=argparse.SUPPRESS, help=words)


def record_of(args: argparse.Namespace) -> Path | None:
    """The file of `--record`; a file drop hears and says nothing that could be recorded."""
    return getattr(args, "record", None)


def read_file(args: argparse.Namespace, environment: Mapping[str, str] = os.environ) -> Path | None:
    """The file that the settings of this command line are read from, None where there is none."""
    given = getattr(args, "config", None)
    return Path(given) if given else usual_file(environment)


def settings_of(args: argparse.Namespace, *, machine_needed: bool = False, one_machine: bool = False) -> Settings:
    """The settings of this command line. Raises SettingsError.

    one_machine: only those of the machine that is meant; it must be clear which.
    """
    paths: dict[str, Any] = {name: Path(getattr(args, name)) for name in _PATHS if getattr(args, name, None)}
    said: dict[str, Any] = {name: getattr(args, name, None) for name in ("device", "port", "scanner")}
    said["machine"] = which_of(args) or None if one_machine else None
    return load_settings(Options(**paths, **said), machine_needed=machine_needed, one_machine=one_machine)


def verbose(args: argparse.Namespace) -> bool:
    return bool(getattr(args, "verbose", False))
