"""What a drawing leaves in its job's folder: the seconds it took, and the ink of a simulated machine."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from daemon.jobs.folder import write_durably
from daemon.jobs.open_machine import InkMm


@dataclass(frozen=True, slots=True)
class Reports:
    """What the worker does for the report of a drawing, by its job's folder. Each returns when it is done.

    whole: the last file of its plan is written, well or badly. measure: the ink of a simulated machine is compared
    with the picture.
    """

    whole: Callable[[Path], None]
    measure: Callable[[Path], None]


def keep_ink(folder: Path, ink: InkMm, *, more: bool) -> None:
    """Write ink.json. more: behind what an earlier part of the drawing has left. Raises DiskTrouble, ValueError."""
    path = folder / "ink.json"
    before: InkMm = json.loads(path.read_text(encoding="utf-8"))["strokes"] if more and path.exists() else []
    write_durably(path, json.dumps({"strokes": [*before, *ink]}).encode())


def add_to_report(path: Path, real_s: float) -> None:
    """Raises DiskTrouble, and ValueError where it is no report."""
    if path.exists():
        report = json.loads(path.read_text(encoding="utf-8")) | {"real_s": real_s}
        write_durably(path, (json.dumps(report, indent=2) + "\n").encode())
