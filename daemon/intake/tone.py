"""Pixels of any depth and colour become grey on white."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.shapes import Grey


def to_grey(pixels: NDArray[Any], *, white: int | None = None, premultiplied: bool = False) -> Grey:
    """One byte a pixel, 0 black to 255 white; what is transparent shows white paper.

    pixels: (H, W), or (H, W, 1), (H, W, 3) as BGR, (H, W, 4) as BGRA; integers, or floats of 0..1, where they are
    greater of 0..255. white: the sample value of white, by default the greatest of the type. premultiplied: the
    colours are already dimmed by their alpha. Luma of ITU-R BT.601. Samples that are no number are white.
    """
    samples = _bytes(pixels, white)
    if samples.ndim == 2 or samples.shape[2] == 1:
        return samples.reshape(samples.shape[:2])
    if samples.shape[2] == 3:
        return np.asarray(cv2.cvtColor(samples, cv2.COLOR_BGR2GRAY), np.uint8)
    grey, alpha = cv2.cvtColor(samples, cv2.COLOR_BGRA2GRAY), np.ascontiguousarray(samples[..., 3])
    dimmed = grey if premultiplied else cv2.multiply(grey, alpha, scale=1 / 255)
    return np.asarray(cv2.add(dimmed, cv2.bitwise_not(alpha)), np.uint8)


def _bytes(pixels: NDArray[Any], white: int | None) -> NDArray[np.uint8]:
    if pixels.dtype == np.uint8 and white in (None, 255):
        return pixels
    if np.issubdtype(pixels.dtype, np.floating):
        return _bytes_of_floats(pixels)
    top = white or np.iinfo(pixels.dtype).max
    if pixels.dtype in (np.uint16, np.uint8):
        return np.asarray(cv2.convertScaleAbs(pixels, alpha=255 / top), np.uint8)
    return np.asarray(np.rint(np.clip(pixels, 0, top) * (255 / top)), np.uint8)


def _bytes_of_floats(pixels: NDArray[Any]) -> NDArray[np.uint8]:
    known = np.isfinite(pixels)
    top = float(pixels.max(where=known, initial=0.0))
    scaled = pixels * (1.0 if top > 1 else 255.0)
    return np.asarray(np.rint(np.clip(np.where(known, scaled, 255.0), 0, 255)), np.uint8)
