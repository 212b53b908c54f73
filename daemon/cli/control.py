"""`next`, `stop`, `go`, `drain`, `pause`, `resume`, `cancel`, `retry`, `again`, `approve`: orders to the daemon."""

from __future__ import annotations

import argparse
from typing import Any, Literal

from daemon.cli.options import add_places, add_which, settings_of, which_of
from daemon.control import Order, give_order
from daemon.errors import SettingsError

_ORDERS: dict[Literal["next", "stop", "go", "drain"], tuple[str, str]] = {
    "next": (
        "a new sheet is in: draw the next picture",
        "linedrawd next             # or put a file NEXT into the inbox\n  linedrawd next --machine left",
    ),
    "stop": (
        "stop the machine now, pen up; no further job starts until `go`",
        "linedrawd stop             # all machines; then `linedrawd jobs` says what is on the paper\n"
        "  linedrawd stop --machine left",
    ),
    "drain": (
        "finish what is being drawn and begin nothing more until `go`",
        "linedrawd drain            # before the machine is switched off",
    ),
    "go": (
        "jobs may start again, after `stop` or a fault of the machine",
        "linedrawd go               # when the machine, the pen and the sheet are in order",
    ),
}

_WHICH = "which machine, by the name of its section; needed where there are several"
_WHICH_OR_ALL = "which machine, by the name of its section; all where none is named"

_OF_A_JOB: dict[Literal["cancel", "retry", "again", "approve"], tuple[str, str, str]] = {
    "cancel": (
        "drop a job",
        "Drop a job. One that is being drawn is stopped, pen up.",
        "linedrawd cancel 12        # the job that `linedrawd jobs` lists as 000012-...",
    ),
    "retry": (
        "try a failed job again",
        "Try a job again that failed before any ink came onto a sheet.",
        "linedrawd retry 12         # after the settings were mended",
    ),
    "again": (
        "draw a job once more",
        "Draw the picture of a job once more, as a new job, whatever became of the old one.",
        "linedrawd again 12         # put a new sheet in first",
    ),
    "approve": (
        "draw a job that waits for that word",
        "Draw a job that waits for approval, where `approve = true` asks for it.",
        "linedrawd approve 12       # after a look at preview.html in its folder",
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
        add_which(parser, _WHICH_OR_ALL if order == "stop" else _WHICH)
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
    add_which(parser, _WHICH_OR_ALL)
    add_places(parser)
    parser.set_defaults(run=run, order=None)
    parser = subparsers.add_parser(
        "resume",
        help="go on after `pause`, or with an interrupted job from a stroke on",
        description="Go on after `pause`; or, with JOB and --from-stroke, go on with a job that was interrupted.",
        epilog="examples:\n"
        "  linedrawd resume                       # the pen goes to where the drawing was left\n"
        "  linedrawd resume 12 --from-stroke 40   # look at the sheet first: stroke 40 and all behind it are drawn",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("job", metavar="JOB", nargs="?", default="", help="its id, or the number at its beginning")
    parser.add_argument("--from-stroke", type=int, metavar="K", help="the first stroke to be drawn, from 0")
    add_which(parser, _WHICH)
    add_places(parser)
    parser.set_defaults(run=run, order=None)
    for name, (words, description, example) in _OF_A_JOB.items():
        parser = subparsers.add_parser(
            name,
            help=words,
            description=description,
            epilog=f"example:\n  {example}",
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        parser.add_argument("job", metavar="JOB", help="its id, or the number at its beginning")
        add_places(parser)
        parser.set_defaults(run=run, order=None, of_a_job=name)


def run(args: argparse.Namespace) -> int:
    """0 when the daemon did it. Raises LinedrawError when it refuses or does not run."""
    order = (args.order or _order(args)).model_copy(update={"machine": which_of(args)})
    print(give_order(settings_of(args).paths.control, order))
    return 0


def _order(args: argparse.Namespace) -> Order:
    if hasattr(args, "at_once"):
        return Order(order="pause", at_once=args.at_once)
    if hasattr(args, "of_a_job"):
        return Order(order=args.of_a_job, job=args.job)
    if bool(args.job) != (args.from_stroke is not None):
        raise SettingsError("JOB and --from-stroke belong together: give both, or none to end a pause")
    if args.from_stroke is not None and args.from_stroke < 0:
        raise SettingsError("strokes are counted from 0: give --from-stroke 0 or more")
    return Order(order="resume", job=args.job, from_stroke=args.from_stroke)
