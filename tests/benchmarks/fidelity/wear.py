"""What paper, pen, camera and scanner make of ink: a picture that somebody gives, from ink that is known.

Shades are shares: 1 white paper, 0 black. Everything is drawn from the generator that is handed in.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.shapes import Grey, Map, Points
from tests.benchmarks.fidelity.known import averaged, fine_ink

Random = np.random.Generator


@dataclass(frozen=True, slots=True)
class Paper:
    """tone: of the bare sheet. texture: standard deviation of its grain. fibres: how many lie in it."""

    tone: float = 0.95
    texture: float = 0.0
    fibres: int = 0


@dataclass(frozen=True, slots=True)
class Camera:
    """blur_px, noise: standard deviations, noise in grey levels. quality: of the JPEG, None for none."""

    blur_px: float = 0.7
    noise: float = 4.0
    quality: int | None = 85


def sheet_of(shape: tuple[int, int], paper: Paper, random: Random) -> Map:
    """Bare paper, float32 (H, W)."""
    sheet = np.full(shape, paper.tone, np.float32)
    if paper.texture:
        grain = smooth(random.standard_normal(shape, np.float32), 0.8)
        sheet *= 1 + paper.texture * grain / grain.std()
    for _ in range(paper.fibres):
        _fibre(sheet, random)
    return sheet


def _fibre(sheet: Map, random: Random) -> None:
    """A short faint bent line, as recycled paper is full of, in place."""
    at, angle = random.uniform(0, 1, 2) * sheet.shape[::-1], random.uniform(0, 2 * np.pi)
    length_px = random.uniform(4, 14)
    turns = angle + np.linspace(0, random.uniform(-1.5, 1.5), 6)
    path = at + np.cumsum(np.stack([np.cos(turns), np.sin(turns)], axis=1) * length_px / 6, axis=0)
    fixed = [np.rint(path * 16).astype(np.int32)]
    shade = float(sheet.mean()) * random.uniform(0.78, 0.93)
    cv2.polylines(sheet, fixed, False, shade, 1, cv2.LINE_AA, 4)


def inked(lines: list[Points], shape: tuple[int, int], pen_px: float, *, finer: int = 4) -> Map:
    """How much of each pixel is ink, float32 (H, W) in 0..1."""
    side_px = max(shape)
    return averaged(fine_ink(lines, side_px, pen_px, finer=finer), finer=finer)[: shape[0], : shape[1]]


def pencilled(ink: Map, random: Random) -> Map:
    """The tooth of the paper leaves white grains in the line."""
    tooth = smooth(random.standard_normal(ink.shape, np.float32), 0.9)
    return np.asarray(ink * np.clip(1 - 0.30 * np.maximum(tooth / tooth.std(), 0), 0, 1), np.float32)


def light(shape: tuple[int, int], random: Random, *, darkest: float) -> Map:
    """A light that falls off across the picture, 1 down to about `darkest`."""
    y, x = (np.mgrid[: shape[0], : shape[1]] / np.array(shape).reshape(2, 1, 1)).astype(np.float32)
    angle = random.uniform(0, 2 * np.pi)
    along = (x - 0.5) * np.cos(angle) + (y - 0.5) * np.sin(angle) + 0.5
    return np.asarray(1 - (1 - darkest) * np.clip(along, 0, 1) ** random.uniform(1.0, 1.6), np.float32)


def shadow(shape: tuple[int, int], random: Random, *, depth: float, edge_px: float) -> Map:
    """The shade of a hand or a lamp: a straight soft edge across the picture, darker beyond it."""
    y, x = np.mgrid[: shape[0], : shape[1]].astype(np.float32)
    angle = random.uniform(0, 2 * np.pi)
    at = random.uniform(0.3, 0.7, 2) * shape[::-1]
    along = (x - at[0]) * np.cos(angle) + (y - at[1]) * np.sin(angle)
    return np.asarray(1 - depth / (1 + np.exp(np.clip(-along / edge_px, -50, 50))), np.float32)


def taken(page: Map, camera: Camera, random: Random) -> Grey:
    """The picture file's pixels: blurred, noisy, compressed."""
    grey = smooth(page, camera.blur_px) * 255 + random.normal(0, camera.noise, page.shape)
    seen = np.asarray(np.rint(np.clip(grey, 0, 255)), np.uint8)
    if camera.quality is None:
        return seen
    _, file = cv2.imencode(".jpg", seen, [cv2.IMWRITE_JPEG_QUALITY, camera.quality])
    return np.asarray(cv2.imdecode(file, cv2.IMREAD_GRAYSCALE), np.uint8)


def smooth(field: NDArray[np.float32], sigma_px: float) -> Map:
    return np.asarray(cv2.GaussianBlur(field, (0, 0), sigma_px) if sigma_px else field, np.float32)
