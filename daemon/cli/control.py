"""`linedrawd next`, `stop`, `go`, `pause`, `resume`, `cancel`: orders to the running daemon."""

from __future__ import annotations

import argparse
from typing import Any, Literal

from daemon.cli.options import add_places, settings_of
from daemon.control import Order, give_order

_ORDERS: dict[Literal["next", "stop", "go", "resume"], tuple[str, str]] = {
    "next": (
        "a new sheet is in: draw the next picture",
        "linedrawd next             # or put a file NEXT into the inbox",
    ),
    "stop": (
        "stop the machine now, pen up; no further job starts until `go`",
        "linedrawd stop             # then `linedrawd jobs` says what is on the paper",
    ),
    "resume": (
        "go on after `pause`",
        "linedrawd resume           # the pen goes to where the drawing was left",
    ),
    "go": (
        "jobs may start again, after `stop` or a fault of the machine",
        "linedrawd go               # when the machine, the pen and the sheet are in order",
    ),
}


def add_parser(subparsers: Any) -> None:
    for order, (words, example) in _ORDERS.items():
        parser = subparsers.add_parser(
            order,
            help=words,
            description=words[0].upper() + words[1:] + ".",
            epilog=f"example:\n  {example}",
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        add_places(parser)
        parser.set_defaults(run=run, order=Order(order=order))
    parser = subparsers.add_parser(
        "pause",
        help="stand still with the pen up until `resume`",
        description="Stand still with the pen up, at the end of the stroke that is being drawn, until `resume`.",
        epilog="example:\n  linedrawd pause            # then change the pen, then `linedrawd resume`",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--at-once", action="store_true", help="in the middle of the stroke, which is drawn on later")
    add_places(parser)
    parser.set_defaults(run=run, order=None)
    parser = subparsers.add_parser(
        "cancel",
        help="drop a job",
        description="Drop a job. One that is being drawn is stopped, pen up.",
        epilog="example:\n  linedrawd cancel 12        # the job that `linedrawd jobs` lists as 000012-...",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("job", metavar="JOB", help="its id, or the number at its beginning")
    add_places(parser)
    parser.set_defaults(run=run, order=None)


def run(args: argparse.Namespace) -> int:
    """0 when the daemon did it. Raises LinedrawError when it refuses or does not run."""
    order = args.order or _order(args)
    print(give_order(settings_of(args).paths.control, order))
    return 0


def _order(args: argparse.Namespace) -> Order:
    if hasattr(args, "at_once"):
        return Order(order="pause", at_once=args.at_once)
    return Order(order="cancel", job=args.job)
