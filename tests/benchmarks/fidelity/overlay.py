"""The drawn strokes over the true ones, and where one has no counterpart in the other, as a picture."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from daemon.report import canvas
from daemon.report.canvas import Picture
from daemon.shapes import Points
from tests.benchmarks.fidelity.known import Known
from tests.benchmarks.fidelity.measure import distances, samples

_SIDE_PX = 1024


def overlay(known: Known, drawn: Sequence[Points]) -> Picture:
    """Pale ink; true lines blue, drawn ones red from a ring on; orange: not drawn, green: drawn but not true."""
    scale = _SIDE_PX / known.side_px
    pale = np.asarray(190 + known.grey * (65 / 255), np.uint8)
    size = [round(side * scale) for side in pale.shape[::-1]]
    large = cv2.resize(pale, size, interpolation=cv2.INTER_NEAREST)
    picture = np.asarray(cv2.cvtColor(large, cv2.COLOR_GRAY2BGR), np.uint8)
    for stroke in known.strokes:
        canvas.line(picture, (stroke + 0.5) * scale - 0.5, canvas.BLUE)
    for stroke in drawn:
        canvas.line(picture, (stroke + 0.5) * scale - 0.5, canvas.RED, 3)
        canvas.dot(picture, (stroke[0] + 0.5) * scale - 0.5, 4, canvas.PAPER, canvas.RED)
    true, ours = samples(known.strokes), samples(drawn)
    for some, others, colour in ((true, ours, canvas.ORANGE), (ours, true, canvas.GREEN)):
        for point in some[distances(some, others) > known.within_px]:
            canvas.dot(picture, (point + 0.5) * scale - 0.5, 3, colour)
    return picture
