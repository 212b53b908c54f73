"""How well a labelling agrees with the truth: intersection over union, pooled over all pixels of all pages."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

CLASSES = ("background", "lines", "corners")


class Confusion:
    """Counts of (true class, said class) over everything that was added."""

    def __init__(self) -> None:
        self.counts = np.zeros((len(CLASSES), len(CLASSES)), np.int64)

    def add(self, said: NDArray[np.integer], true: NDArray[np.integer]) -> None:
        """Labels of any one shape, said 0..2, true 0..3: where the truth is unsure nothing is counted."""
        n = len(CLASSES)
        said, true = said[true < n], true[true < n]
        self.counts += np.bincount(true.ravel().astype(np.int64) * n + said.ravel(), minlength=n * n).reshape(n, n)

    def percent(self) -> dict[str, float]:
        """IoU of each class and their mean, in percent. A class that occurs in neither counts as 100."""
        hit = np.diag(self.counts).astype(float)
        union = self.counts.sum(0) + self.counts.sum(1) - hit
        iou = np.where(union > 0, 100.0 * hit / np.maximum(union, 1), 100.0)
        return {"mean": float(iou.mean())} | dict(zip(CLASSES, map(float, iou), strict=True))
