"""`linedrawd draw`: one picture, now, with a progress bar."""

from __future__ import annotations

import argparse
import shutil
import signal
import sys
from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import suppress
from pathlib import Path
from typing import Any

from daemon.cli.options import (
    add_machine,
    add_page,
    add_places,
    add_record,
    add_which,
    page_of,
    record_of,
    settings_of,
    verbose,
)
from daemon.errors import LinedrawError, MachineFault
from daemon.jobs.arrival import ARRIVAL_NAME, Arrival
from daemon.jobs.states import State
from daemon.parts import Parts, parts_of
from daemon.status import Status

EXAMPLES = """examples:
  linedrawd draw house.png --device grbl                        # finds the port by itself
  linedrawd draw house.png --device grbl --port /dev/ttyACM0
  linedrawd draw house.png --device sim                         # on the simulated controller
Ctrl-C stops the machine and lifts the pen. Exit codes: 1 bad picture, 3 no machine, 4 machine fault.
"""
PAINT_EVERY_S = 0.2


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser(
        "draw",
        help="draw one picture now",
        description="Draw one picture now. The daemon must not be running on the same state folder.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("picture", metavar="PICTURE", type=Path)
    add_page(parser)
    add_which(parser)
    add_machine(parser)
    add_places(parser)
    add_record(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """0 when it is drawn. Raises the LinedrawError that says why not."""
    # Whatever ends this command lifts the pen first.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    settings = settings_of(args, machine_needed=True, one_machine=True)
    if not args.picture.is_file():
        raise LinedrawError(f"there is no file {args.picture}: give the path of a picture")
    with parts_of(settings, verbose=verbose(args), record=record_of(args)) as parts:
        arrival = Arrival(args.picture.name, "", 1, page=page_of(args, args.picture))
        folder = parts.desk.folders.copy(args.picture.absolute(), {ARRIVAL_NAME: arrival.encoded()})
        job_id = parts.desk.add(folder, arrival.called)
        _draw_watched(parts, job_id)
        job = parts.desk.find(job_id)
    if job.state is State.DONE:
        print(f"{job.id}: {job.words}")
        return 0
    raise LinedrawError(job.words)


def _draw_watched(parts: Parts, job_id: str) -> None:
    """In a thread of its own, while this one paints the bar and hears Ctrl-C. Raises what `_draw` raises."""
    with ThreadPoolExecutor(1) as threads:
        work = threads.submit(_draw, parts, job_id)
        while not work.done():
            try:
                wait([work], PAINT_EVERY_S)
                _paint(parts.board.now)
            except KeyboardInterrupt:
                with suppress(LinedrawError):
                    parts.runner.cancel(job_id)
        if sys.stderr.isatty():
            print(file=sys.stderr)
        work.result()


def _draw(parts: Parts, job_id: str) -> None:
    """The person who asks stands beside the machine: their sheet is in. What was held before is held again."""
    (station,) = parts.desk.stations.values()
    held = station.held
    parts.desk.only = job_id
    station.new_sheet()
    if held:
        station.go()
    parts.planning.turn()
    if parts.desk.find(job_id).state is State.PLANNED:
        _draw_planned(parts, job_id)
    if held and not station.held:
        station.hold(held)


def _draw_planned(parts: Parts, job_id: str) -> None:
    """Raises NoMachine or MachineFault where there is no machine, and MachineFault where it did not draw it all."""
    (drawing,) = parts.drawings.values()
    drawing.turn()
    job = parts.desk.find(job_id)
    if drawing.missing and job.state is State.WAITING:
        parts.desk.cancel(job_id)
        raise drawing.missing
    if job.state not in (State.DONE, State.CANCELLED):
        raise MachineFault(job.words)


def _paint(status: Status) -> None:
    if not sys.stderr.isatty():
        return
    columns = shutil.get_terminal_size().columns
    left = "" if status.seconds_left is None else f" {status.seconds_left:.0f} s left"
    words = f" {status.percent:3.0f} % {status.stage or status.state}{left}"
    width = max(10, columns - len(words) - 3)
    done = round(width * status.percent / 100)
    print(f"\r[{'#' * done}{' ' * (width - done)}]{words}"[:columns].ljust(columns - 1), end="", file=sys.stderr)
