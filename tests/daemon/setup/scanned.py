"""A sheet as a scanner or a camera sees it: ink in mm becomes a grey picture."""

from __future__ import annotations

import math
from collections.abc import Sequence

import cv2
import numpy as np

from daemon.setup.card import Card
from daemon.shapes import Grey, Points
from firmware_protocol.crooked import Crooked, CrookedInk
from firmware_protocol.ink import PenRule, Polyline

SHEET_MM = (148.0, 210.0)
PX_PER_MM = 300 / 25.4
_BITS = 6


def scanned(
    ink: Sequence[Polyline],
    *,
    px_per_mm: float = PX_PER_MM,
    turned_deg: float = 1.3,
    pen_mm: float = 0.45,
    upside_down: bool = False,
) -> Grey:
    """The sheet on the glass, a little askew, in grey paper with grain. ink: mm from the sheet's lower left corner."""
    width_px, height_px = (round(side_mm * px_per_mm) for side_mm in SHEET_MM)
    picture = np.full((height_px, width_px), 232, np.uint8)
    turn = math.radians(turned_deg + (180 if upside_down else 0))
    turned = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
    middle = np.array(SHEET_MM) / 2
    for line in ink:
        places = (np.array(line) - middle) @ turned.T + middle
        px = np.column_stack([places[:, 0], SHEET_MM[1] - places[:, 1]]) * px_per_mm - 0.5
        _draw(picture, px, pen_mm * px_per_mm)
    soft = cv2.GaussianBlur(picture, (0, 0), 0.06 * px_per_mm)
    grain = np.random.default_rng(7).normal(0, 4, soft.shape)
    return np.asarray(np.clip(soft + grain, 0, 255), np.uint8)


def drawn_by(
    lines_mm: Sequence[Points], crooked: Crooked, *, at_mm: tuple[float, float] = (14.0, 40.0)
) -> list[Polyline]:
    """The ink of these lines, in their order, drawn with the sheet's corner as origin by a crooked machine."""
    ink = CrookedInk(PenRule(), crooked)
    at = (0.0, 0.0, 5.0)
    for line_mm in lines_mm:
        points = (line_mm + at_mm).tolist()
        stops = [(*points[0], 5.0), *((x, y, 0.0) for x, y in points), (*points[-1], 5.0)]
        for stop in stops:
            ink.travel(at, stop)
            at = stop
    return ink.polylines


def card_drawn_by(card: Card, crooked: Crooked) -> list[Polyline]:
    return drawn_by(card.strokes_mm, crooked)


def _draw(picture: Grey, px: Points, width_px: float) -> None:
    fixed = [np.rint(px * (1 << _BITS)).astype(np.int32)]
    cv2.polylines(picture, fixed, False, 60, max(1, round(width_px)), cv2.LINE_AA, _BITS)
