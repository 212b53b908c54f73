"""`linedrawd machine`: check, home, origin, park, frame, pen, jog, feed: for a person who stands beside the machine."""

from __future__ import annotations

import argparse
from typing import Any

from daemon.cli.options import add_machine, add_places, add_which, settings_of, verbose, which_of
from daemon.control import NoDaemon, Order, give_order
from daemon.errors import LinedrawError
from daemon.parts import parts_of
from daemon.service import machine_order

EXAMPLES = """examples:
  linedrawd machine check           # who answers, its settings, what a drawing would want otherwise
  linedrawd machine jog 10 -5       # 10 mm to the right and 5 mm towards you, pen up
  linedrawd machine origin          # the sheet's corner lies where the pen stands
  linedrawd machine frame           # around the next drawing, pen up
  linedrawd machine pen down        # for 10 s, then up again
  linedrawd machine feed 80         # slower, in the middle of a drawing; the next one is drawn as usual
  linedrawd machine park --machine left     # where there are several
The running daemon does it, all but feed between two drawings. Where none runs, the port is opened for the one command,
which resets many controllers: start the daemon first to keep an origin.
"""
_FIGURES = ("job", "seconds", "x_mm", "y_mm", "percent")
_WORDS = {
    "check": "who answers, its settings, and what a drawing would want otherwise",
    "home": "find the machine's home",
    "origin": "the sheet's corner lies where the pen stands",
    "park": "move to the park position, pen up",
    "frame": "move around the next drawing, pen up",
    "pen": "lift the pen, or lower it for some seconds",
    "jog": "move by so many mm, pen up",
    "feed": "draw the rest of the running drawing faster or slower",
}


def add_parser(subparsers: Any) -> None:
    words = "check, home, origin, park, frame, pen, jog, feed: move the machine by hand"
    parser = subparsers.add_parser(
        "machine",
        help=words,
        description=words[0].upper() + words[1:] + ".",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    orders = parser.add_subparsers(title="orders", metavar="ORDER", dest="machine_order", required=True)
    for name, what in _WORDS.items():
        each = orders.add_parser(name, help=what, description=what[0].upper() + what[1:] + ".")
        if name == "frame":
            each.add_argument(
                "job", metavar="JOB", nargs="?", default="", help="its id, or the number at its beginning"
            )
        if name == "pen":
            each.add_argument("way", choices=["up", "down"])
            each.add_argument("--seconds", type=float, default=10.0, metavar="S", help="how long it stays down")
        if name == "jog":
            each.add_argument("x_mm", metavar="X", type=float, help="mm to the right")
            each.add_argument("y_mm", metavar="Y", type=float, help="mm up, away from you")
        if name == "feed":
            each.add_argument("percent", metavar="PERCENT", type=int, help="10 to 200; 100 is as usual")
        add_which(each)
        add_machine(each)
        add_places(each)
        each.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """0 when it has been done. Raises the LinedrawError that says why not."""
    order = _order(args)
    try:
        print(give_order(settings_of(args).paths.control, order))
    except NoDaemon:
        print(_without_a_daemon(args, order))
    return 0


def _order(args: argparse.Namespace) -> Order:
    name = f"pen {args.way}" if args.machine_order == "pen" else args.machine_order
    said: dict[str, Any] = {key: getattr(args, key) for key in _FIGURES if hasattr(args, key)}
    try:
        return Order.model_validate({"order": name, "machine": which_of(args), **said})
    except ValueError:
        if args.machine_order == "feed":
            raise LinedrawError(f"a feed of {args.percent} % is not possible: say 10 to 200") from None
        raise LinedrawError(f"{args.machine_order} of so much is not possible: give a smaller number") from None


def _without_a_daemon(args: argparse.Namespace, order: Order) -> str:
    if order.order == "feed":
        raise LinedrawError("no daemon runs, so nothing is being drawn: draw_mm_s in the settings is for all drawings")
    if order.order == "origin":
        raise LinedrawError(
            "no daemon runs, and the origin would be forgotten with this command: start linedrawd first"
        )
    settings = settings_of(args, machine_needed=True, one_machine=True)
    with parts_of(settings, verbose=verbose(args)) as parts:
        (drawing,) = parts.drawings.values()
        return drawing.obey(machine_order(order))
