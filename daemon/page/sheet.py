"""The sheet of paper in a photo, seen against what it lies on, is found and straightened."""

from __future__ import annotations

from dataclasses import replace
from itertools import islice

import cv2
import numpy as np

from daemon.ink import Mask
from daemon.page.back import noted
from daemon.page.quads import quads
from daemon.page.sides import Side, sharpened, sides_of
from daemon.page.tones import reduced
from daemon.shapes import Grey, Homography, PageImage, Points

_LOOK_PX, _LEAST_PX = 320, 32
_MARK_SHARE = 20
"""A dark place narrower than the page's side by this is a line, no ground that a sheet lies on."""
_LEVELS = 14
_LEAST_SHEET, _LEAST_GROUND = 0.12, 0.02
"""Shares of the picture."""
_LEAST_CONVEX = 0.94
_LEAST_ALIKE = 0.9
"""So much of what is outside is darker than the level, so much of what is inside lighter."""
_LEAST_STEP, _LEAST_DARK = 0.12, 0.5
"""By so much, as a share, the ground is darker than the sheet: all round it, and where the picture cuts it off."""
_MOST_LOOKS = 400
_FLAT = 1.0
"""Ground of fewer grey levels' deviation has been painted by a program, not seen by a camera."""
_INSET, _BLUR_PX = 0.012, 1.5
"""So much of the sheet along its sides is left out, a share and px: no side is quite straight, no picture sharp."""


def straighten(page: PageImage) -> PageImage:
    """The sheet alone and upright where the ground that it lies on is seen around it; else the page itself.

    A sheet is a light area with straight sides on darker ground: what lies outside differs in tone, all over, from what
    lies inside, so a drawn rectangle is none. Four sides that are seen make it upright (the homography of its corners,
    as wide and as high as the longer of opposite sides); where the picture cuts it off, the ground becomes paper.
    """
    small = reduced(page.grey, _LOOK_PX)
    found = _sides(small) if min(small.shape) >= _LEAST_PX else []
    if not found:
        return page
    scale = max(page.grey.shape) / max(small.shape)
    sides = [sharpened(page.grey, side, scale) for side in found]
    if len(sides) == 4:
        return _upright(page, _corners(sides))
    return noted(page, "ground beside the sheet left out", _without_ground(page.grey, sides))


def _sides(small: Grey) -> list[Side]:
    """The sides of the sheet in the picture made small, those that are seen; none where there is no sheet."""
    mark_px = max(3, max(small.shape) // _MARK_SHARE) | 1
    mark = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (mark_px, mark_px))
    closed = cv2.morphologyEx(small, cv2.MORPH_CLOSE, mark)
    bare: Grey = np.asarray(cv2.GaussianBlur(closed, (0, 0), 1.0), np.uint8)
    dark, bright = np.percentile(bare, [2, 98])
    if bright * (1 - _LEAST_STEP) <= dark:
        return []
    for sides in islice(quads(bare, least_px=_LEAST_SHEET * bare.size), _MOST_LOOKS):
        if all(side.step(bare) >= _LEAST_STEP for side in sides) and _stands_out(bare, small, _inside(sides, bare)):
            return sides
    return _cut_off(bare, small, np.linspace(dark, bright, _LEVELS + 2)[1:-1])


def _inside(sides: list[Side], bare: Grey) -> Mask:
    mask = np.zeros(bare.shape, np.uint8)
    cv2.fillConvexPoly(mask, np.rint([side.start for side in sides]).astype(np.int32), 1)
    return mask > 0


def _stands_out(bare: Grey, small: Grey, inside: Mask) -> bool:
    """Whether what lies outside is darker all over, seen by a camera, and no more than it may be."""
    if not _LEAST_SHEET <= inside.mean() <= 1 - _LEAST_GROUND or _painted(small, inside):
        return False
    return float(np.median(bare[~inside])) <= (1 - _LEAST_STEP) * float(np.median(bare[inside]))


def _cut_off(bare: Grey, small: Grey, levels: Points) -> list[Side]:
    """The sides of a sheet that the picture cuts off, of the clearest light area above some levels.

    The edge of a shadow is straight, too: the ground must be darker than paper in a shadow is.
    """
    found = [sides for sides in (_lighter(bare, small, level) for level in levels) if sides]
    return max(found, key=lambda sides: min(side.step(bare) for side in sides), default=[])


def _lighter(bare: Grey, small: Grey, level: float) -> list[Side]:
    """The sides of the largest area lighter than a level, if it is a sheet."""
    light = bare > level
    _, labels, stats, _ = cv2.connectedComponentsWithStats(light.astype(np.uint8), connectivity=4)
    if len(stats) < 2:
        return []
    largest = 1 + int(stats[1:, cv2.CC_STAT_AREA].argmax())
    outlines, _ = cv2.findContours((labels == largest).astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    hull = cv2.convexHull(max(outlines, key=cv2.contourArea))
    mask = np.zeros(bare.shape, np.uint8)
    cv2.fillConvexPoly(mask, hull, 1)
    inside = mask > 0
    if inside.all() or light[inside].mean() < _LEAST_CONVEX or light[~inside].mean() > 1 - _LEAST_ALIKE:
        return []
    if not _stands_out(bare, small, inside):
        return []
    sides = sides_of(hull.reshape(-1, 2).astype(float), bare.shape)
    return sides if len(sides) <= 3 and all(side.step(bare) >= _LEAST_DARK for side in sides) else []


def _painted(small: Grey, inside: Mask) -> bool:
    """Whether sheet and ground are both of one tone each, as only a program draws them."""
    mask = inside.astype(np.uint8)
    away = cv2.erode(mask, np.ones((5, 5), np.uint8)) > 0, cv2.dilate(mask, np.ones((5, 5), np.uint8)) == 0
    spread = [np.subtract(*np.percentile(small[each], [70, 30])) for each in away if each.any()]
    return len(spread) < 2 or max(spread) <= _FLAT


def _corners(sides: list[Side]) -> Points:
    """Where neighbouring sides meet, (4, 2), the one nearest to the picture's left upper corner first, clockwise."""
    met = np.array([side.meets(other) for side, other in zip(sides, sides[1:] + sides[:1], strict=True)])
    middle = met.mean(axis=0)
    met = met[np.argsort(np.arctan2(*(met - middle).T[::-1]))]
    # The least turn: the side that runs most nearly to the right becomes the upper one.
    along = np.roll(met, -1, axis=0) - met
    return np.roll(met, -int(np.argmax(along[:, 0] / np.hypot(*along.T))), axis=0)


def _upright(page: PageImage, corners: Points) -> PageImage:
    lengths = np.hypot(*(np.roll(corners, -1, axis=0) - corners).T)
    wide, high = round(max(lengths[0], lengths[2])), round(max(lengths[1], lengths[3]))
    inset = _INSET * min(wide, high) + _BLUR_PX
    upright = np.array([[0, 0], [wide, 0], [wide, high], [0, high]]) - 0.5 - inset
    size = (max(1, round(wide - 2 * inset)), max(1, round(high - 2 * inset)))
    turn = cv2.getPerspectiveTransform(upright.astype(np.float32), corners.astype(np.float32))
    back: Homography = np.asarray(turn, np.float64)
    grey = cv2.warpPerspective(
        page.grey, back, size, flags=cv2.INTER_CUBIC | cv2.WARP_INVERSE_MAP, borderMode=cv2.BORDER_REPLICATE
    )
    straight = noted(page, "sheet found and straightened", np.asarray(grey, np.uint8), page.to_given @ back)
    return replace(straight, px_per_mm=None)


def _without_ground(grey: Grey, sides: list[Side]) -> Grey:
    """What lies beyond the sides, and a little within them, as light as the paper beside them."""
    height, width = grey.shape
    bare = grey.copy()
    paper = int(np.median(reduced(grey, _LOOK_PX)))
    for side in sides:
        beyond = side.beyond(width, height, inset=_INSET * min(width, height))
        cv2.fillConvexPoly(bare, np.rint(beyond).astype(np.int32), paper)
    return bare
