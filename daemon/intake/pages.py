"""How many pages a document has, counted by a process of its own: whoever takes pictures in never opens one."""

from __future__ import annotations

import argparse
import os
import re
import resource
import subprocess
import sys
from pathlib import Path

import daemon

MOST_PAGES = 100
UNCOUNTED = 0
"""The page of a document of which nobody knows how many pages it has."""
PDF_HEAD = re.compile(rb"(?!\x89PNG|\xff\xd8|II\*\0|MM\0\*).{0,1019}%PDF-", re.DOTALL)
"""Other bytes may lie before it, but none of a picture in which somebody has only noted where it came from."""
_TIFF_HEAD = re.compile(rb"II\*\0|MM\0\*")
_HEAD_BYTES = 1024
_ROOT = Path(daemon.__file__).parent.parent
_WITHIN_S = 20
_MEMORY_MB = 1024


def count_pages(path: Path) -> int:
    """The pages of a PDF or TIFF file, 1 of what is none; UNCOUNTED where counting took too long or too much memory.

    A document that is damaged, encrypted or has more than MOST_PAGES is one job, which fails and says why.
    """
    head = _head(path)
    if not (_TIFF_HEAD.match(head) or PDF_HEAD.match(head)):
        return 1
    try:
        counted = subprocess.run(
            [sys.executable, "-m", "daemon.intake.pages", str(path.absolute())],
            cwd=_ROOT, stdin=subprocess.DEVNULL, capture_output=True, timeout=_WITHIN_S, check=False,
            # Ctrl-C ends the daemon, not a count that would then be taken for one that went wrong.
            start_new_session=True,
        )  # fmt: skip
    except (OSError, subprocess.TimeoutExpired):
        return UNCOUNTED
    if counted.returncode < 0:
        return UNCOUNTED
    return int(counted.stdout) if counted.returncode == 0 else 1


def checked_page(page: int, pages: int) -> int:
    """The page, from 1 on, of a document of so many; UNCOUNTED is the only one. Raises ValueError."""
    if pages > MOST_PAGES:
        raise ValueError(f"has {pages} pages, at most {MOST_PAGES} are drawn: split it")
    if page == UNCOUNTED and pages > 1:
        raise ValueError(f"has {pages} pages, which could not be counted when it came: drop it again")
    if page > pages:
        raise ValueError(f"has {'1 page' if pages == 1 else f'{pages} pages'}, there is no page {page}")
    return max(page, 1)


def _head(path: Path) -> bytes:
    """Nothing of what is no regular file, or cannot be read."""
    try:
        with open(os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC), "rb") as file:
            return file.read(_HEAD_BYTES)
    except OSError:
        return b""


def main(arguments: list[str] | None = None) -> int:
    """Print how many pages are drawn, UNCOUNTED where memory is short; anything else ends with a traceback."""
    parser = argparse.ArgumentParser(prog="python -m daemon.intake.pages", description="Counts the pages of a file.")
    parser.add_argument("file", type=Path)
    path = parser.parse_args(arguments).file
    resource.setrlimit(resource.RLIMIT_DATA, (_MEMORY_MB << 20,) * 2)
    resource.setrlimit(resource.RLIMIT_CPU, (_WITHIN_S, _WITHIN_S))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    try:
        pages = _pages_in(path.read_bytes())
    except MemoryError:
        pages = UNCOUNTED
    print(pages if pages <= MOST_PAGES else 1)
    return 0


def _pages_in(data: bytes) -> int:
    from daemon.intake.tags import is_tiff, page_directories  # noqa: PLC0415 - in this process alone

    if is_tiff(data):
        return len(page_directories(data))
    from daemon.intake.vector.pdf import pages_of_pdf  # noqa: PLC0415

    return pages_of_pdf(data)


if __name__ == "__main__":
    sys.exit(main())
