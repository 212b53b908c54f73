"""What paper, pen and camera make of clean ink, put right as the daemon puts a page right before it is read.

Lines break, blot and are grainy as a pencil's; paper has a tone, a texture, sometimes ruling; light is uneven, a shadow
falls on the sheet; the picture is blurred, noisy and compressed; on dark paper the line is light.
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.page.prepare import even_out
from daemon.shapes import PageImage
from training.render import BACKGROUND, LINES, Sample

Random = np.random.Generator
Field = NDArray[np.float32]

_LEAST_CONTRAST = 0.25
"""Of 255: what is paler after all this is no drawing any more, and the clean canvas is taken."""


def worn(sample: Sample, random: Random, *, line_px: int) -> Sample:
    """The canvas as it is read from a real page. Blots are lines in the label; a break is drawn over by the label."""
    ink = sample.ink.astype(np.float32) / 255
    label = sample.label
    if random.random() < 0.3:
        ink = _blotted(ink, random, line_px)
        label = np.where((ink > 0.5) & (label == BACKGROUND), np.uint8(LINES), label)
    if random.random() < 0.3:
        ink = _broken(ink, random, line_px)
    if random.random() < 0.35:
        ink = ink * _grain(ink.shape, random)
    if random.random() < 0.7:
        ink = _blurred(ink, random.uniform(0.3, 1.0))
    page = _paper(ink.shape, random) * (1 - ink * random.uniform(0.4, 1.0))
    read = 255 - even_out(_page(_taken(page, random))).grey
    # Ink that nobody can see any more teaches nothing.
    drawn = sample.ink > 127
    if drawn.any() and read[drawn].mean() - read[~drawn].mean() < _LEAST_CONTRAST * 255:
        return sample
    return Sample(read, label)


def _taken(page: Field, random: Random) -> NDArray[np.uint8]:
    """By a camera or a scanner: noise, compression, and light on dark now and then."""
    grey = page * 255
    if random.random() < 0.5:
        grey = grey + random.normal(0.0, random.uniform(1.0, 8.0), grey.shape)
    taken = np.clip(grey, 0, 255).astype(np.uint8)
    if random.random() < 0.4:
        _, file = cv2.imencode(".jpg", taken, [cv2.IMWRITE_JPEG_QUALITY, int(random.integers(30, 91))])
        taken = np.asarray(cv2.imdecode(file, cv2.IMREAD_GRAYSCALE), np.uint8)
    return 255 - taken if random.random() < 0.05 else taken


def _paper(shape: tuple[int, ...], random: Random) -> Field:
    """1 = white."""
    paper = np.full(shape, random.uniform(0.65, 1.0) if random.random() < 0.7 else 1.0, np.float32)
    if random.random() < 0.5:
        paper *= 1 - random.uniform(0.05, 0.3) * _slow(shape, random)
    if random.random() < 0.2:
        paper *= 1 - random.uniform(0.1, 0.45) * _shadow(shape, random)
    if random.random() < 0.4:
        texture = _blurred(random.standard_normal(shape).astype(np.float32), random.uniform(0.4, 1.5))
        paper *= 1 + random.uniform(0.01, 0.04) * texture / texture.std()
    if random.random() < 0.08:
        paper *= 1 - random.uniform(0.05, 0.15) * _ruling(shape, random)
    return np.asarray(paper, np.float32)


def _slow(shape: tuple[int, ...], random: Random) -> Field:
    """0..1, changing over the whole canvas."""
    coarse = cv2.resize(random.random((3, 3)).astype(np.float32), shape[::-1], interpolation=cv2.INTER_CUBIC)
    return np.asarray(np.clip(coarse, 0, 1), np.float32)


def _shadow(shape: tuple[int, ...], random: Random) -> Field:
    """0..1 across a straight soft edge."""
    y, x = np.mgrid[: shape[0], : shape[1]].astype(np.float32)
    angle, size = random.uniform(0, 2 * np.pi), shape[0]
    along = (x - random.uniform(0.2, 0.8) * size) * np.cos(angle) + (y - random.uniform(0.2, 0.8) * size) * np.sin(
        angle
    )
    return np.asarray(1 / (1 + np.exp(-along / random.uniform(4, 40))), np.float32)


def _ruling(shape: tuple[int, ...], random: Random) -> Field:
    """Lines of the paper, one way or both: fainter than what is drawn."""
    step, lines = int(random.integers(12, 40)), np.zeros(shape, np.float32)
    lines[int(random.integers(step)) :: step] = 1
    if random.random() < 0.5:
        lines[:, int(random.integers(step)) :: step] = 1
    return _blurred(lines, 0.5)


def _grain(shape: tuple[int, ...], random: Random) -> Field:
    """The tooth of the paper that a pencil leaves white: factors in 0..1."""
    noise = _blurred(random.standard_normal(shape).astype(np.float32), random.uniform(0.5, 1.0))
    return np.asarray(np.clip(1 - random.uniform(0.1, 0.45) * np.maximum(noise / noise.std(), 0), 0, 1), np.float32)


def _broken(ink: Field, random: Random, line_px: int) -> Field:
    """Gaps of 1 or 2 px across the line."""
    return ink * (1 - _discs(ink, random, radius_px=1 if line_px < 3 else (line_px + 1) // 2, most=6))


def _blotted(ink: Field, random: Random, line_px: int) -> Field:
    """Blots a little wider than the line, on it."""
    return np.maximum(ink, _discs(ink, random, radius_px=(line_px + 1) // 2 + 1, most=4))


def _discs(ink: Field, random: Random, *, radius_px: int, most: int) -> Field:
    out = np.zeros(ink.shape, np.float32)
    at = np.argwhere(ink > 0.5)
    for y, x in at[random.integers(len(at), size=int(random.integers(1, most + 1)))] if len(at) else ():
        cv2.circle(out, (int(x), int(y)), radius_px, 1.0, -1, cv2.LINE_AA)
    return out


def _blurred(field: Field, sigma_px: float) -> Field:
    return np.asarray(cv2.GaussianBlur(field, (0, 0), sigma_px), np.float32)


def _page(grey: NDArray[np.uint8]) -> PageImage:
    height_px, width_px = grey.shape
    return PageImage(grey, np.eye(3), width_px, height_px, sha256="")
