"""Curves and junctions, 256 px: circles, splines, spirals, roses, gears, waves and a few things made of them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from daemon.shapes import Points
from tests.benchmarks.fidelity.known import Known
from tests.drawings import scenes
from tests.drawings.hand import curve, line, ring

SIDE_PX = 256
_STEPS = 720


def curves() -> list[Known]:
    return [known(name, subject(), SIDE_PX) for name, subject in SUBJECTS.items()]


def known(name: str, subject: list[Points], side_px: int) -> Known:
    """A subject spans 0..100, the picture -0.5..side - 0.5."""
    return Known(name, [points * side_px / 100 - 0.5 for points in subject], side_px)


def polar(x: float, y: float, radius: Points, angle: Points) -> Points:
    return np.stack([x + radius * np.cos(angle), y + radius * np.sin(angle)], axis=1)


def fine_ring(x: float, y: float, radius: float) -> Points:
    angle = np.linspace(0, 2 * np.pi, _STEPS + 1)
    return polar(x, y, np.full_like(angle, radius), angle)


def circles() -> list[Points]:
    """Rings that cross, hold each other, and stand alone."""
    chain = [fine_ring(22 + 14 * i, 26 + 9 * (i % 2), 11) for i in range(5)]
    return [*chain, fine_ring(32, 70, 21), fine_ring(32, 70, 13), fine_ring(32, 70, 4), fine_ring(74, 70, 15)]


def splines() -> list[Points]:
    """Smooth strokes that cross at many angles."""
    return [
        curve((8, 20), (30, 10), (50, 34), (74, 12), (92, 30)),
        curve((10, 50), (26, 30), (48, 62), (70, 36), (90, 58)),
        curve((8, 84), (30, 60), (46, 88), (66, 66), (92, 86)),
        curve((20, 8), (14, 40), (34, 64), (20, 92)),
        curve((62, 8), (78, 34), (58, 60), (80, 92)),
    ]


def loops() -> list[Points]:
    """Strokes that cross themselves."""
    angle = np.linspace(0, 6 * np.pi, 900)
    coil = np.stack([14 + 3.7 * angle + 9 * np.sin(angle), 28 - 14 * np.cos(angle)], axis=1)
    turn = np.linspace(0, 2 * np.pi, _STEPS + 1)
    knot = np.stack([50 + 38 * np.sin(2 * turn + 0.4), 74 + 19 * np.sin(3 * turn)], axis=1)
    return [coil, knot]


def spiral() -> list[Points]:
    """Two spirals, each its own stroke."""
    angle = np.linspace(0, 9 * np.pi, 1400)
    small = np.linspace(0, 5 * np.pi, 600)
    return [polar(40, 44, 1.5 + 1.2 * angle, angle), polar(80, 82, 1.0 + 0.9 * small, -small)]


def rose(petals: int) -> list[Points]:
    """A rose of Grandi in a ring; its petals meet in the middle."""
    angle = np.linspace(0, np.pi if petals % 2 else 2 * np.pi, 1200)
    return [polar(50, 50, 38 * np.cos(petals * angle), angle), fine_ring(50, 50, 44)]


def gear(teeth: int) -> list[Points]:
    """A toothed wheel with hub and spokes."""
    corner = np.repeat(np.arange(2 * teeth), 2) * np.pi / teeth
    slope = np.tile([0.14, -0.14], 2 * teeth) * np.pi / teeth
    radius = np.tile([34.0, 34.0, 43.0, 43.0], teeth)
    rim = polar(50, 50, radius, corner + np.roll(slope, 1) + 0.5 * np.pi / teeth)
    spokes = [polar(50, 50, np.array([9.0, 26.0]), np.full(2, a)) for a in 0.3 + np.arange(5) * 2 * np.pi / 5]
    return [np.concatenate([rim, rim[:1]]), fine_ring(50, 50, 26), fine_ring(50, 50, 9), *spokes]


def waves() -> list[Points]:
    """Waves over each other and two straight lines through them."""
    x = np.linspace(6, 94, 600)
    swell = [np.stack([x, 18 + 13 * i + 9 * np.sin(0.12 * x + 1.3 * i)], axis=1) for i in range(6)]
    return [*swell, line((12, 8), (70, 94)), line((88, 8), (40, 94))]


def car() -> list[Points]:
    """Straight lines and curves that run into each other."""
    body = curve((6, 64), (8, 52), (26, 48), (38, 32), (62, 31), (76, 48), (92, 52), (95, 64))
    wheels = [fine_ring(x, 68, radius) for x in (27, 75) for radius in (9, 4)]
    sill = [line((6, 64), (18.9, 64)), line((35.1, 64), (66.9, 64)), line((83.1, 64), (95, 64))]
    glass = [line((42, 35), (34, 47), (52, 47), (52, 34.5)), line((52, 47), (70, 47))]
    return [body, *wheels, *sill, *glass, line((2, 77), (98, 77)), ring(90, 57, 2.0)]


SUBJECTS: dict[str, Callable[[], list[Points]]] = {
    "house": scenes.house,
    "face": scenes.face,
    "rose 5": lambda: rose(5),
    "star": scenes.star,
    "spiral": spiral,
    "car": car,
    "gear 12": lambda: gear(12),
    "waves": waves,
    "circles": circles,
    "splines": splines,
    "loops": loops,
    "rose 4": lambda: rose(4),
    "gear 8": lambda: gear(8),
}
