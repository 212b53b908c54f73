"""The command line: which words lead where, and which error to which exit code."""

from __future__ import annotations

import argparse
import os
import sys

from daemon import __version__
from daemon.cli import simulate_ctl
from daemon.errors import LinedrawError

EXAMPLES = """examples:
  linedrawd --device grbl                  # the daemon: finds the port, draws what is dropped into the inbox
  linedrawd --device sim --state-dir try   # the same on a simulated machine; drop pictures into try/inbox
  linedrawd plan house.png -o plans        # what would be drawn, without a machine
  linedrawd preview house.png              # one file that shows it, how it is drawn, and how long
  linedrawd draw house.png --device grbl   # one picture now
  linedrawd scan                           # what lies on the scanner comes into the inbox
  linedrawd next                           # a new sheet is in
  linedrawd machine check                  # who answers, and what a drawing would want otherwise
  linedrawd status                         # what it does now
  linedrawd watch                          # the same, live, with the drawing so far

exit codes: 0 done, 1 some pictures failed, 2 usage or settings, 3 no machine (draw), 4 machine fault
"""


def main(arguments: list[str] | None = None) -> int:
    """Run one command and return its exit code; errors are one sentence on stderr."""
    # onnxruntime reports home from its first import on unless this is set before it.
    os.environ["ORT_DISABLE_TELEMETRY"] = "1"
    arguments = sys.argv[1:] if arguments is None else arguments
    # What happens to a simulated machine that moves has to happen now: it waits for no other command to be loaded.
    parser = _event_parser() if arguments[:2] == ["simulate", "ctl"] else whole_parser()
    args = parser.parse_args(arguments)
    try:
        return int(args.run(args))
    except LinedrawError as error:
        print(f"linedrawd: {error}", file=sys.stderr)
        return error.exit_code
    except BrokenPipeError:
        # Whoever reads has had enough, as in `linedrawd jobs | head`.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except KeyboardInterrupt:
        return 130


def whole_parser() -> argparse.ArgumentParser:
    """Every command with its words; --help and the page of the manual are made of it."""
    from daemon.cli import (  # noqa: PLC0415
        calibrate,
        control,
        doctor,
        draw,
        machine,
        models,
        plan,
        preview,
        replay,
        report,
        scan,
        serve,
        setup,
        simulate,
        status,
        usb,
        watch,
    )
    from daemon.cli.options import add_machine, add_places, add_record  # noqa: PLC0415
    from daemon.cli.scan import add_scanner  # noqa: PLC0415

    parser = argparse.ArgumentParser(
        prog="linedrawd",
        description="Draws line drawings with a pen plotter: drop a picture into a folder, the machine draws it.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"linedrawd {__version__}")
    add_machine(parser)
    add_scanner(parser)
    add_places(parser)
    add_record(parser)
    parser.set_defaults(run=serve.run)
    subparsers = parser.add_subparsers(title="commands (none: the daemon)", metavar="COMMAND")
    for group in (
        plan,
        preview,
        draw,
        scan,
        control,
        machine,
        status,
        usb,
        watch,
        setup,
        doctor,
        calibrate,
        report,
        models,
        simulate,
        replay,
    ):
        group.add_parser(subparsers)
    return parser


def _event_parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="linedrawd")
    machines = parser.add_subparsers().add_parser("simulate").add_subparsers()
    simulate_ctl.add_parser(machines)
    return parser


if __name__ == "__main__":
    sys.exit(main())
