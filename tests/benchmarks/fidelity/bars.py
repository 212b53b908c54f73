"""The figures of a set and the bars they are held against."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from tests.benchmarks.fidelity.measure import Measure


@dataclass(frozen=True, slots=True)
class Scored:
    """One drawing as one tool has traced it."""

    name: str
    measure: Measure
    cpu_ms: float
    network_cpu_ms: float = 0.0


@dataclass(frozen=True, slots=True)
class Bar:
    """What a figure should be: not below low, not above high."""

    low: float = -math.inf
    high: float = math.inf

    def __str__(self) -> str:
        if math.isfinite(self.low) and math.isfinite(self.high):
            return f"{self.low:g} to {self.high:g}"
        return f">= {self.low:g}" if math.isfinite(self.low) else f"<= {self.high:g}"

    def met(self, value: float) -> bool:
        return self.low <= value <= self.high


def mean_of(field: str) -> Callable[[Sequence[Scored]], float]:
    def mean(scores: Sequence[Scored]) -> float:
        return float(np.nanmean([getattr(score.measure, field) for score in scores]))

    return mean


def worst_f1(scores: Sequence[Scored]) -> float:
    """Mean F1 of the worst twentieth, one drawing at least."""
    ranked = sorted(score.measure.f1 for score in scores)
    return float(np.mean(ranked[: max(1, len(ranked) // 20)]))


def strokes_together(scores: Sequence[Scored]) -> float:
    """All strokes of the set by the fewest that can draw it: drawings of few strokes weigh little."""
    return sum(score.measure.strokes for score in scores) / sum(score.measure.minimum for score in scores)


def without_network(scores: Sequence[Scored]) -> float:
    return float(np.median([score.cpu_ms - score.network_cpu_ms for score in scores]))


FIGURES: dict[str, Callable[[Sequence[Scored]], float]] = {
    "Chamfer, px": mean_of("chamfer_px"),
    "precision at 1.5 px": mean_of("precision"),
    "recall at 1.5 px": mean_of("recall"),
    "F1": mean_of("f1"),
    "worst 5 %: F1": worst_f1,
    "worst F1": lambda scores: min(score.measure.f1 for score in scores),
    "re-ink IoU": mean_of("iou"),
    "ink recalled": mean_of("ink_recall"),
    "length ratio": mean_of("length_ratio"),
    "strokes / minimum": mean_of("stroke_ratio"),
    "of all together": strokes_together,
    "invented, px": mean_of("invented_px"),
    "pen-up, px": mean_of("pen_up_px"),
    "CPU ms, median": lambda scores: float(np.median([score.cpu_ms for score in scores])),
    "without the network": without_network,
}
"""Means over the drawings of a set, where nothing else is said."""

_MOST_CPU_MS = Bar(high=60)

BARS: dict[str, dict[str, Bar]] = {
    "quickdraw": {
        "Chamfer, px": Bar(high=0.12),
        "precision at 1.5 px": Bar(0.995),
        "recall at 1.5 px": Bar(0.995),
        "worst 5 %: F1": Bar(0.97),
        "re-ink IoU": Bar(0.955),
        "length ratio": Bar(0.97, 1.02),
        "strokes / minimum": Bar(high=1.05),
        "without the network": _MOST_CPU_MS,
    },
    "scribbles": {"ink recalled": Bar(0.98)},
    "curves": {
        "Chamfer, px": Bar(high=0.11),
        "F1": Bar(0.995),
        "re-ink IoU": Bar(0.965),
        "without the network": _MOST_CPU_MS,
    },
    "technical": {
        "F1": Bar(0.99),
        "re-ink IoU": Bar(0.93),
        "length ratio": Bar(0.98, 1.03),
        "strokes / minimum": Bar(high=1.3),
    },
    "photo": {
        "F1": Bar(0.995),
        "worst F1": Bar(0.97),
        "re-ink IoU": Bar(0.93),
        "strokes / minimum": Bar(high=1.2),
    },
    "hard photo": {"F1": Bar(0.985), "worst F1": Bar(0.95), "invented, px": Bar(high=0.0)},
    "scan": {"F1": Bar(0.99), "worst F1": Bar(0.95)},
    "overdrawn": {"F1": Bar(0.99), "strokes / minimum": Bar(high=1.3)},
    "dashes": {"F1": Bar(0.99), "worst F1": Bar(0.97), "strokes / minimum": Bar(0.98, 1.02)},
    "apart": {"F1": Bar(0.98), "strokes / minimum": Bar(high=1.5)},
}
