"""The journal of a state folder; one that is damaged is kept aside, and a new one begun."""

from __future__ import annotations

import logging
from collections.abc import Callable
from pathlib import Path

from daemon.jobs.journal import DamagedJournal, Journal, set_aside


def open_journal(path: Path, *, say: Callable[..., None]) -> Journal:
    """Raises DiskTrouble where it cannot be had, or is of a newer version. A new one is filled by `Desk.recover`."""
    try:
        return Journal(path)
    except DamagedJournal as error:
        aside = set_aside(path)
        words = f"{error}; it is kept as {aside.name}, and the jobs are what their folders tell"
        say(words, level=logging.ERROR)
        return Journal(path)
