"""Where pages lie until they are whole: a hidden folder in the inbox, so that one rename brings them in."""

from __future__ import annotations

import fcntl
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from daemon.errors import DiskTrouble

PREFIX = ".scan-"


@contextmanager
def spool_in(inbox: Path) -> Iterator[Path]:
    """A folder for one scan, gone when the block is left; what was left of others by a power cut goes as well.

    Raises DiskTrouble when the inbox takes no folder.
    """
    remove_leftovers(inbox)
    try:
        spool = Path(tempfile.mkdtemp(prefix=PREFIX, dir=inbox))
    except OSError as error:
        raise DiskTrouble(f"nothing can be put into the inbox {inbox} ({error.strerror}): mend the folder") from None
    held = os.open(spool, os.O_RDONLY | os.O_DIRECTORY)
    try:
        fcntl.flock(held, fcntl.LOCK_EX)
        yield spool
    finally:
        shutil.rmtree(spool, ignore_errors=True)
        os.close(held)


def remove_leftovers(inbox: Path) -> None:
    """The folders of scans whose process is gone. One that is in use is locked and stays."""
    for spool in inbox.glob(f"{PREFIX}*"):
        try:
            held = os.open(spool, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
        except OSError:
            continue
        try:
            fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
            shutil.rmtree(spool, ignore_errors=True)
        except BlockingIOError:
            continue
        finally:
            os.close(held)
