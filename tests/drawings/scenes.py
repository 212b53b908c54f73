"""What is drawn, in hundredths of the sheet's side: things that people draw."""

from __future__ import annotations

import numpy as np

from daemon.shapes import Points
from tests.drawings.hand import curve, line, ring


def house() -> list[Points]:
    return [
        line((18, 50), (18, 86), (72, 86), (72, 50)),
        line((11, 53), (45, 20), (79, 53)),
        line((58, 32.5), (58, 20), (66, 20), (66, 40)),
        line((38, 86), (38, 64), (51, 64), (51, 86)),
        line((24, 58), (33, 58), (33, 69), (24, 69), (24, 58)),
        line((28.5, 58), (28.5, 69)),
        line((24, 63.5), (33, 63.5)),
        line((57, 58), (66, 58), (66, 69), (57, 69), (57, 58)),
        line((61.5, 58), (61.5, 69)),
        line((57, 63.5), (66, 63.5)),
        ring(48.5, 76, 0.9),
        curve((62, 16), (60, 12), (65, 9), (63, 5)),
        curve((4, 87), (9, 85), (14, 87), (18, 86)),
        curve((72, 86), (80, 88), (88, 85), (96, 87)),
        line((87, 86), (87, 68)),
        curve((87, 68), (80, 67), (78, 60), (82, 54), (88, 52), (94, 56), (95, 63), (91, 68), (87, 68)),
    ]


def spiral() -> list[Points]:
    angle = np.linspace(0, 2 * np.pi * 6, 700)
    radius = 2 + 6.4 * angle / (2 * np.pi)
    return [np.stack([50 + radius * np.cos(angle), 50 + radius * np.sin(angle)], axis=1)]


def hatch() -> list[Points]:
    """A ball and its shadow, shaded by parallel lines."""
    ball, lines = ring(46, 42, 30), []
    for offset in np.arange(-22, 30, 5.2):
        half = np.sqrt(max(30**2 - offset**2, 0))
        along = np.array([1.0, -1.0]) / np.sqrt(2)
        middle = np.array([46, 42]) + offset * np.array([1.0, 1.0]) / np.sqrt(2)
        begin, end = middle - along * half * 0.9, middle + along * half * (0.1 + 0.02 * offset)
        lines.append(np.array([begin, end]))
    shadow = [line((20 + 7 * i, 88 - 0.4 * i), (34 + 7 * i, 79 - 0.4 * i)) for i in range(8)]
    return [ball, *lines, *shadow]


def face() -> list[Points]:
    return [
        curve(
            (50, 12),
            (70, 18),
            (80, 38),
            (76, 62),
            (64, 82),
            (50, 90),
            (36, 82),
            (24, 62),
            (20, 38),
            (30, 18),
            closed=True,
        ),
        curve((30, 42), (36, 37), (43, 42), (36, 46), closed=True),
        curve((57, 42), (64, 37), (70, 42), (64, 46), closed=True),
        ring(36.5, 41.5, 1.6),
        ring(63.5, 41.5, 1.6),
        curve((28, 35), (35, 30.5), (43, 33)),
        curve((57, 33), (65, 30.5), (72, 35)),
        curve((51, 43), (48, 54), (45, 60), (49, 62.5), (54, 61)),
        curve((37, 71), (43, 74.5), (50, 76), (58, 74.5), (64, 70)),
        curve((43, 71.5), (50, 72.5), (58, 71)),
        curve((19, 44), (13, 42), (13, 53), (18, 60), (22.5, 58)),
        curve((81, 44), (87, 42), (87, 53), (82, 60), (77.5, 58)),
        curve((25, 28), (34, 22), (40, 8), (46, 20), (54, 6), (60, 20), (70, 12), (76, 29)),
    ]


def star() -> list[Points]:
    """The five-pointed star that is drawn without lifting the pen, and a few small ones."""

    def drawn(x: float, y: float, radius: float) -> Points:
        angle = np.radians(-90 + 144 * np.arange(6))
        return np.stack([x + radius * np.cos(angle), y + radius * np.sin(angle)], axis=1)

    return [drawn(46, 54, 36), drawn(85, 18, 9), drawn(12, 17, 7), drawn(89, 84, 7)]


def grid() -> list[Points]:
    """Noughts and crosses, played."""
    across = [line((8, y), (92, y)) for y in (22, 36, 50, 64, 78)]
    down = [line((x, 8), (x, 92)) for x in (22, 36, 50, 64, 78)]
    crosses = [
        stroke
        for x, y in ((43, 43), (57, 57), (29, 29), (71, 43))
        for stroke in (line((x - 4, y - 4), (x + 4, y + 4)), line((x + 4, y - 4), (x - 4, y + 4)))
    ]
    return across + down + crosses + [ring(x, y, 4.3) for x, y in ((43, 57), (57, 43), (71, 71))]


def cat() -> list[Points]:
    return [
        curve(
            (31, 33),
            (30, 16),
            (40, 23),
            (48, 22),
            (57, 23),
            (67, 16),
            (66, 33),
            (70, 42),
            (62, 54),
            (48, 57),
            (34, 54),
            (27, 43),
            closed=True,
        ),
        curve((33, 54), (22, 68), (22, 86), (32, 91), (48, 91), (66, 91), (75, 84), (72, 66), (63, 54)),
        curve((74, 84), (86, 86), (92, 76), (86, 66), (88, 58), (94, 60)),
        ring(40, 38, 2.6, 1.3),
        ring(57, 38, 2.6, 1.3),
        line((46, 45), (51, 45), (48.5, 47.5), (46, 45)),
        curve((48.5, 47.5), (47.5, 51), (43, 51.5)),
        curve((48.5, 47.5), (49.5, 51), (54, 51.5)),
        line((24, 44), (38, 46)),
        line((23, 50), (38, 48.5)),
        line((73, 44), (59, 46)),
        line((74, 50), (59, 48.5)),
        curve((41, 91), (42, 80), (40, 70)),
        curve((56, 91), (55, 80), (57, 70)),
    ]


def fish() -> list[Points]:
    return [
        curve(
            (14, 50), (26, 34), (46, 28), (64, 40), (76, 50), (90, 34), (88, 50), (91, 67), (76, 52), (62, 64), (44, 72)
        ),
        curve((44, 72), (26, 66), (14, 50)),
        curve((36, 31), (42, 18), (56, 20), (58, 35)),
        curve((46, 50), (56, 47), (58, 55), (48, 58)),
        curve((37, 34), (42, 46), (41, 58), (36, 68)),
        ring(27, 46, 3.2),
        ring(12, 28, 4),
        ring(21, 16, 5.5),
        curve((8, 88), (22, 83), (36, 89), (50, 84), (64, 89), (78, 83), (92, 88)),
    ]


def flower() -> list[Points]:
    petals = []
    for turn in np.radians(np.arange(0, 360, 60)):
        out, side = np.array([np.cos(turn), np.sin(turn)]), np.array([-np.sin(turn), np.cos(turn)])
        shape = [(7, -2.5), (15, -8), (24, -5), (25, 1), (22, 7), (14, 8), (7, 3)]
        petals.append(curve(*[tuple(np.array([50, 32]) + far * out + off * side) for far, off in shape]))
    stem = curve((50, 40), (53, 56), (48, 74), (51, 94))
    leaves = [
        curve((49.5, 78), (36, 77), (26, 66), (22, 58), (36, 60), (46, 69), (49.5, 78)),
        curve((50.5, 68), (60, 66), (72, 56), (76, 50), (64, 51), (54, 59), (50.5, 68)),
        curve((49.5, 78), (38, 70), (29, 63)),
    ]
    return [ring(50, 32, 7), *petals, stem, *leaves]
