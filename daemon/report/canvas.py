"""Paper, colours, lines and words for the pictures in a report."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import Literal, TypeAlias

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.shapes import Points

Picture: TypeAlias = NDArray[np.uint8]
"""(H, W, 3) uint8, blue green red."""
Colour: TypeAlias = tuple[int, int, int]
"""Blue, green, red."""

PAPER: Colour = (255, 255, 255)
DESK: Colour = (240, 242, 243)
INK: Colour = (40, 34, 30)
WORDS: Colour = (60, 54, 50)
QUIET: Colour = (140, 134, 128)
FRAME: Colour = (214, 210, 206)
BLUE: Colour = (196, 120, 30)
ORANGE: Colour = (20, 130, 240)
GREEN: Colour = (90, 150, 40)
RED: Colour = (50, 40, 215)

_SUBPIXEL_BITS = 4


def blank(width_px: int, height_px: int, colour: Colour = PAPER) -> Picture:
    """A picture of one colour, uint8 (height, width, 3)."""
    return np.repeat(np.full((1, width_px, 3), colour, np.uint8), height_px, axis=0)


def line(picture: Picture, points: Points, colour: Colour, width_px: float = 1.0) -> None:
    """Draw a polyline, (N, 2) in px of the picture, antialiased; a single point becomes a dot of that width."""
    if len(points) == 1:
        dot(picture, points[0], max(1.0, width_px / 2), colour)
        return
    # OpenCV draws an even thickness one pixel wider than it is told, an odd one above 1 two pixels wider.
    thickness = max(1, 2 * round((width_px - 1) / 2))
    cv2.polylines(picture, [_fixed(points)], False, colour, thickness, cv2.LINE_AA, _SUBPIXEL_BITS)


def dashes(picture: Picture, points: Points, colour: Colour, *, dash_px: float = 5.0, gap_px: float = 5.0) -> None:
    """Draw a polyline, (N, 2), as dashes; each segment begins with one."""
    for start, end in pairwise(points):
        length = float(np.hypot(*(end - start)))
        for at in np.arange(0.0, length, dash_px + gap_px):
            part = np.array([[at], [min(at + dash_px, length)]]) / length
            line(picture, start + part * (end - start), colour)


def dot(
    picture: Picture, centre: NDArray[np.float64], radius_px: float, colour: Colour, rim: Colour | None = None
) -> None:
    """Draw a disc, with a rim where a colour for it is given."""
    x, y = (int(v) for v in _fixed(np.asarray(centre, float)))
    fixed_radius = round(radius_px * (1 << _SUBPIXEL_BITS))
    cv2.circle(picture, (x, y), fixed_radius, colour, -1, cv2.LINE_AA, _SUBPIXEL_BITS)
    if rim is not None:
        cv2.circle(picture, (x, y), fixed_radius, rim, 1, cv2.LINE_AA, _SUBPIXEL_BITS)


def box(picture: Picture, corner: tuple[float, float], opposite: tuple[float, float], colour: Colour) -> None:
    """Draw the outline of a rectangle."""
    (left, top), (right, bottom) = corner, opposite
    line(picture, np.array([[left, top], [right, top], [right, bottom], [left, bottom], [left, top]], float), colour)


def write(
    picture: Picture,
    words: str,
    at: tuple[float, float],
    colour: Colour = WORDS,
    *,
    size_px: int = 15,
    weight: int = 400,
    align: Literal["left", "right", "centre"] = "left",
) -> None:
    """Write one line of words; `at` is the left, right or middle end of its base line."""
    before = {"left": 0.0, "right": 1.0, "centre": 0.5}[align] * words_width_px(words, size_px=size_px, weight=weight)
    place = (round(at[0] - before), round(at[1]))
    cv2.putText(picture, words, place, colour, cv2.FontFace("sans"), size_px, weight)


def counted(number: int, noun: str, nouns: str) -> str:
    """A number with its noun: "1 stroke", "2 strokes"."""
    return f"{number} {noun if number == 1 else nouns}"


def words_width_px(words: str, *, size_px: int = 15, weight: int = 400) -> int:
    """How wide `write` writes these words."""
    return int(cv2.getTextSize((0, 0), words, (0, 0), cv2.FontFace("sans"), size_px, weight)[2])


def shortened(words: str, width_px: float, *, size_px: int = 15, weight: int = 400) -> str:
    """The words, cut in the middle with an ellipsis where they are wider than that."""
    kept = len(words)
    short = words
    while kept > 2 and words_width_px(short, size_px=size_px, weight=weight) > width_px:
        kept -= 1
        short = words[: (kept + 1) // 2] + "…" + words[len(words) - kept // 2 :]
    return short


def fit(picture: Picture, width_px: int, height_px: int, colour: Colour = PAPER) -> Picture:
    """The picture as large as it fits, centred on a tile of that size."""
    tile = blank(width_px, height_px, colour)
    scale = min(width_px / picture.shape[1], height_px / picture.shape[0])
    w, h = max(1, round(picture.shape[1] * scale)), max(1, round(picture.shape[0] * scale))
    how = cv2.INTER_AREA if scale < 1 else cv2.INTER_CUBIC
    paste(
        tile,
        np.asarray(cv2.resize(picture, (w, h), interpolation=how), np.uint8),
        (width_px - w) // 2,
        (height_px - h) // 2,
    )
    return tile


def paste(picture: Picture, tile: Picture, left_px: int, top_px: int) -> None:
    """Lay a tile onto a picture that is large enough for it."""
    picture[top_px : top_px + tile.shape[0], left_px : left_px + tile.shape[1]] = tile


def many_colours() -> Iterator[Colour]:
    """Without end: colours that lie far apart, each dark enough on white."""
    hue = 0.58
    while True:
        for value, saturation in ((200, 235), (150, 200), (225, 180)):
            pixel = np.array([[[int(hue * 180) % 180, saturation, value]]], np.uint8)
            blue, green, red = (int(v) for v in cv2.cvtColor(pixel, cv2.COLOR_HSV2BGR)[0, 0])
            yield blue, green, red
            # The golden section never comes back to a hue it has used.
            hue = (hue + 0.618033988749895) % 1.0


def png(picture: Picture) -> bytes:
    """The picture as the bytes of a PNG file, smaller and several times faster without a filter: it is mostly blank."""
    how = [cv2.IMWRITE_PNG_COMPRESSION, 3, cv2.IMWRITE_PNG_FILTER, cv2.IMWRITE_PNG_FILTER_NONE]
    return bytes(cv2.imencode(".png", picture, how)[1])


def _fixed(points: NDArray[np.float64]) -> NDArray[np.int32]:
    return np.rint(points * (1 << _SUBPIXEL_BITS)).astype(np.int32)
