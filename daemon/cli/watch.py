"""`linedrawd watch`: what the daemon does, live, read from files only."""

from __future__ import annotations

import argparse
import json
import os
import shutil
import signal
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TextIO

from daemon.cli.options import add_places, add_which, settings_of, which_of
from daemon.cli.view import MESSAGES, Size, of_machine, printable, progress_in_words, shown, view
from daemon.config import Paths
from daemon.jobs.pen_life import lines_of
from daemon.program.svg import LineMm
from daemon.status import LOG_NAME

EVERY_S = 0.25
_TAIL_BYTES = 8192
_ENTER, _LEAVE = "\x1b[?1049h\x1b[?25l\x1b[2J", "\x1b[?25h\x1b[?1049l"
_HOME, _REST_OF_ROW, _REST = "\x1b[H", "\x1b[K", "\x1b[J"
_STEP_PERCENT = 10


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser(
        "watch",
        help="what it does, live: the job, the time left, the drawing so far",
        description=(
            "The machine, the job, the time left, the strokes drawn so far and the last messages, until Ctrl-C. "
            "Where the output is no terminal, a line for each thing that happens."
        ),
        epilog="example:\n  linedrawd watch --state-dir try",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--once", action="store_true", help="show it once and end")
    add_which(parser, "whose drawing is shown; where none is named, that of one that draws")
    add_places(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """0, also after Ctrl-C."""
    sight = Sight(settings_of(args).paths, which_of(args))
    if args.once:
        for row in sight.rows(_size_of(sys.stdout), time.time()):
            print(row)
        return 0
    try:
        if sys.stdout.isatty():
            _show(sight, sys.stdout)
        else:
            _tell(sight, sys.stdout)
    except KeyboardInterrupt:
        return 0
    return 0


def _size_of(out: TextIO) -> Size:
    size = shutil.get_terminal_size()
    return Size(size.columns, size.lines, out.isatty() and not os.environ.get("NO_COLOR"))


def _show(sight: Sight, out: TextIO) -> None:
    before: list[str] = []
    with _whole_terminal(out):
        while True:
            rows = sight.rows(_size_of(out), time.time())
            if rows != before:
                out.write(_HOME + "\r\n".join(row + _REST_OF_ROW for row in rows) + _REST)
                out.flush()
            before = rows
            time.sleep(EVERY_S)


@contextmanager
def _whole_terminal(out: TextIO) -> Iterator[None]:
    """A screen of its own without a cursor; however it ends, the terminal is as before."""
    before = signal.signal(signal.SIGTERM, _interrupt)
    out.write(_ENTER)
    try:
        yield
    finally:
        out.write(_LEAVE)
        out.flush()
        signal.signal(signal.SIGTERM, before)


def _interrupt(*_: Any) -> None:
    raise KeyboardInterrupt


def _tell(sight: Sight, out: TextIO) -> None:
    told, steps, offset = "", dict[str, int](), sight.log_bytes()
    while True:
        said = sight.said()
        messages, offset = sight.messages_from(offset)
        for line in messages:
            print(printable(line), file=out, flush=True)
        words = _words(said)
        if words != told:
            print(printable(words), file=out, flush=True)
        for each in [of_machine(said, name) for name in said.get("machines") or [""]]:
            job, percent = str(each.get("job", "")), int((each.get("percent") or 0) // _STEP_PERCENT)
            if job and steps.get(job) != percent:
                print(printable(f"{job} {progress_in_words(each, time.time())}"), file=out, flush=True)
                steps = {**steps, job: percent}
        told = words
        time.sleep(EVERY_S)


def _words(said: dict[str, Any]) -> str:
    """What it does, but for how far it has come."""
    machines = said.get("machines") or {}
    if len(machines) > 1:
        return ", ".join(f"{name}: {each.get('state')} {each.get('words')}".strip() for name, each in machines.items())
    return f"{said.get('state', 'no daemon has left a status')} {said.get('words', '')}".strip()


@dataclass
class Sight:
    """What the daemon's files tell at this moment. Files that are missing tell nothing."""

    paths: Paths
    machine: str = ""
    """Whose drawing is shown."""
    _lines: tuple[str, Sequence[LineMm]] = ("", ())

    def rows(self, size: Size, wall_s: float) -> list[str]:
        said = self.said()
        pid = said.get("pid")
        runs = bool(pid) and Path(f"/proc/{pid}").exists()
        name = self.machine or shown(said)
        lines = self._lines_of(str(of_machine(said, name).get("job", "")))
        return view(said, lines, self.messages(), size, wall_s=wall_s, runs=runs, machine=name)

    def said(self) -> dict[str, Any]:
        try:
            said = json.loads(self.paths.status.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return {}
        return said if isinstance(said, dict) else {}

    def _lines_of(self, job: str) -> Sequence[LineMm]:
        """Read once for each job."""
        if job != self._lines[0]:
            self._lines = job, lines_of(self.paths.jobs / job) if job else ()
        return self._lines[1]

    def messages(self) -> list[str]:
        """The last lines of the log."""
        return self._read(max(0, self.log_bytes() - _TAIL_BYTES))[0][-MESSAGES:]

    def messages_from(self, offset: int) -> tuple[list[str], int]:
        """The whole lines of the log behind `offset`, and where they end; from the beginning where it is a new log."""
        return self._read(offset if offset <= self.log_bytes() else 0)

    def log_bytes(self) -> int:
        try:
            return (self.paths.log_dir / LOG_NAME).stat().st_size
        except OSError:
            return 0

    def _read(self, offset: int) -> tuple[list[str], int]:
        try:
            with (self.paths.log_dir / LOG_NAME).open("rb") as file:
                file.seek(offset)
                data = file.read()
        except OSError:
            return [], offset
        whole = data[: data.rfind(b"\n") + 1]
        return whole.decode("utf-8", "replace").splitlines(), offset + len(whole)
