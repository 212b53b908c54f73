"""Pages with known ink."""

from __future__ import annotations

import cv2
import numpy as np

from daemon.shapes import Grey, PageImage


def page(grey: Grey) -> PageImage:
    return PageImage(grey, np.eye(3), grey.shape[1], grey.shape[0], sha256="")


def drawn(*, width_px: float = 2.5, side_px: int = 256, ink: int = 0, paper: int = 255) -> Grey:
    """Three rings and a cross, area-averaged from eight times the size."""
    fine = np.full((8 * side_px, 8 * side_px), paper, np.uint8)
    thick, middle = round(8 * width_px), 4 * side_px
    for share in (0.4, 0.25, 0.1):
        cv2.circle(fine, (middle, middle), round(8 * side_px * share), ink, thick)
    cv2.line(fine, (middle, side_px), (middle, 7 * side_px), ink, thick)
    cv2.line(fine, (side_px, middle), (7 * side_px, middle), ink, thick)
    return np.asarray(cv2.resize(fine, (side_px, side_px), interpolation=cv2.INTER_AREA), np.uint8)


def overlap(one: Grey, other: Grey) -> float:
    """Intersection over union of what is darker than the middle."""
    a, b = one < 128, other < 128
    return float((a & b).sum() / (a | b).sum())


def grain(grey: Grey, sigma: float) -> Grey:
    noise = np.random.default_rng(0).normal(0, sigma, grey.shape)
    return np.clip(grey + noise, 0, 255).astype(np.uint8)


def in_shadow(grey: Grey, darkest: float) -> Grey:
    """Light falls off from left to right, down to this share."""
    light = np.linspace(1, darkest, grey.shape[1])
    return np.rint(grey * light).astype(np.uint8)
