"""What is drawn, in hundredths of the sheet's side: writing, plans and signs."""

from __future__ import annotations

import numpy as np

from daemon.shapes import Points
from tests.drawings.hand import Pairs, curve, line, ring

_BASE = 60.0
# Cursive letters: width, and the points that the pen passes; the base line lies at 60, small letters reach up to 42.
_LETTERS: dict[str, tuple[float, Pairs]] = {
    "h": (18, [(5, 44), (10, 22), (7, 13), (3.5, 24), (3.5, 59), (5, 52), (9.5, 43), (13, 47), (13, 56), (15.5, 60)]),
    "e": (13, [(4, 55), (9, 49), (9, 43), (5.5, 42), (3, 49), (4, 57), (8, 60)]),
    "l": (12, [(4, 48), (9, 24), (7.5, 13), (4, 19), (3.5, 40), (4.5, 56), (8, 60)]),
    "o": (15, [(6, 50), (10, 43.5), (5, 43), (2, 51), (5, 59), (10, 57), (12, 49), (9.5, 43.5), (12, 46.5)]),
    "i": (10, [(3, 52), (5.5, 43), (4.8, 52), (5.5, 59), (7.5, 60)]),
    "n": (20, [(2.5, 46), (4, 43), (5, 50), (4.5, 60), (7, 47), (10.5, 43), (13.5, 47), (13.5, 56), (16, 60)]),
}


def script() -> list[Points]:
    """Two words of joined-up writing."""
    dot = np.array([[48.5, 69.0]])
    return [_word("hello", x=12, base=46, scale=0.86), _word("line", x=28, base=93, scale=0.86), dot]


def _word(text: str, *, x: float, base: float, scale: float) -> Points:
    pairs: list[tuple[float, float]] = [(-3, 58)]
    at = 0.0
    for letter in text:
        width, points = _LETTERS[letter]
        pairs += [(at + px, py) for px, py in points]
        at += width
    pairs.append((at + 2, 45 if text.endswith("o") else 54))
    slant = [(px + 0.22 * (_BASE - py), py) for px, py in pairs]
    return curve(*[(x + scale * px, base + scale * (py - _BASE)) for px, py in slant])


def plan() -> list[Points]:
    """A small flat: outer and inner walls, doors with the arc they swing, a table and stairs."""
    outer = line((10, 14), (90, 14), (90, 84), (10, 84), (10, 14))
    walls = [
        line((46, 14), (46, 34)),
        line((46, 46), (46, 84)),
        line((46, 52), (62, 52)),
        line((74, 52), (90, 52)),
        line((10, 50), (26, 50)),
        line((38, 50), (46, 50)),
    ]
    doors = [
        line((46, 46), (58, 46)),
        ring(46, 46, 12, start=0, turn=-90),
        line((62, 52), (62, 64)),
        ring(62, 52, 12, start=90, turn=-90),
        line((38, 50), (38, 62)),
        ring(38, 50, 12, start=90, turn=90),
    ]
    stairs = [line((66, 20), (66, 32), (86, 32), (86, 20), (66, 20))]
    stairs += [line((x, 20), (x, 32)) for x in (70, 74, 78, 82)]
    table = [ring(27, 30, 7), line((20, 66), (32, 66), (32, 78), (20, 78), (20, 66)), line((20, 70), (32, 70))]
    return [outer, *walls, *doors, *stairs, *table]


def dashes() -> list[Points]:
    """A treasure map: an island, a dashed way, dots, a cross."""
    shore = curve(
        (14, 30), (26, 14), (46, 18), (64, 10), (84, 24), (90, 46), (82, 66), (86, 82), (64, 90), (42, 84), (24, 90),
        (10, 72), (18, 52), closed=True,
    )  # fmt: skip
    way = curve((24, 74), (34, 62), (30, 48), (40, 36), (54, 40), (60, 54), (72, 58), (76, 44), (70, 32))
    cross = [line((66, 24), (74, 32)), line((74, 24), (66, 32))]
    trees = [curve((46 + dx, 70), (48 + dx, 62), (51 + dx, 62), (53 + dx, 70)) for dx in (0, 10, -10)]
    dots = [
        np.array([[x, y]], float)
        for x, y in ((38, 24), (44, 27), (50, 25), (56, 28), (32, 28), (72, 74), (66, 77), (76, 68))
    ]
    return [shore, *_dashed(way, 4.4, 3.0), *cross, *trees, *dots]


def _dashed(points: Points, on: float, off: float) -> list[Points]:
    lengths = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    pieces = []
    for begin in np.arange(0, lengths[-1] - on, on + off):
        at = np.linspace(begin, begin + on, 6)
        pieces.append(np.stack([np.interp(at, lengths, column) for column in points.T], axis=1))
    return pieces
