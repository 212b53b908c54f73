"""XENT beside MWX on one drawing, as the paper shows it: what weighing by the greater of two labels changes."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import torch
from numpy.typing import NDArray

from training.export import load
from training.render import CORNERS, Sample, reference

HOUSE = (
    ((20, 240), (20, 110), (128, 20), (236, 110), (236, 240), (20, 240)),
    ((20, 110), (236, 110)),
    ((50, 135), (110, 135), (110, 195), (50, 195), (50, 135)),
    ((80, 135), (80, 195)),
    ((50, 165), (110, 165)),
    ((150, 240), (150, 150), (205, 150), (205, 240)),
    ((150, 150), (205, 240)),
    ((205, 150), (150, 240)),
)
"""Straight strokes like Quick, Draw!'s simplified ones, but our own."""
LEFT_PX, TOP_PX, SIDE_PX, ZOOM = 34, 92, 84, 5
_COLOURS = np.array([(255, 255, 255), (150, 150, 150), (40, 40, 220)], np.uint8)


def draw_crop(checkpoints: dict[str, Path], path: Path) -> dict[str, float]:
    """page | truth | each network's answer, enlarged; returns each one's corner pixels per true corner pixel.

    checkpoints: caption to checkpoint of a network that reads CANVAS_PX.
    """
    sample = reference([np.array(stroke, np.float32) for stroke in HOUSE])
    answers = {name: answer(checkpoint, sample) for name, checkpoint in checkpoints.items()}
    panels = [
        _panel(np.repeat(255 - sample.ink[..., None], 3, axis=2), "page"),
        _panel(_COLOURS[sample.label], "truth"),
    ]
    panels += [_panel(_COLOURS[label], name) for name, label in answers.items()]
    cv2.imwrite(str(path), np.hstack(panels))
    true = int((sample.label == CORNERS).sum())
    return {name: int((label == CORNERS).sum()) / true for name, label in answers.items()}


def answer(checkpoint: Path, sample: Sample) -> NDArray[np.uint8]:
    """The label that a network gives a page."""
    ink = torch.from_numpy(sample.ink.astype(np.float32) / 255)[None, None]
    with torch.inference_mode():
        label: NDArray[np.uint8] = load(checkpoint)(ink)[0].argmax(dim=0).byte().numpy()
    return label


def _panel(image: NDArray[np.uint8], caption: str) -> NDArray[np.uint8]:
    part = image[TOP_PX : TOP_PX + SIDE_PX, LEFT_PX : LEFT_PX + SIDE_PX]
    large = cv2.resize(np.ascontiguousarray(part), None, fx=ZOOM, fy=ZOOM, interpolation=cv2.INTER_NEAREST)
    framed = cv2.copyMakeBorder(large, 34, 6, 6, 6, cv2.BORDER_CONSTANT, value=(255, 255, 255))
    cv2.putText(framed, caption, (8, 24), cv2.FONT_HERSHEY_SIMPLEX, 0.7, (0, 0, 0), 1, cv2.LINE_AA)
    return np.asarray(framed, np.uint8)
