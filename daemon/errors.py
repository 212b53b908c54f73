"""Everything that can go wrong for a reason a person can do something about: what, where, and what to do.

Raise one where the fact is known; `cli` turns it into an exit code and `jobs/runner` into a failed job.
"""

from __future__ import annotations

import difflib
import errno
from collections.abc import Sequence

NO_ROOM = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG}
"""What an OSError says of a folder that takes no more; `statvfs` knows of the first alone."""


class LinedrawError(Exception):
    """`str(error)` is a sentence that says what is wrong, where, and after the last colon what to do."""

    exit_code = 1


class BadPicture(LinedrawError):
    """The file is no picture we can read, or one we refuse to read."""


class NothingToDraw(LinedrawError):
    """The page holds no line."""


class PlanningFailed(LinedrawError):
    """The worker died, ran out of memory or out of time over this picture."""


class OutOfReach(LinedrawError):
    """The drawing leaves the area that the machine reaches."""


class DiskTrouble(LinedrawError):
    """A folder cannot be written: full, read-only, missing, or not ours."""


class DiskFull(DiskTrouble):
    """A folder takes no more: the disk is full, or what its owner may use of it is used up."""


class SettingsError(LinedrawError):
    """A setting is unknown, of the wrong type, or contradicts another; or the command line is."""

    exit_code = 2


class NoMachine(LinedrawError):
    """No machine, more than one, or one that is in use by another program."""

    exit_code = 3


class MachineFault(LinedrawError):
    """The machine refused, alarmed, restarted, fell silent or was unplugged."""

    exit_code = 4


class Unplugged(MachineFault):
    """The way to the machine has gone: its cable, its adapter or its network. It may come back at any moment."""


def unknown(where: str, key: str, known: Sequence[str]) -> str:
    """The sentence about a key that is not known at this place: the one that was meant, or all there are."""
    near = difflib.get_close_matches(key, known, n=1, cutoff=0.5)
    return f"{where} is unknown: " + (f"did you mean {near[0]}?" if near else f"known are {', '.join(known)}")
