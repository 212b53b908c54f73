"""Training canvases, rendered on the fly: one number in, always the same canvas out.

Two families. *Paper*: the reference rendering, half of the canvases with two or three sketches on them. *Curved*: raw
pen paths and splines, smooth, 1 to 6 px wide, some zoomed beyond the canvas (a tile of a large page), some as a real
page looks (training/appearance.py).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from training.appearance import worn
from training.curves import curves, smooth, splines
from training.quickdraw import Sketches
from training.render import BORDER_PX, CANVAS_PX, Points, Sample, fit, polylines

_SIMPLIFIED, _RAW = 0, 1
DRAWN_BY_RULE = 0.3
"""Share of the curved sketches that are splines: rounder than what a mouse draws."""
LINE_PX, LINE_SHARES = (1, 2, 3, 4, 5, 6), (0.13, 0.35, 0.3, 0.12, 0.06, 0.04)
"""Widths of curved ink: a page is brought near 3 px before the network reads it (daemon/page/line_width.py)."""
DENSE_POWER = 1.0
"""A sketch of n points is drawn in proportion to n ** this: a few scribbles hold most of the pixels that go wrong."""

Random = np.random.Generator


@dataclass(frozen=True, slots=True, eq=False)
class Batch:
    """ink: float32 (N, 1, S, S) in 0..1. label: int64 (N, S, S)."""

    ink: NDArray[np.float32]
    label: NDArray[np.int64]


class Source(Protocol):
    """Where a run takes its canvases from."""

    def batch(self, first: int, count: int, *, curved: float, canvas_px: int = CANVAS_PX) -> Batch:
        """Canvases first .. first + count: the same whenever they are asked for."""


class Canvases:
    """Canvas `index` of the run `seed`: the same whenever, and in whatever order, it is asked for."""

    def __init__(self, simplified: Sketches, raw: Sketches | None, *, seed: int, worn: float = 0.5) -> None:
        """worn: share of the curved canvases that look like a scan."""
        self._seed, self._worn = seed, worn
        self._sources = [simplified, raw or simplified]
        self._cumulated = [np.cumsum(source.sampling_weights(dense=DENSE_POWER)) for source in self._sources]

    def sample(self, index: int, *, curved: float, canvas_px: int = CANVAS_PX) -> Sample:
        """`curved` is the share of canvases of the second family."""
        random = np.random.default_rng((self._seed, index))
        family = self._curved if random.random() < curved else self._paper
        return family(random, canvas_px)

    def batch(self, first: int, count: int, *, curved: float, canvas_px: int = CANVAS_PX) -> Batch:
        return stack([self.sample(first + k, curved=curved, canvas_px=canvas_px) for k in range(count)])

    def _paper(self, random: Random, canvas_px: int) -> Sample:
        strokes = fit([t for s in self._sketches(_SIMPLIFIED, random) for t in s], canvas_px, canvas_px - 2 * BORDER_PX)
        return polylines(strokes, canvas_px)

    def _curved(self, random: Random, canvas_px: int) -> Sample:
        sigma = random.uniform(0.8, 2.0)
        strokes = [smooth(t, sigma) for s in self._sketches(_RAW, random) for t in s if len(t) > 1]
        if not strokes:
            return self._paper(random, canvas_px)
        zoom = random.uniform(1.2, 2.5) if random.random() < 0.35 else random.uniform(0.5, 1.0)
        sketch_px = zoom * (canvas_px - 2 * BORDER_PX)
        slack_px = abs(canvas_px - sketch_px) / 2 * (1.0 if zoom > 1 else 0.8)
        shift = random.uniform(-slack_px, slack_px, 2)
        placed = [t + shift for t in fit(strokes, canvas_px, sketch_px)]
        line_px = int(random.choice(LINE_PX, p=LINE_SHARES))
        sample = curves(placed, canvas_px, line_px)
        return worn(sample, random, line_px=line_px) if random.random() < self._worn else sample

    def _sketches(self, source: int, random: Random) -> list[list[Points]]:
        """One, two or three sketches turned, mirrored and stretched, each in a unit box moved and scaled at random."""
        count = int(random.choice([1, 2, 3], p=[0.4, 0.35, 0.25]))
        return [self._turned(self._sketch(source, random), random) for _ in range(count)]

    def _sketch(self, source: int, random: Random) -> Sequence[Points]:
        if source == _RAW and random.random() < DRAWN_BY_RULE:
            return splines(random)
        sketches = self._sources[source]
        pick = int(np.searchsorted(self._cumulated[source], random.random()))
        return sketches[min(pick, len(sketches) - 1)]

    @staticmethod
    def _turned(strokes: Sequence[NDArray[np.floating]], random: Random) -> list[Points]:
        angle, stretch = random.uniform(0, 2 * np.pi), np.exp(random.uniform(-0.3, 0.3, 2))
        cos, sin = np.cos(angle), np.sin(angle)
        matrix = np.array([[cos, -sin], [sin, cos]]) * stretch * random.choice([-1, 1], 2)
        turned = fit([(stroke @ matrix) for stroke in strokes], 1, random.uniform(0.6, 1.0))
        shift = random.uniform(-0.25, 0.25, 2)
        return [t + shift for t in turned]


def stack(samples: Sequence[Sample]) -> Batch:
    return Batch(
        np.stack([s.ink for s in samples])[:, None].astype(np.float32) / 255.0,
        np.stack([s.label for s in samples]).astype(np.int64),
    )
