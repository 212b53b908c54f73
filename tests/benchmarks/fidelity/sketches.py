"""Quick, Draw! sketches of a given file, 256 px, and those of them whose lines have run together."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tests.benchmarks.fidelity.known import Known
from tests.benchmarks.fidelity.measure import scribbled
from training.quickdraw import Strokes, read
from training.render import fit

SIDE_PX = 256
_SKETCH_PX = 232.0
MOST_SCRIBBLED = 0.02
SKETCHES = 200


def sketches(file: Path, *, limit: int = SKETCHES) -> tuple[list[Known], list[Known]]:
    """The first sketches of an ndjson file: those that resolve, and the scribbles. Raises ValueError, OSError."""
    rows = read([file], limit=limit)
    every = [_known(f"{index:03} {rows.words[index]}", rows[index]) for index in range(len(rows))]
    resolved = [scribbled(each) <= MOST_SCRIBBLED for each in every]
    kept = [each for each, is_resolved in zip(every, resolved, strict=True) if is_resolved]
    return kept, [each for each, is_resolved in zip(every, resolved, strict=True) if not is_resolved]


def _known(name: str, strokes: Strokes) -> Known:
    placed = fit(strokes, SIDE_PX, _SKETCH_PX)
    # A stroke of which all points are one is a dot.
    return Known(name, [s if np.ptp(s, axis=0).max() > 0 else s[:1] for s in placed], SIDE_PX)
