"""The journal of a state folder; one that is damaged is kept aside, and a new one begun."""

from __future__ import annotations

import logging
from collections.abc import Callable
from pathlib import Path

from daemon.durable import sync_folder
from daemon.errors import DiskTrouble
from daemon.jobs.journal import DamagedJournal, Journal


def open_journal(path: Path, *, say: Callable[..., None]) -> Journal:
    """Raises DiskTrouble where it cannot be had, or is of a newer version. A new one is filled by `Desk.recover`."""
    try:
        return Journal(path)
    except DamagedJournal as error:
        aside = _set_aside(path)
        words = f"{error}; it is kept as {aside.name}, and the jobs are what their folders tell"
        say(words, level=logging.ERROR)
        return Journal(path)


def _set_aside(path: Path) -> Path:
    """Rename a damaged journal and what SQLite keeps beside it; returns its new name. Raises DiskTrouble."""
    number = 1
    while (aside := path.with_name(f"{path.name}.corrupt-{number}")).exists():
        number += 1
    try:
        # The journal goes last: a cut before that finds it again, and damaged as it was.
        for suffix in ("-wal", "-shm", ""):
            if (part := path.with_name(path.name + suffix)).exists():
                part.rename(aside.with_name(aside.name + suffix))
        sync_folder(path.parent)
    except OSError as error:
        raise DiskTrouble(f"{path} cannot be moved aside ({error.strerror}): correct its folder's rights") from None
    return aside
