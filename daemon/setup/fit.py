"""What a machine does wrong, from where the marks of its test card lie: least squares."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from daemon.errors import BadPicture
from daemon.homography import through
from daemon.setup.card import Card, Mark
from daemon.setup.find import Found
from daemon.shapes import Homography, Points

_OUTLIER_MM = 0.15
_BENT_MM = 0.3
"""Marks that lie farther from any straight machine than this were not drawn or not pictured straight."""


@dataclass(frozen=True, slots=True)
class Errors:
    """What the card shows. scale_x, scale_y, skew_deg, backlash_mm: as in the settings of a machine.

    marks: how many were used. before_mm: how far the farthest of them lies from where it was meant, the card moved
    and turned as a whole; after_mm: the same where these errors are made good; rms_mm: the mean of that.
    """

    scale_x: float
    scale_y: float
    skew_deg: float
    backlash_mm: tuple[float, float]
    marks: int
    before_mm: float
    after_mm: float
    rms_mm: float


def errors_of(found: Sequence[Found], *, px_to_mm: Homography) -> Errors:
    """The errors that explain best where the marks are. px_to_mm: from the picture to true mm, y up.

    A mark says only how far across itself it lies: along itself it ends where the pen went down. Raises BadPicture
    where no scale, skew and backlash explain them.
    """
    fit = _fitted(found, px_to_mm)
    good = np.abs(fit.left_mm) <= max(_OUTLIER_MM, 4 * float(np.median(np.abs(fit.left_mm))))
    kept = [each for each, fine in zip(found, good, strict=True) if fine]
    fit = _fitted(kept, px_to_mm)
    after_mm = float(np.abs(fit.left_mm).max())
    if after_mm > _BENT_MM or len(kept) < 0.8 * len(found):
        raise BadPicture(
            "no scale, skew and backlash explain where the marks lie: scan the card instead of photographing it, "
            "say the size of its sheet with --paper, or look whether the pen wobbles or a belt slips"
        )
    return fit.errors(len(kept), after_mm)


@dataclass(frozen=True, slots=True)
class _Fit:
    """linear: (2, 2), card to sheet. lags_mm: half the backlash of each axis, on the sheet. normals: across the marks.

    left_mm: of each mark, how far it lies from where linear and lags put it.
    """

    linear: NDArray[np.float64]
    lags_mm: tuple[float, float]
    left_mm: NDArray[np.float64]
    meant: Points
    at_mm: Points
    axes: NDArray[np.intp]

    def errors(self, marks: int, after_mm: float) -> Errors:
        scale_x = float(np.hypot(*self.linear[:, 0]))
        right = self.linear[:, 0] / scale_x
        up = np.array([-right[1], right[0]])
        lean, tall = float(right @ self.linear[:, 1]), float(up @ self.linear[:, 1])
        scale_y = math.hypot(lean, tall)
        # A mark of Y is moved along the leaning axis, but seen across itself.
        backlash_mm = 2 * self.lags_mm[0] / (scale_x * tall / scale_y), 2 * self.lags_mm[1] / tall
        return Errors(
            scale_x,
            scale_y,
            math.degrees(math.atan2(lean, tall)),
            (max(0.0, float(backlash_mm[0])), max(0.0, float(backlash_mm[1]))),
            marks,
            self._before_mm(np.column_stack([right, up])),
            after_mm,
            float(np.sqrt(np.mean(self.left_mm**2))),
        )

    def _before_mm(self, turned: NDArray[np.float64]) -> float:
        """Of marks that stay as they are, on a card that is only moved and turned."""
        off = ((self.at_mm - self.meant @ turned.T) * turned.T[self.axes]).sum(axis=1)
        return float(max(np.ptp(off[self.axes == axis]) / 2 for axis in (0, 1)))


def _fitted(found: Sequence[Found], px_to_mm: Homography) -> _Fit:
    """Unknowns: the map of the card onto the sheet, and how far each row lies beside it. Solved twice, for what is
    across a mark is known only then."""
    at_mm = through(px_to_mm, np.array([each.at_px for each in found]))
    meant = np.array([_middle(each.mark) for each in found])
    axes = np.array([each.mark.axis for each in found])
    ways = np.array([each.mark.way for each in found], float)
    linear = np.linalg.lstsq(np.column_stack([meant, np.ones(len(meant))]), at_mm, rcond=None)[0][:2].T
    for _ in range(2):
        normals = _normals(linear)[axes]
        rows = np.column_stack(
            [
                normals[:, :1] * np.column_stack([meant, np.ones(len(meant))]),
                normals[:, 1:] * np.column_stack([meant, np.ones(len(meant))]),
                -np.where(axes == 0, ways, 0.0),
                -np.where(axes == 1, ways, 0.0),
            ]
        )
        wanted = (normals * at_mm).sum(axis=1)
        solved = np.linalg.lstsq(rows, wanted, rcond=None)[0]
        linear = np.array([solved[0:2], solved[3:5]])
    return _Fit(linear, (float(solved[6]), float(solved[7])), wanted - rows @ solved, meant, at_mm, axes)


def _normals(linear: NDArray[np.float64]) -> NDArray[np.float64]:
    """Across the marks of X, which run along Y, and across those of Y: (2, 2), unit vectors."""
    (xx, xy), (yx, yy) = linear
    across = np.array([[yy, -xy], [-yx, xx]])
    return np.asarray(across / np.hypot(across[:, 0], across[:, 1])[:, None], float)


def by_resolution(px_per_mm: float) -> Homography:
    """Px to mm of a picture with that resolution, y turned up."""
    return np.diag([1 / px_per_mm, -1 / px_per_mm, 1.0])


def by_known_width(found: Sequence[Found], to_px: Homography, card: Card, known_mm: float) -> Homography:
    """Px to mm of a picture in which the card's frame is so wide, from the middle of one side's line to the other's.

    The left side is drawn on the way back and the right one on the way there, so backlash makes the frame narrower.
    """
    ends = through(to_px, np.array([[0.0, 0.0], [card.width_mm, 0.0]]))
    about = float(np.hypot(*(ends[1] - ends[0]))) / known_mm
    errors = errors_of(found, px_to_mm=by_resolution(about))
    return by_resolution(about * errors.scale_x * (card.width_mm - errors.backlash_mm[0]) / known_mm)


def _middle(mark: Mark) -> tuple[float, float]:
    return (mark.start_mm[0] + mark.end_mm[0]) / 2, (mark.start_mm[1] + mark.end_mm[1]) / 2
