"""A page that lies skew in its picture is turned by the straight lines on it."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.page.back import noted
from daemon.page.tones import reduced
from daemon.shapes import Grey, Homography, PageImage, Points

_LOOK_PX, _LEAST_PX = 768, 200
_LONG_SHARE = 0.15
"""A straight line is at least so long beside the picture's shorter side; a hand's lines are not so straight."""
_FEWEST = 6
"""Lines: fewer may lean as one by chance."""
_APART_SHARE = 0.01
_LEAST_DEGREES, _MOST_DEGREES = 0.3, 5.0
_ALIKE_DEGREES = 0.25
_LEAST_ALIKE = 0.75
"""So much of the length of all straight lines must lean alike, level and plumb lines taken together."""
_FRAME = 2
"""So many lines inside the picture that are level or plumb already say that the others lean on purpose."""
_RIM_SHARE = 0.02
"""A scanner's edge is always level: what lies so near to the picture's border, in shares of its side, says nothing."""


def level(page: PageImage) -> PageImage:
    """The page turned so that its long straight lines, drawn or printed, are level or plumb; else the page itself.

    page: its sheet straightened where that was seen. Turned only where six lines or more, and three quarters of the
    length of all of them, lean by the same 0.3 to 5 degrees and hardly one is level or plumb already, as the frame of a
    slanting hatch is: no picture is so skew that was not meant to be.
    """
    degrees = _skew(reduced(page.grey, _LOOK_PX)) if min(page.grey.shape) >= _LEAST_PX else 0.0
    if not degrees:
        return page
    grey, back = _turned(page.grey, degrees)
    return noted(page, f"turned by {-degrees:.1f} degrees", grey, page.to_given @ back)


def _skew(small: Grey) -> float:
    """By how many degrees the lines lean, clockwise; 0 where they do not, or not alike."""
    found = cv2.createLineSegmentDetector().detect(small)[0]
    if found is None:
        return 0.0
    lines = np.asarray(found, float).reshape(-1, 4)
    ways = lines[:, 2:] - lines[:, :2]
    lengths = np.hypot(*ways.T)
    long = lengths >= _LONG_SHARE * min(small.shape)
    if long.sum() < _FEWEST:
        return 0.0
    lines, lengths = lines[long], lengths[long]
    leans = (np.degrees(np.arctan2(ways[long, 1], ways[long, 0])) + 45) % 90 - 45
    near = np.abs(leans[:, None] - leans[None]) <= _ALIKE_DEGREES
    alike = near[int((near * lengths).sum(axis=1).argmax())]
    degrees = float(np.average(leans[alike], weights=lengths[alike]))
    if _count(lines[~alike & (np.abs(leans) <= _ALIKE_DEGREES) & _inside(lines, small)], 0.0, small) >= _FRAME:
        return 0.0
    clear = lengths[alike].sum() >= _LEAST_ALIKE * lengths.sum() and _count(lines[alike], degrees, small) >= _FEWEST
    return degrees if clear and _LEAST_DEGREES <= abs(degrees) <= _MOST_DEGREES else 0.0


def _inside(lines: Points, small: Grey) -> NDArray[np.bool_]:
    """Which of them do not lie along the border."""
    ends, size = lines.reshape(-1, 2, 2), np.array(small.shape[::-1])
    rim = _RIM_SHARE * size.max()
    return np.asarray(((ends.max(axis=1) > rim) & (ends.min(axis=1) < size - rim)).all(axis=1))


def _count(lines: Points, degrees: float, small: Grey) -> int:
    """How many lines there are that do not lie on each other: each has two edges, and may be broken."""
    angle = np.radians(degrees)
    turned = lines.reshape(-1, 2, 2) @ np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    is_level = np.ptp(turned[:, :, 0], axis=1) > np.ptp(turned[:, :, 1], axis=1)
    least = _APART_SHARE * max(small.shape)
    aside = (turned[is_level, :, 1].mean(axis=1), turned[~is_level, :, 0].mean(axis=1))
    return sum(int((np.diff(np.sort(each)) > least).sum()) + 1 for each in aside if len(each))


def _turned(grey: Grey, degrees: float) -> tuple[Grey, Homography]:
    """The picture turned back by that, as large as it becomes, and the way from its px to the given ones."""
    height, width = grey.shape
    angle = np.radians(degrees)
    cosine, sine = float(np.cos(angle)), float(np.sin(angle))
    wide, high = (round(a * cosine + b * abs(sine)) for a, b in ((width, height), (height, width)))
    turn = np.array([[cosine, -sine], [sine, cosine]])
    middle, given_middle = np.array([wide - 1, high - 1]) / 2, np.array([width - 1, height - 1]) / 2
    back: Homography = np.eye(3)
    back[:2, :2], back[:2, 2] = turn, given_middle - turn @ middle
    paper = int(np.median(reduced(grey, _LOOK_PX)))
    found = cv2.warpAffine(
        grey, back[:2], (wide, high), flags=cv2.INTER_CUBIC | cv2.WARP_INVERSE_MAP, borderValue=(paper,)
    )
    return np.asarray(found, np.uint8), back
