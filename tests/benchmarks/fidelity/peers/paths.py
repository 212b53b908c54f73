"""vpype on given strokes: JSON {name: strokes} in, {name: {"linesort": strokes, "two-opt": strokes}} out.

Runs in the peers' virtual environment and knows nothing of linedrawd. Strokes whose ends are near are merged first.
"""

from __future__ import annotations

import json
import sys

import numpy as np
import vpype
import vpype_cli

PIPELINES = {"linesort": "linesort", "two-opt": "linesort --two-opt"}


def main(tolerance_px: float) -> None:
    found = {
        name: {how: sorted_by(pipeline, strokes, tolerance_px) for how, pipeline in PIPELINES.items()}
        for name, strokes in json.load(sys.stdin).items()
    }
    json.dump(found, sys.stdout)


def sorted_by(pipeline: str, strokes: list[list[list[float]]], tolerance_px: float) -> list[list[list[float]]]:
    """Merged and sorted, in the order to draw them."""
    lines = [np.array([complex(*point) for point in stroke]) for stroke in strokes]
    document = vpype.Document(vpype.LineCollection(lines))
    done = vpype_cli.execute(f"linemerge --tolerance {tolerance_px}px {pipeline}", document)
    return [np.stack([line.real, line.imag], axis=1).tolist() for line in done.layers.get(1, [])]


if __name__ == "__main__":
    main(float(sys.argv[1]))
