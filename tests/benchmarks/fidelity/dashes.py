"""Short marks, 512 px: dashed and dotted lines, dots on letters, ticks on a scale and beside nothing."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from daemon.shapes import Points
from tests.benchmarks.fidelity.curves import fine_ring, known
from tests.benchmarks.fidelity.known import PEN_PX, Known
from tests.drawings.hand import line

SIDE_PX = 512
_PEN = PEN_PX * 100 / SIDE_PX
"""Of the hundred that a drawing spans."""


def dashes() -> list[Known]:
    """Eleven; how long and how far apart their marks are is in widths of the pen, from middle to middle of its ends."""
    return [known(name, subject(), SIDE_PX) for name, subject in SUBJECTS.items()]


def dashed(on: float, off: float) -> list[Points]:
    """A level, a plumb and a slanting line, a ring and a wave, all dashed."""
    x = np.linspace(6, 94, 400)
    ways = [
        line((6, 6), (94, 6)),
        line((6, 12), (6, 94)),
        line((14, 90), (60, 14)),
        fine_ring(66, 46, 20),
        np.stack([x, 88 + 5 * np.sin(x / 8)], axis=1)[80:],
    ]
    return [piece for way in ways for piece in _pieces(way, on * _PEN, (off + 1) * _PEN)]


def _pieces(way: Points, on: float, off: float) -> list[Points]:
    """on: how long the pen is led; off: how far to where it is lowered again."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(way, axis=0).T))])
    at = [np.linspace(begin, begin + on, 9 if on else 1) for begin in np.arange(0, along[-1] - on, on + off)]
    return [np.stack([np.interp(each, along, column) for column in way.T], axis=1) for each in at]


def scale(tick: float) -> list[Points]:
    """A line with ticks on one side, every fifth twice as long, and a ring of ticks as on a clock."""
    strokes = [line((6, 20), (94, 20))]
    for number, x in enumerate(np.linspace(8, 92, 22)):
        strokes.append(line((x, 20), (x, 20 - (2 if number % 5 == 0 else 1) * tick * _PEN)))
    strokes.append(fine_ring(50, 62, 30))
    for angle in np.arange(24) * np.pi / 12 + 0.05:
        way = np.array([np.cos(angle), np.sin(angle)])
        strokes.append(np.array([50, 62]) + np.outer([30, 30 - tick * _PEN], way))
    return strokes


def letters() -> list[Points]:
    """Rows of i, of i with two dots, and of commas, in four sizes."""
    strokes: list[Points] = []
    for row, size in enumerate((4.0, 6.0, 9.0, 14.0)):
        y = (12, 28, 50, 82)[row]
        for x in np.arange(8, 92, 1.4 * size):
            strokes += [line((x, y), (x, y + size)), np.array([[x, y - max(0.45 * size, 2.2 * _PEN)]])]
    return strokes


def crosses() -> list[Points]:
    """Short strokes beside nothing: pluses, crosses, equals signs and colons."""
    strokes: list[Points] = []
    for row, half in enumerate((1.2, 1.8, 2.6, 4.0)):
        y = 12 + 25 * row
        for x in (10, 20):
            strokes += [line((x - half, y), (x + half, y)), line((x, y - half), (x, y + half))]
        for x in (34, 46):
            strokes += [
                line((x - half, y - half), (x + half, y + half)),
                line((x - half, y + half), (x + half, y - half)),
            ]
        for x in (60, 72):
            strokes += [line((x - half, y + up), (x + half, y + up)) for up in (-1.2, 1.2)]
        strokes += [np.array([[x, y + up]]) for x in (84, 90) for up in (-half / 2 - 1, half / 2 + 1)]
    return strokes


SUBJECTS: dict[str, Callable[[], list[Points]]] = {
    **{
        f"dashes of {on:g}, {off:g} apart": partial(dashed, on, off)
        for on, off in ((1, 2), (2, 1), (2, 3), (5, 2), (9, 4))
    },
    **{f"dots {off:g} apart": partial(dashed, 0, off) for off in (1, 3)},
    **{f"ticks of {tick:g}": partial(scale, tick) for tick in (2.0, 4.0)},
    "letters": letters,
    "crosses": crosses,
}
