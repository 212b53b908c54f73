"""Pixels of any depth and colour become grey on white."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.bands import bands
from daemon.shapes import Colours, Grey

_SAMPLED_ROWS = 512
_PALE_CHROMA, _CHROMA_GAIN = 12.0, 2.0
"""What paper, light and JPEG make of white has less colour; beyond, each step of colour darkens by so many of grey."""


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


def to_colours(pixels: NDArray[Any], *, white: int | None = None, premultiplied: bool = False) -> Colours:
    """The same in colour: (H, W, 3) uint8, blue green red."""
    samples = _bytes(pixels, white)
    if samples.ndim == 2 or samples.shape[2] == 1:
        return np.asarray(cv2.cvtColor(samples, cv2.COLOR_GRAY2BGR), np.uint8)
    colours, alpha = samples[..., :3], np.repeat(samples[..., 3:], 3, axis=2)
    if not alpha.size:
        return colours
    dimmed = colours if premultiplied else cv2.multiply(colours, alpha, scale=1 / 255)
    return np.asarray(cv2.add(dimmed, cv2.bitwise_not(alpha)), np.uint8)


def darkened(grey: Grey, colours: Colours) -> Grey:
    """The grey of a picture in which what is as light as the paper but coloured, as yellow is, counts as ink, too.

    On dark paper it is made lighter. Measured by how far a colour is from the paper's (chroma of CIELAB).
    """
    step = max(1, len(grey) // _SAMPLED_ROWS)
    sample = cv2.cvtColor(np.ascontiguousarray(colours[::step]), cv2.COLOR_BGR2LAB)
    light, green_red, blue_yellow = np.median(sample.reshape(-1, 3), axis=0).tolist()
    found = np.empty_like(grey)
    for band in bands(len(grey)):
        rows = band.own
        lab = cv2.cvtColor(colours[rows], cv2.COLOR_BGR2LAB).astype(np.float32)
        chroma = np.hypot(lab[..., 1] - green_red, lab[..., 2] - blue_yellow)
        ink = _CHROMA_GAIN * np.maximum(chroma - _PALE_CHROMA, 0.0)
        found[rows] = np.clip(grey[rows] - ink if light >= 128 else grey[rows] + ink, 0, 255)
    return found


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
