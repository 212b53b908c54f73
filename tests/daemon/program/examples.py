"""A toolpath that has everything: a line, a closed shape, a dot."""

from __future__ import annotations

import numpy as np

from daemon.shapes import Stroke, Toolpath

LINE = Stroke(np.array([[30.0, 40.0], [30.0, 50.5], [41.25, 50.5]]))
SQUARE = Stroke(np.array([[50.0, 30.0], [60, 30], [60, 40], [50, 40], [50, 30]]))
DOT = Stroke(np.array([[12.3456, -0.0001]]))
TOOLPATH = Toolpath((LINE, SQUARE, DOT), np.array([[1.0, 0, 0], [0, -1, 0]]), park_mm=(0.0, 80.0))
