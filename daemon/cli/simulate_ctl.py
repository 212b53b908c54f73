"""`linedrawd simulate ctl`: lets something happen to a simulated machine that is running.

Loads nothing but the socket: what happens to a moving machine has to happen now.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from daemon.machine.simulator_control import tell

_EXAMPLE = """what can happen: (N counts from 0, which is the next one; a place counts from `all inputs open`)
  all inputs open                   limit x|y|z closed|open
  switch x|y|z closes at +4.000 mm  probe closed|open
  pin hold|start|reset low|high     probe contact at and below z -0.500 mm
  hardware reset                    dtr reset (boot loader deaf for 1.5 s)
  lose byte [N]                     flip byte [N] [bits 0x01]
  lose ok [N]                       slow usb 16 ms
  hang                              brown-out
  unplug                            plug in
  unsaid alarm                      ink to FILE (what has been drawn so far, as JSON in mm)
"""


def add_parser(machines: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add `ctl` to the words behind `simulate`."""
    parser = machines.add_parser(
        "ctl",
        help="let something happen to a machine that is running",
        epilog=_EXAMPLE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("link", type=Path, metavar="LINK", help="the symbolic link that it was given with --pty")
    parser.add_argument("event", nargs="+", metavar="EVENT", help="what happens, in words")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Returns the exit code. Raises NoMachine and MachineFault."""
    tell(args.link, " ".join(args.event))
    return 0
