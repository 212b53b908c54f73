"""The test card in a picture of it: where its frame lies, which way up it is, and where each of its marks is."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.errors import BadPicture
from daemon.homography import through
from daemon.setup.card import Card, Mark
from daemon.shapes import Grey, Homography, Points

_SMALL_PX = 1600
"""The longer side of the picture in which the frame is looked for."""
_LEAST_DARKNESS = 16.0
"""Grey levels by which a line is darker than its paper."""
_WITHIN_MM = 1.2
"""So far from where it should be a mark is looked for."""
_LINE_MM = 0.8
"""No line is broader than twice that."""
_PROFILES, _STEPS = 9, 121
_LEAST_OF_FIGURES, _LEAST_OF_MARKS = 0.6, 0.6


@dataclass(frozen=True, slots=True)
class Found:
    """A mark of the card, and the place of its middle line in px of the picture."""

    mark: Mark
    at_px: tuple[float, float]


def find_marks(grey: Grey, card: Card) -> tuple[list[Found], Homography]:
    """The marks that can be seen, and roughly where the card lies: its mm to px of the picture.

    grey: uint8 (H, W), as it was scanned. The card may lie turned by any angle, not mirrored. Raises BadPicture when it
    is not found, or too little of it.
    """
    small, mask = _small_mask(grey)
    to_small = max(_ways_up(mask, card), key=lambda way: way[0], default=None)
    if to_small is None or to_small[0] < _LEAST_OF_FIGURES:
        raise BadPicture(
            f"the frame of a test card of {card.width_mm:g} x {card.height_mm:g} mm is not in the picture: give one "
            "in which the whole card is seen and nothing touches its frame, or say the card's size with --card"
        )
    grow = np.array([[1 / small, 0, 0.5 / small - 0.5], [0, 1 / small, 0.5 / small - 0.5], [0, 0, 1]])
    to_px = grow @ to_small[1]
    # The frame leads to the marks, and those tell better where the card lies.
    for _ in range(2):
        found = _measured(grey, card, to_px)
        if len(found) < _LEAST_OF_MARKS * len(card.marks):
            raise BadPicture(
                f"only {len(found)} of the card's {len(card.marks)} marks can be seen: scan it at 200 dpi or more, "
                "drawn with a dark pen"
            )
        middles = np.array([_middle(each.mark) for each in found])
        to_px = np.asarray(cv2.findHomography(middles, np.array([each.at_px for each in found]), 0)[0], float)
    return found, to_px


def _middle(mark: Mark) -> tuple[float, float]:
    return (mark.start_mm[0] + mark.end_mm[0]) / 2, (mark.start_mm[1] + mark.end_mm[1]) / 2


def _small_mask(grey: Grey) -> tuple[float, Grey]:
    """How much smaller it was made, and which of its pixels are darker than the paper around them (255)."""
    scale = min(1.0, _SMALL_PX / max(grey.shape))
    small = cv2.resize(grey, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    around = max(3, round(0.02 * max(small.shape)) | 1)
    paper = cv2.morphologyEx(small, cv2.MORPH_CLOSE, np.ones((around, around), np.uint8))
    dark = cv2.subtract(cv2.GaussianBlur(paper, (around, around), 0), small)
    level = max(_LEAST_DARKNESS, 0.3 * float(np.percentile(dark, 99.7)))
    return scale, np.asarray((dark >= level) * np.uint8(255), np.uint8)


def _ways_up(mask: Grey, card: Card) -> Iterator[tuple[float, Homography]]:
    """For each frame and each way up: which part of the ruler and the circle is there, less what is dark where the
    card is blank, and where the card lies then."""
    joined = np.asarray(cv2.morphologyEx(mask, cv2.MORPH_CLOSE, np.ones((3, 3), np.uint8)), np.uint8)
    thick = np.asarray(cv2.dilate(mask, np.ones((3, 3), np.uint8)), np.uint8)
    figures_mm, blank_mm = (np.vstack([_dense(line) for line in lines]) for lines in (card.figures_mm, card.blank_mm))
    for corners in _frames(joined):
        for turn in range(4):
            turned = np.roll(corners, turn, axis=0).astype(np.float32)
            to_px = np.asarray(cv2.getPerspectiveTransform(card.corners_mm.astype(np.float32), turned), float)
            yield _dark(thick, through(to_px, figures_mm)) - _dark(thick, through(to_px, blank_mm)), to_px


def _dark(mask: Grey, places_px: Points) -> float:
    """Which part of these places is dark; what lies outside the picture is not."""
    places = np.rint(places_px).astype(int)
    inside = ((places >= 0) & (places < mask.shape[::-1])).all(axis=1)
    return float((mask[tuple(places[inside].T[::-1])] > 0).sum() / len(places))


def _frames(mask: Grey) -> Iterator[Points]:
    """What has four corners, the largest first: corners (4, 2) in px, counterclockwise as one sees them.

    Of a frame that backlash has left open the hull has them still.
    """
    outlines = cv2.findContours(mask, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)[0]
    for hull in sorted(map(cv2.convexHull, outlines), key=cv2.contourArea, reverse=True)[:12]:
        corners = cv2.approxPolyDP(hull, 0.03 * cv2.arcLength(hull, True), True)[:, 0].astype(float)
        if len(corners) == 4:
            yield counterclockwise(corners)


def counterclockwise(corners: Points) -> Points:
    """The same corners, (N, 2) in px, counterclockwise as one sees them."""
    # y runs down in a picture, so what looks counterclockwise has a negative area.
    turned = cv2.contourArea(corners.astype(np.float32), oriented=True) < 0
    return corners if turned else corners[::-1]


def _dense(line: Points) -> Points:
    """Points at most 0.5 mm apart along a polyline."""
    parts = [np.linspace(start, end, max(2, int(2 * np.hypot(*(end - start))) + 1)) for start, end in pairwise(line)]
    return np.vstack(parts)


def _measured(grey: Grey, card: Card, to_px: Homography) -> list[Found]:
    """Where the marks' middle lines are, to a fraction of a px: the centre of darkness across each mark."""
    starts, ends = (np.array([getattr(mark, end) for mark in card.marks]) for end in ("start_mm", "end_mm"))
    across = np.array([[1.0, 0.0] if mark.axis == 0 else [0.0, 1.0] for mark in card.marks])
    along = np.linspace(0.2, 0.8, _PROFILES)[None, :, None, None]
    offsets_mm = np.linspace(-_WITHIN_MM, _WITHIN_MM, _STEPS)
    places_mm = (
        starts[:, None, None] + along * (ends - starts)[:, None, None]
        + offsets_mm[None, None, :, None] * across[:, None, None]
    )  # fmt: skip
    places = through(to_px, places_mm).astype(np.float32).reshape(-1, _STEPS, 2)
    seen = cv2.remap(grey, places[..., 0], places[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    profiles = seen.astype(float).reshape(len(card.marks), _PROFILES, _STEPS).mean(axis=1)
    shifts_mm, clear = _centres(profiles, offsets_mm)
    at_px = through(to_px, (starts + ends) / 2 + shifts_mm[:, None] * across)
    return [
        Found(mark, (float(x), float(y)))
        for mark, (x, y), seen_well in zip(card.marks, at_px, clear, strict=True)
        if seen_well
    ]


def _centres(profiles: NDArray[np.float64], offsets_mm: NDArray[np.float64]) -> tuple[Points, NDArray[np.bool_]]:
    """Centre of darkness of each profile in mm, and whether there is a line in it at all."""
    dark = np.percentile(profiles, 80, axis=1)[:, None] - profiles
    peak = dark.max(axis=1)[:, None]
    centres_mm = offsets_mm[dark.argmax(axis=1)]
    weight = np.clip(dark - 0.35 * peak, 0, None)
    # The darkest place of a broad line lies anywhere in it, so the window is moved after it.
    for _ in range(3):
        near = weight * (np.abs(offsets_mm - centres_mm[:, None]) < _LINE_MM)
        centres_mm = (near * offsets_mm).sum(axis=1) / np.maximum(near.sum(axis=1), 1e-9)
    return centres_mm, peak[:, 0] >= _LEAST_DARKNESS
