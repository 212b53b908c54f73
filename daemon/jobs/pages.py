"""Which page of a file with several pages a job draws."""

from __future__ import annotations

from pathlib import Path

PAGE_NAME = "page.txt"
"""In a job's folder: the number of its page, from 1 on; not there for the first."""


def page_of(folder: Path) -> int:
    """The page that the job in this folder draws, 1 where nothing is said of it."""
    path = folder / PAGE_NAME
    return int(path.read_text(encoding="ascii")) if path.exists() else 1
