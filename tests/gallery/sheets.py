"""Sheets that are made for the gallery alone: coloured, filled, printed, furry."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from daemon.report.canvas import Colour, Picture
from daemon.shapes import Grey, Points
from tests.benchmarks.fidelity.wear import smooth
from tests.drawings import scenes
from tests.drawings.hand import by_hand, curve, inked, line, ring

_FINE = 4
_BLUE, _RED, _GREEN, _INDIGO = (170, 70, 20), (40, 40, 205), (70, 130, 30), (110, 40, 30)
_TEXT = "this is a page of printed text and no drawing at all: who gives it to a plotter gets its letters"


def colours() -> Picture:
    """The house blue, its tree green, its chimney, smoke and door red."""
    strokes = scenes.house()
    parts = {_RED: strokes[2:4] + strokes[11:12], _GREEN: strokes[12:], _BLUE: strokes[:2] + strokes[4:11]}
    return _coloured(parts, 600, (255, 255, 255))


def on_coloured_paper() -> Picture:
    """Indigo ink on yellow paper."""
    return _coloured({_INDIGO: scenes.fish()}, 500, (150, 225, 245))


def hills() -> Grey:
    """A filled sun over hills, the nearer one filled, and a house."""
    far = curve((4, 70), (20, 52), (38, 66), (60, 46), (80, 62), (96, 56))
    near = np.concatenate([curve((4, 84), (30, 72), (62, 82), (96, 72)), line((96, 92), (4, 92), (4, 84))])
    house = line((60, 44), (60, 32), (67, 25), (74, 32), (74, 44), (60, 44))
    return _filled([ring(26, 24, 11), near], [far, house], 512, 3.0)


def dominoes() -> Grey:
    """Three tiles and their filled eyes."""
    frames, eyes = [], []
    for left, (high, low) in zip((8, 38, 68), ((1, 3), (4, 2), (6, 5)), strict=True):
        frames += [line((left, 20), (left + 24, 20), (left + 24, 80), (left, 80), (left, 20))]
        frames += [line((left + 3, 50), (left + 21, 50))]
        eyes += [ring(left + x, y + middle, 2.6) for count, middle in ((high, 35), (low, 65)) for x, y in _eyes(count)]
    return _filled(eyes, frames, 480, 2.5)


def _eyes(count: int) -> Sequence[tuple[float, float]]:
    pairs = [(6.0, -9.0), (18.0, 9.0)], [(18.0, -9.0), (6.0, 9.0)], [(6.0, 0.0), (18.0, 0.0)]
    return [pair for both in pairs[: count // 2] for pair in both] + [(12.0, 0.0)] * (count % 2)


def music() -> Grey:
    """Two staves with notes, stems, a beam and a rest that is only ticks."""
    lines, heads = [], []
    for top in (24.0, 62.0):
        lines += [line((6, top + 3 * number), (94, top + 3 * number)) for number in range(5)]
        lines += [line((x, top), (x, top + 12)) for x in (6, 50, 94)]
        for number, step in enumerate((8, 6, 4, 2, 3, 5, 7, 1)):
            x, y = 14 + 10 * number + 2 * (number > 3), top + 1.5 * step
            heads.append(ring(x, y, 1.8, 0.72))
            lines.append(line((x + 1.7, y), (x + 1.7, y - 11)))
        lines += [line((25.7, top - 2), (35.7, top - 5)), line((45, top + 4), (47, top + 6), (45, top + 8))]
    return _filled(heads, lines, 900, 2.2)


def text() -> Grey:
    """Printed words, line below line."""
    page, words = np.full((1000, 720), 250, np.uint8), _TEXT.split()
    for number in range(24):
        turned = words[5 * number % len(words) :] + words
        cv2.putText(page, " ".join(turned[:11]), (60, 90 + 36 * number), (20,), cv2.FontFace("sans"), 24, 400)
    return page


def furry() -> Grey:
    """A photograph of a cat: soft light behind it, fur of all tones, and no line anywhere."""
    random, side_px = np.random.default_rng(7), 480
    behind = smooth(random.standard_normal((side_px, side_px), np.float32), 40)
    picture = np.asarray(150 + 45 * behind / np.abs(behind).max(), np.float32)
    fur = cv2.GaussianBlur(random.standard_normal((side_px, side_px), np.float32), (0, 0), 1.0, sigmaY=5.0)
    cat = np.zeros((side_px, side_px), np.uint8)
    for outline in (*scenes.cat()[:2], ring(48, 74, 27, 0.66)):
        cv2.fillPoly(cat, [np.rint(outline * side_px / 100).astype(np.int32)], 255)
    inside = smooth(np.asarray(cat / 255, np.float32), 4.0)
    picture = np.asarray(picture * (1 - inside) + inside * (105 + 30 * fur / fur.std()), np.float32)
    for eye in scenes.cat()[3:5]:
        cv2.fillPoly(picture, [np.rint(eye * side_px / 100).astype(np.int32)], 25)
    return np.asarray(np.clip(smooth(picture, 0.8), 0, 255), np.uint8)


def _coloured(parts: dict[Colour, list[Points]], side_px: int, paper: Colour) -> Picture:
    """Each colour takes its share of the light, drawn by an unsteady hand."""
    random = np.random.default_rng(3)
    picture = np.full((side_px, side_px, 3), paper, np.float32)
    for colour, strokes in parts.items():
        lines = [by_hand(points * side_px / 100 - 0.5, random, wobble_px=1.0) for points in strokes]
        ink = inked(lines, (side_px, side_px), width_px=3.0)[..., None]
        picture = picture * (1 - ink) + np.array(colour, np.float32) * ink
    return np.asarray(np.rint(picture), np.uint8)


def _filled(areas: list[Points], lines: list[Points], side_px: int, width_px: float) -> Grey:
    fine = np.zeros((_FINE * side_px, _FINE * side_px), np.uint8)
    for area in areas:
        cv2.fillPoly(fine, [np.rint(area * _FINE * side_px / 100).astype(np.int32)], 255)
    filled = cv2.resize(fine, (side_px, side_px), interpolation=cv2.INTER_AREA) / 255
    drawn = inked([points * side_px / 100 - 0.5 for points in lines], (side_px, side_px), width_px=width_px)
    return np.asarray(np.rint(255 * (1 - np.maximum(filled, drawn))), np.uint8)
