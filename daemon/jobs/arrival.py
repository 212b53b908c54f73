"""An arrival: what is known of a picture when it comes in, kept in its job's folder until the job is recorded."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path

ARRIVAL_NAME = "arrival.json"


@dataclass(frozen=True, slots=True)
class Arrival:
    """name: of the picture. side: of its side file, "" for none. copy_of: the job that it is a copy of.

    inbox: the machine whose inbox it came by, "" for that of all. machine: the one that shall draw it, "" for any.
    twin: the job of the same picture because of which this one is not drawn; "" where it is.
    """

    name: str
    side: str
    copies: int
    copy_of: str = ""
    inbox: str = ""
    machine: str = ""
    twin: str = ""

    def encoded(self) -> bytes:
        return json.dumps(asdict(self)).encode()


def arrival_in(folder: Path) -> Arrival | None:
    """None where the folder has none, or one that we have not written."""
    try:
        return Arrival(**json.loads((folder / ARRIVAL_NAME).read_text(encoding="utf-8")))
    except (OSError, ValueError, TypeError):
        return None
