"""`linedrawd report JOB`: everything about one job in a zip, for somebody who is to find a mistake."""

from __future__ import annotations

import argparse
import json
import platform
import sys
from collections.abc import Iterator
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from daemon import __version__
from daemon.cli import doctor
from daemon.cli.options import add_places, read_file, settings_of
from daemon.errors import LinedrawError
from daemon.jobs.folder import is_called
from daemon.jobs.record import RECORD_NAME
from daemon.report.bundle import folder_files, tail, without_secrets, write_bundle
from daemon.status import JOB_LOG_NAME, LOG_NAME

EXAMPLES = """examples:
  linedrawd report 12                             # linedrawd-report-000012-house.zip, here
  linedrawd report 12 --recording plotter.txt     # with a recording that is not of the last daemon
  linedrawd report 12 --without-picture           # neither the given picture nor what was made of it
Look into it before you send it: the picture and the names of your files are in it. Nothing is sent by this command.
"""
_PICTURES = ("source", "preview.", "explain.", "drawing.", "strokes.", "program.", "ink.")
_PACKAGES = ("numpy", "onnxruntime", "opencv-python-headless", "pydantic", "pyserial", "pyusb", "watchdog")


def add_parser(subparsers: Any) -> None:
    words = "everything about one job in a zip, for a report of a mistake"
    parser = subparsers.add_parser(
        "report",
        help=words,
        description="Write a zip with the job's folder, its log, the settings without secrets, versions, what "
        "`linedrawd doctor` finds, and what was said to the machine where --record writes it down.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("job", metavar="JOB", help="its id, or the number at its beginning")
    parser.add_argument("-o", "--output", metavar="FILE", type=Path, help="the zip; here, named after the job, if not")
    parser.add_argument("--recording", metavar="FILE", type=Path, help="by --record; the daemon's, if not")
    parser.add_argument("--without-picture", action="store_true", help="nothing that shows what was drawn")
    add_places(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """0 when it is written. Raises LinedrawError."""
    settings = settings_of(args)
    folder = _folder(settings.paths.jobs, args.job)
    bundle = args.output or Path(f"linedrawd-report-{folder.name}.zip")
    parts: dict[str, Path | bytes | str] = {
        "about.txt": "\n".join(_about()) + "\n",
        "settings.toml": _settings(args),
        "doctor.txt": "\n".join(map(doctor.line_of, doctor.findings(args, ask=False))) + "\n",
        LOG_NAME: _plain(settings.paths.log_dir / LOG_NAME),
        "status.json": _plain(settings.paths.status),
        **_of_job(folder, pictures=not args.without_picture),
    }
    for name in {f"{folder.name}/{JOB_LOG_NAME}", f"{folder.name}/{RECORD_NAME}"} & parts.keys():
        parts[name] = _plain(folder.parent / name)
    if recording := args.recording or (None if args.without_picture else _of_the_daemon(settings.paths.status)):
        parts["recording.txt"] = _recording(recording)
    told = write_bundle(bundle, {name: part for name, part in parts.items() if part not in (b"", "")})
    for name, size in told:
        print(f"{_size(size):>9}  {name}")
    print(f"{_size(bundle.stat().st_size):>9}  {bundle}, all of it. Look into it before you send it")
    return 0


def _folder(jobs: Path, wanted: str) -> Path:
    names = sorted(path.name for path in jobs.iterdir() if path.is_dir()) if jobs.is_dir() else []
    found = [name for name in names if is_called(name, wanted)]
    if len(found) == 1:
        return jobs / found[0]
    raise LinedrawError(f"there is no job {wanted} in {jobs}: `linedrawd jobs` lists them")


def _of_job(folder: Path, *, pictures: bool) -> dict[str, Path]:
    files = folder_files(folder, below=folder.name)
    return {name: path for name, path in files.items() if pictures or not path.name.startswith(_PICTURES)}


def _settings(args: argparse.Namespace) -> str:
    file = read_file(args)
    return _plain(file) if file else "# no file\n"


def _plain(file: Path) -> str:
    return without_secrets(tail(file).decode(errors="replace"))


def _of_the_daemon(status: Path) -> Path | None:
    """The recording that its status names, where it is still there."""
    with suppress(OSError, ValueError, KeyError):
        said = Path(json.loads(status.read_text(encoding="utf-8"))["recording"])
        return said if said.is_file() else None
    return None


def _recording(file: Path) -> str:
    """It begins with the machine's settings."""
    try:
        return without_secrets(file.read_text(encoding="utf-8", errors="replace"))
    except OSError as error:
        raise LinedrawError(f"{file} cannot be read ({error.strerror}): give the file that --record wrote") from None


def _about() -> Iterator[str]:
    yield f"linedrawd {__version__}"
    yield f"Python {sys.version.split()[0]} on {platform.platform()}"
    for line in tail(Path("/etc/os-release")).decode(errors="replace").splitlines():
        if line.startswith("PRETTY_NAME="):
            yield line.partition("=")[2].strip('"')
    for package in _PACKAGES:
        try:
            yield f"{package} {version(package)}"
        except PackageNotFoundError:
            yield f"{package} is not installed"


def _size(size_bytes: int) -> str:
    return f"{size_bytes / 1e6:.1f} MB" if size_bytes >= 1e6 else f"{size_bytes / 1e3:.1f} kB"
