"""Technical drawings, 512 px: hatches at several angles, a grid, a plan, rings, chords and a mesh."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from daemon.shapes import Points
from tests.benchmarks.fidelity.curves import fine_ring, known
from tests.benchmarks.fidelity.known import Known
from tests.drawings import signs
from tests.drawings.hand import line

SIDE_PX = 512


def technical() -> list[Known]:
    return [known(name, subject(), SIDE_PX) for name, subject in SUBJECTS.items()]


def hatch() -> list[Points]:
    """Four fields of parallel lines, each at its own angle and pitch, in a frame they do not touch."""
    fields = [(27, 27, 15, 2.2), (73, 27, 45, 2.8), (27, 73, 80, 2.0), (73, 73, 120, 3.4)]
    strokes = [line((4, 4), (96, 4), (96, 96), (4, 96), (4, 4))]
    for x, y, degrees, pitch in fields:
        strokes += _hatched(np.array([x, y], float), 20.0, np.radians(degrees), pitch)
    return strokes


def _hatched(middle: Points, half: float, angle: float, pitch: float) -> list[Points]:
    along, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    lines = []
    for offset in np.arange(-half + pitch, half, pitch):
        reach = float(np.sqrt(half**2 - offset**2)) * along
        lines.append(np.array([middle + offset * across - reach, middle + offset * across + reach]))
    return lines


def cross_hatch() -> list[Points]:
    """Two hatches over each other at an acute angle in a ring that they do not touch."""
    middle = np.array([50.0, 50.0])
    return [
        fine_ring(50, 50, 44),
        *_hatched(middle, 41.0, np.radians(20), 5.5),
        *_hatched(middle, 41.0, np.radians(65), 6.5),
    ]


def grid() -> list[Points]:
    ticks = np.linspace(8, 92, 13)
    return [line((8, y), (92, y)) for y in ticks] + [line((x, 8), (x, 92)) for x in ticks]


def rings() -> list[Points]:
    """Rings around two middles, crossing each other at all angles."""
    return [fine_ring(x, 50, 5.0 * i) for x in (38.6, 61.4) for i in range(1, 8)] + [line((4, 50), (96, 50))]


def chords() -> list[Points]:
    """The diagonals of a nonagon and their circle: acute crossings and nine lines into each corner."""
    angle = np.arange(9) * 2 * np.pi / 9 + 0.1
    corners = np.stack([50 + 44 * np.cos(angle), 50 + 44 * np.sin(angle)], axis=1)
    return [fine_ring(50, 50, 44), *(corners[[i, j]] for i in range(9) for j in range(i))]


def mesh() -> list[Points]:
    """Triangles over jittered corners, each edge a stroke."""
    rng = np.random.default_rng(5)
    rows, columns = 7, 6
    at = np.array([[[10 + 15 * c + 7 * (r % 2) - 3, 9 + 13.5 * r] for c in range(columns)] for r in range(rows)])
    at = at + rng.uniform(-2.5, 2.5, at.shape)
    beside = [(r, c, r, c + 1) for r in range(rows) for c in range(columns - 1)]
    below = [
        (r, c, r + 1, c + d) for r in range(rows - 1) for c in range(columns) for d in ((0, 1), (-1, 0))[1 - r % 2]
    ]
    pairs = [pair for pair in beside + below if 0 <= pair[3] < columns]
    return [np.array([at[a, b], at[c, d]]) for a, b, c, d in pairs]


SUBJECTS: dict[str, Callable[[], list[Points]]] = {
    "hatch": hatch,
    "plan": signs.plan,
    "grid": grid,
    "rings": rings,
    "chords": chords,
    "mesh": mesh,
    "cross-hatch": cross_hatch,
}
