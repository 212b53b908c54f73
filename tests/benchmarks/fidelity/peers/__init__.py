"""Other people's programs, each run in a child process of the peers' virtual environment (`make peers`)."""

from __future__ import annotations

import json
import os
import subprocess
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from daemon.shapes import Grey, Points

PYTHON = Path(__file__).parents[4] / ".venv-peers" / "bin" / "python"
TRACERS = ("plotline", "autotrace", "sknw")
_HERE = Path(__file__).parent
_ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "RAYON_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1"}


def installed() -> bool:
    return PYTHON.exists()


def traced(tool: str, pictures: Mapping[str, Grey]) -> dict[str, tuple[list[Points], float]]:
    """The strokes of each picture in px, and the CPU ms they took."""
    with tempfile.TemporaryDirectory() as folder:
        for name, grey in pictures.items():
            cv2.imwrite(f"{folder}/{name}.png", grey)
        found = _run("trace.py", tool, folder)
    return {name: (_strokes(found[name]["strokes"]), found[name]["cpu_ms"]) for name in pictures}


def vpype(drawings: Mapping[str, Sequence[Points]], *, tolerance_px: float) -> dict[str, dict[str, list[Points]]]:
    """Each drawing merged and sorted in each of vpype's ways; empty where the peers are not installed."""
    if not installed():
        return {}
    given = {name: [stroke.tolist() for stroke in strokes] for name, strokes in drawings.items()}
    found = _run("paths.py", str(tolerance_px), given=given)
    return {name: {how: _strokes(lines) for how, lines in ways.items()} for name, ways in found.items()}


def annealed(sets: Sequence[Sequence[Sequence[Sequence[float]]]]) -> list[float]:
    """The pen-up length of each set of strokes' ends, there and back, by simulated annealing."""
    return [float(length) for length in _run("annealing.py", given=sets)]


def _run(script: str, *words: str, given: object = None) -> Any:
    command = [str(PYTHON), str(_HERE / script), *words]
    done = subprocess.run(
        command, input=json.dumps(given), capture_output=True, text=True, check=False, env=os.environ | _ONE_THREAD
    )
    if done.returncode:
        raise SystemExit(f"{script} {' '.join(words)} failed, make peers again:\n{done.stderr[-2000:]}")
    return json.loads(done.stdout)


def _strokes(lines: Iterable[Sequence[Sequence[float]]]) -> list[Points]:
    return [np.array(line, np.float64).reshape(-1, 2) for line in lines]
