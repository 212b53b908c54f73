"""An arrival: what is known of a picture when it comes in, kept in its job's folder."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from daemon.jobs.folder import write_durably

ARRIVAL_NAME = "arrival.json"


@dataclass(frozen=True, slots=True)
class Arrival:
    """name: of the picture. side: of its side file, "" for none. copy_of: the job that it is a copy of.

    inbox: the machine whose inbox it came by, "" for that of all. machine: the one that shall draw it, "" for any.
    twin: the job of the same picture because of which this one is not drawn; "" where it is.
    pages: of the document, a job each. page: the one that this job draws, from 1 on; with several, or with copies, the
    first of them.
    """

    name: str
    side: str
    copies: int
    copy_of: str = ""
    inbox: str = ""
    machine: str = ""
    twin: str = ""
    pages: int = 1
    page: int = 1

    @property
    def called(self) -> str:
        """What people call it."""
        return self.name if self.pages == 1 and self.page <= 1 else f"{self.name} page {self.page}"

    def jobs(self) -> list[Arrival]:
        """One for each job that is made of it, page by page, then the next copy; of a copy only itself."""
        if self.copy_of:
            return [self]
        return [replace(self, page=self.page + more) for more in range(self.pages)] * self.copies

    def copy(self, job: str) -> Arrival:
        """The same page of the same picture as a job that stands for itself, made of this one."""
        return replace(self, side="", copies=1, copy_of=job, inbox="", twin="")

    def encoded(self) -> bytes:
        return json.dumps(asdict(self)).encode()


def arrival_in(folder: Path) -> Arrival | None:
    """None where the folder has none, or one that we have not written."""
    try:
        return Arrival(**json.loads((folder / ARRIVAL_NAME).read_text(encoding="utf-8")))
    except (OSError, ValueError, TypeError):
        return None


def page_in(folder: Path) -> int:
    """The page, from 1 on, of the picture in this folder that is drawn."""
    arrival = arrival_in(folder)
    return arrival.page if arrival else 1


def keep_page(folder: Path, page: int) -> None:
    """What is planned in this folder, which is no job's, is this page of the picture. Raises DiskTrouble."""
    if page != page_in(folder):
        write_durably(folder / ARRIVAL_NAME, Arrival("", "", 1, page=page).encoded())
