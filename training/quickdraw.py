"""Quick, Draw! sketches (Google, CC BY 4.0) read from ndjson: simplified or raw, plain or .gz, a file or a folder.

Each row is {"word": ..., "key_id"/"key": ..., "drawing": [[xs, ys], ...]}; raw rows carry a third list, the times.
Sketches are kept packed (int16 or float32 points, one array) so that 70,000 of them take tens of megabytes.
"""

from __future__ import annotations

import gzip
import itertools
import json
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Strokes = list[NDArray[np.float32]]
"""The strokes of one sketch, each (N, 2) float32 in the file's own units, x right, y down."""


@dataclass(frozen=True, slots=True, eq=False)
class Sketches:
    """Many sketches, packed. `bad_rows` were skipped because they hold no readable drawing."""

    points: NDArray[np.float32]
    stroke_starts: NDArray[np.int64]
    sketch_starts: NDArray[np.int64]
    words: tuple[str, ...]
    bad_rows: int

    def __len__(self) -> int:
        return len(self.words)

    def __getitem__(self, index: int) -> Strokes:
        first, last = self.sketch_starts[index], self.sketch_starts[index + 1]
        bounds = self.stroke_starts[first : last + 1]
        return [self.points[a:b] for a, b in itertools.pairwise(bounds)]

    def sampling_weights(self, power: float = 0.5, *, dense: float = 0.0) -> NDArray[np.float64]:
        """Probability of each sketch: n sketches of a category share n ** power, each by its points ** dense."""
        count = Counter(self.words)
        points = np.diff(self.stroke_starts[self.sketch_starts])
        weights = np.array([count[word] ** (power - 1.0) for word in self.words]) * points**dense
        return weights / weights.sum()


def ndjson_files(path: Path) -> list[Path]:
    """The file itself, or every .ndjson and .ndjson.gz of a folder. Raises FileNotFoundError where there is none."""
    files = sorted([*path.glob("*.ndjson"), *path.glob("*.ndjson.gz")]) if path.is_dir() else [path]
    if not files or not all(file.is_file() for file in files):
        raise FileNotFoundError(f"{path} holds no .ndjson or .ndjson.gz file: give a file or a folder of Quick, Draw!")
    return files


def read(paths: Sequence[Path], *, skip: int = 0, limit: int | None = None) -> Sketches:
    """Rows `skip` ... `skip + limit` of all files together; bad rows are counted and left out.

    Raises ValueError with its name for a category (a file of a folder) of which not one row is readable.
    """
    points: list[NDArray[np.float32]] = []
    strokes_of, words, bad = [], [], 0
    good_of = Counter[Path]()
    for number, (file, line) in enumerate(_lines(paths)):
        if number < skip:
            continue
        if limit is not None and number >= skip + limit:
            break
        good_of[file] += 0
        try:
            word, strokes = _row(line)
        except (ValueError, KeyError, TypeError, IndexError):
            bad += 1
            continue
        good_of[file] += 1
        points += strokes
        strokes_of.append(len(strokes))
        words.append(word)
    empty = [file.name for file, good in good_of.items() if not good] or ([] if words else [str(p) for p in paths])
    if empty:
        raise ValueError(f"no readable sketch in {', '.join(empty)} ({bad} bad rows): is it Quick, Draw! ndjson?")
    return Sketches(
        points=np.concatenate(points),
        stroke_starts=np.concatenate([[0], np.cumsum([len(p) for p in points])]),
        sketch_starts=np.concatenate([[0], np.cumsum(strokes_of)]),
        words=tuple(words),
        bad_rows=bad,
    )


def _lines(paths: Sequence[Path]) -> Iterator[tuple[Path, bytes]]:
    for path in paths:
        for file in ndjson_files(path):
            with gzip.open(file) if file.suffix == ".gz" else file.open("rb") as stream:
                yield from zip(itertools.repeat(file), stream, strict=False)


def _row(line: bytes) -> tuple[str, Strokes]:
    row = json.loads(line)
    strokes = [np.array(stroke[:2], np.float32).T for stroke in row["drawing"]]
    if not strokes or any(s.ndim != 2 or not np.isfinite(s).all() for s in strokes):
        raise ValueError("no drawing")
    if np.ptp(np.concatenate(strokes), axis=0).max() <= 0:
        raise ValueError("all points in one place")
    return str(row["word"]), strokes
