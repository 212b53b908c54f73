"""Photo-like pictures, 256 px: light that falls off, blur, noise, JPEG; and harder ones."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from daemon.shapes import Map, Points
from tests.benchmarks.fidelity.known import PEN_PX, Known
from tests.benchmarks.fidelity.subjects import subjects
from tests.benchmarks.fidelity.wear import Camera, Paper, Random, inked, light, shadow, sheet_of, smooth, taken

SIDE_PX = 256
_HARD_PX = 320
_SQUARES = 18
_SQUARE_PX = 1.1


def photos() -> list[Known]:
    """Forty: the light falls off to 55 to 80 %, the ink is 70 to 100 % dark; noise of 4 levels, JPEG of quality 85."""
    return [_photo(name, strokes, random) for name, strokes, random in subjects()]


def _photo(name: str, subject: list[Points], random: Random) -> Known:
    strokes = [points * SIDE_PX / 100 - 0.5 for points in subject]
    shape = (SIDE_PX, SIDE_PX)
    page = sheet_of(shape, Paper(), random) * (1 - random.uniform(0.7, 1.0) * inked(strokes, shape, PEN_PX))
    lit = page * light(shape, random, darkest=random.uniform(0.55, 0.8))
    return Known(name, strokes, SIDE_PX, given=taken(np.asarray(lit, np.float32), Camera(), random))


def hard_photos() -> list[Known]:
    """The same on textured squared paper, in a shadow, taken from an angle; every second one shows the desk, too.

    Those on the desk are pictures of 320 px, the sheet about 256 of them. The squares are 18 to a side, 12 to 22 %
    dark; the shadow takes 15 to 45 % of the light over an edge of 3 to 20 px.
    """
    every = list(subjects())
    return [
        _hard(name, strokes, random, on_desk=number % 2 == 1) for number, (name, strokes, random) in enumerate(every)
    ]


def _hard(name: str, subject: list[Points], random: Random, *, on_desk: bool) -> Known:
    side_px = _HARD_PX if on_desk else SIDE_PX
    view = _View.of(side_px, random, on_desk=on_desk)
    strokes = [view.seen(points) for points in subject]
    shape = (side_px, side_px)
    page = sheet_of(shape, Paper(tone=random.uniform(0.82, 0.95), texture=0.012), random)
    page *= 1 - random.uniform(0.12, 0.22) * inked(view.squares(), shape, _SQUARE_PX)
    page *= 1 - random.uniform(0.75, 1.0) * inked(strokes, shape, PEN_PX)
    if on_desk:
        page = view.on_desk(page, random)
    page *= light(shape, random, darkest=random.uniform(0.65, 0.9))
    page *= shadow(shape, random, depth=random.uniform(0.15, 0.45), edge_px=random.uniform(1, 5))
    return Known(name, strokes, side_px, given=taken(np.asarray(page, np.float32), Camera(noise=3.0), random))


@dataclass(frozen=True, slots=True)
class _View:
    """How a sheet that spans 0..100 lies in the picture: homography, sheet to px."""

    side_px: int
    turn: Points

    @classmethod
    def of(cls, side_px: int, random: Random, *, on_desk: bool) -> _View:
        """On the desk all four corners are seen; otherwise they lie just outside the picture."""
        inset = side_px * (random.uniform(0.05, 0.15, (4, 2)) if on_desk else -random.uniform(0.0, 0.06, (4, 2)))
        inward = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]])
        corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) * (side_px - 1.0) + inward * inset
        sheet = np.array([[0, 0], [100, 0], [100, 100], [0, 100]], np.float32)
        return cls(side_px, np.asarray(cv2.getPerspectiveTransform(sheet, corners.astype(np.float32)), float))

    def seen(self, points: Points) -> Points:
        """From the sheet to the picture; long straight pieces stay straight."""
        spread = np.concatenate([points, np.ones((len(points), 1))], axis=1) @ self.turn.T
        return np.asarray(spread[:, :2] / spread[:, 2:])

    def squares(self) -> list[Points]:
        ticks = np.linspace(-10, 110, round(1.2 * _SQUARES) + 1)
        lines = [[(-10, tick), (110, tick)] for tick in ticks] + [[(tick, -10), (tick, 110)] for tick in ticks]
        return [self.seen(np.array(line, float)) for line in lines]

    def on_desk(self, page: Map, random: Random) -> Map:
        """The sheet on a grained desk, dark or of wood, with a soft shade along its edges."""
        corners = self.seen(np.array([[0, 0], [100, 0], [100, 100], [0, 100]], float))
        mask = np.zeros(page.shape, np.uint8)
        cv2.fillConvexPoly(mask, np.rint(corners * 16).astype(np.int32), 255, cv2.LINE_AA, 4)
        sheet = mask.astype(np.float32) / 255
        grain = smooth(random.standard_normal(page.shape, np.float32), 2.5)
        desk = random.uniform(0.15, 0.5) * (1 + 0.08 * grain / grain.std()) * (1 - 0.3 * smooth(sheet, 4.0))
        return np.asarray(page * sheet + desk * (1 - sheet), np.float32)
