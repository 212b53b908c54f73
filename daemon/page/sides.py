"""A straight side of a sheet: where the picture shows it, and how clearly."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from daemon.shapes import Grey, Points

_NEAR_BORDER_PX = 3.0
_LEAST_SIDE = 0.12
"""Of the picture's shorter side: what is shorter is a corner torn off or hidden by a thumb."""
_LOOKS = 48
_BESIDE_PX = (3.0, 6.0)
_STEADY = 15
"""Percentile of the steps along a side: so few looks may fail, where a shadow crosses it."""
_SEARCH_PX = 3.0
_BENT = 3.0


@dataclass(frozen=True, slots=True, eq=False)
class Side:
    """From start to end, (2,) each in px, the sheet to the right of the way (clockwise, y down)."""

    start: Points
    end: Points

    @property
    def length(self) -> float:
        return float(np.hypot(*(self.end - self.start)))

    @property
    def along(self) -> Points:
        return np.asarray((self.end - self.start) / self.length)

    @property
    def inward(self) -> Points:
        return np.array([-self.along[1], self.along[0]])

    def looks(self, count: int) -> Points:
        """Points along it, (N, 2), its ends left out."""
        return np.asarray(self.start + (self.end - self.start) * np.linspace(0.06, 0.94, count)[:, None])

    def step(self, bare: Grey) -> float:
        """By how much darker than the sheet beside it the ground is, as a share, in all but a few places."""
        inside = np.mean([_levels(bare, self.looks(_LOOKS) + px * self.inward) for px in _BESIDE_PX], axis=0)
        outside = np.mean([_levels(bare, self.looks(_LOOKS) - px * self.inward) for px in _BESIDE_PX], axis=0)
        return float(np.percentile((inside - outside) / np.maximum(inside, 1), _STEADY))

    def meets(self, other: Side) -> Points:
        """Where the two sides, lengthened, cross; (2,)."""
        ways = np.stack([self.along, -other.along], axis=1)
        return np.asarray(self.start + self.along * np.linalg.solve(ways, other.start - self.start)[0])

    def beyond(self, width: int, height: int, *, inset: float) -> Points:
        """A rectangle, (4, 2), that holds all of the picture on the far side, and `inset` px on this one."""
        far = float(width + height)
        a, b = self.start + inset * self.inward - far * self.along, self.end + inset * self.inward + far * self.along
        return np.array([a, b, b - far * self.inward, a - far * self.inward])


def around(corners: Points) -> list[Side]:
    """The sides between corners, (N, 2) in px, clockwise."""
    if cv2.contourArea(corners.astype(np.float32), True) < 0:
        corners = corners[::-1]
    return [Side(a, b) for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)]


def sides_of(hull: Points, shape: tuple[int, ...]) -> list[Side]:
    """The straight sides of a convex outline, clockwise, those along the picture's border left out.

    hull: (N, 2) in px. shape: (H, W). Corners that are cut off or hidden are left out; a rounded outline has no sides
    or too many.
    """
    length = cv2.arcLength(hull.astype(np.float32), True)
    corners = cv2.approxPolyDP(hull.astype(np.float32), 0.02 * length, True).reshape(-1, 2).astype(float)
    least = _LEAST_SIDE * min(shape)
    return [side for side in around(corners) if side.length >= least and not _on_border(side, (shape[0], shape[1]))]


def _on_border(side: Side, shape: tuple[int, int]) -> bool:
    last = np.array([shape[1] - 1, shape[0] - 1])
    low, high = np.minimum(side.start, side.end), np.maximum(side.start, side.end)
    near = [low > last - _NEAR_BORDER_PX, high < _NEAR_BORDER_PX]
    return bool(np.any(near))


def sharpened(grey: Grey, side: Side, scale: float) -> Side:
    """The side of the picture reduced by `scale`, in px of the picture: a line through the steepest steps across it."""
    start, end = ((point + 0.5) * scale - 0.5 for point in (side.start, side.end))
    rough = Side(start, end)
    offsets = np.arange(-_SEARCH_PX * scale, _SEARCH_PX * scale + 0.5, max(0.5, scale / 4))
    looks = rough.looks(_LOOKS)
    across = np.stack([_levels(grey, looks + px * rough.inward) for px in offsets], axis=1)
    steps = np.diff(cv2.GaussianBlur(across, (0, 0), sigmaX=1.5, sigmaY=0.01), axis=1)
    steepest = looks + (offsets[:-1] + offsets[1:])[steps.argmax(axis=1), None] / 2 * rough.inward
    for _ in range(2):
        vx, vy, x, y = cv2.fitLine(steepest.astype(np.float32), cv2.DIST_HUBER, 0, 0.01, 0.01).ravel().tolist()
        off = np.abs((steepest - (x, y)) @ (-vy, vx))
        steepest = steepest[off <= max(_BENT * float(np.median(off)), 0.5)]
    way = np.array([vx, vy]) * (1 if np.array([vx, vy]) @ rough.along > 0 else -1)
    on = np.array([x, y])
    return Side(on + way * ((start - on) @ way), on + way * ((end - on) @ way))


def _levels(grey: Grey, points: Points) -> Points:
    """Grey levels at points, (N,) float64; beyond the border as on it."""
    x, y = (each.astype(np.float32)[:, None] for each in points.T)
    found = cv2.remap(grey, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(found, np.float64).ravel()
