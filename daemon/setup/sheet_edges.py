"""The sheet's own edges in a photo: four straight lines of known length undo the perspective."""

from __future__ import annotations

import cv2
import numpy as np

from daemon.errors import BadPicture
from daemon.setup.find import counterclockwise
from daemon.shapes import Grey, Homography, Points

_SMALL_PX = 2400
_OF_THE_PICTURE = 0.1
"""The sheet is at least so large a part of it."""


def px_to_mm_by_sheet(grey: Grey, sheet_mm: tuple[float, float]) -> Homography:
    """From px of a photo to true mm of the sheet, y up. grey: uint8 (H, W), the whole light sheet on a darker table.

    sheet_mm: its two sides, in either order. Raises BadPicture when it does not show four straight edges.
    """
    scale = min(1.0, _SMALL_PX / max(grey.shape))
    small = np.asarray(cv2.resize(grey, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA), np.uint8)
    corners = _corners(_outline(small)) / scale
    sides = [float(np.hypot(*(corners[at] - corners[(at + 1) % 4]))) for at in range(4)]
    short, long = sorted(sheet_mm)
    width, height = (long, short) if sides[0] + sides[2] > sides[1] + sides[3] else (short, long)
    sheet = np.array([[0, 0], [width, 0], [width, height], [0, height]], np.float32)
    return np.asarray(cv2.getPerspectiveTransform(corners.astype(np.float32), sheet), float)


def _outline(small: Grey) -> Points:
    """Of the largest light thing, without the lines that are drawn on it."""
    around = max(3, round(0.01 * max(small.shape)) | 1)
    blank = cv2.morphologyEx(small, cv2.MORPH_CLOSE, np.ones((around, around), np.uint8))
    light = cv2.threshold(cv2.GaussianBlur(blank, (5, 5), 0), 0, 255, cv2.THRESH_BINARY | cv2.THRESH_OTSU)[1]
    outlines = cv2.findContours(light, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)[0]
    largest = max(outlines, key=cv2.contourArea, default=None)
    if largest is None or not _OF_THE_PICTURE < cv2.contourArea(largest) / small.size < 0.98:
        raise BadPicture("the sheet's edges are not in the picture: lay it on a darker table and take all of it")
    return np.asarray(largest[:, 0], float)


def _corners(outline: Points) -> Points:
    """Where the lines through its four sides meet: (4, 2), counterclockwise as one sees them."""
    rough = cv2.approxPolyDP(outline.astype(np.float32), 0.03 * cv2.arcLength(outline.astype(np.float32), True), True)
    corners = rough[:, 0].astype(float)
    if len(corners) != 4:
        raise BadPicture(
            f"the sheet in the picture has {len(corners)} corners instead of four: lay it flat and take all of it"
        )
    corners = counterclockwise(corners)
    sides = [_side(outline, corners[at], corners[(at + 1) % 4]) for at in range(4)]
    return np.array([_meet(sides[at - 1], sides[at]) for at in range(4)])


def _side(outline: Points, start: Points, end: Points) -> tuple[Points, Points]:
    """A point and a direction: the line through the outline between two corners, less what is near these."""
    way = (end - start) / np.hypot(*(end - start))
    along, across = (outline - start) @ way, (outline - start) @ np.array([-way[1], way[0]])
    length = float(np.hypot(*(end - start)))
    near = (along > 0.06 * length) & (along < 0.94 * length) & (np.abs(across) < 0.02 * length)
    vx, vy, x, y = cv2.fitLine(outline[near].astype(np.float32), cv2.DIST_HUBER, 0, 0.01, 0.01).ravel()
    return np.array([x, y], float), np.array([vx, vy], float)


def _meet(one: tuple[Points, Points], other: tuple[Points, Points]) -> Points:
    parts = np.linalg.solve(np.column_stack([one[1], -other[1]]), other[0] - one[0])
    return np.asarray(one[0] + parts[0] * one[1], float)
