"""`linedrawd --device grbl`: the daemon."""

from __future__ import annotations

import argparse
import os

from daemon.cli.options import record_of, settings_of, verbose
from daemon.notify import notifier_of
from daemon.parts import parts_of
from daemon.service import Service


def run(args: argparse.Namespace) -> int:
    """Until SIGTERM. Without a machine it keeps running and waits for one. 1 when a mistake of ours ended it."""
    settings = settings_of(args, machine_needed=True)
    with parts_of(settings, verbose=verbose(args), record=record_of(args)) as parts:
        service = Service(
            settings,
            parts,
            notifier=notifier_of(os.environ),
            reread=lambda: settings_of(args, machine_needed=True),
        )
        service.end_on_signals()
        return 0 if service.run() else 1
