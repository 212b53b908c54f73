"""What a drawing leaves in its job's folder: the seconds it took, and the ink of a simulated machine."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
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


def keep_ink(folder: Path, ink: InkMm, pens: Sequence[str] = (), *, more: bool) -> None:
    """Write ink.json. more: behind what an earlier part of the drawing has left. Raises DiskTrouble, ValueError.

    pens: what the pen of each line is called, where they have names.
    """
    path = folder / "ink.json"
    before = json.loads(path.read_text(encoding="utf-8")) if more and path.exists() else {"strokes": []}
    kept = {"strokes": [*before["strokes"], *ink]}
    kept |= {"pens": [*before.get("pens", ()), *pens]} if pens else {}
    write_durably(path, json.dumps(kept).encode())


def add_to_report(path: Path, real_s: float) -> None:
    """Raises DiskTrouble, and ValueError where it is no report."""
    if path.exists():
        report = json.loads(path.read_text(encoding="utf-8")) | {"real_s": real_s}
        write_durably(path, (json.dumps(report, indent=2) + "\n").encode())
