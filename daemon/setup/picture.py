"""The picture that shows which marks of a test card were found, and how far each lies from where it should."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from daemon.homography import through
from daemon.setup.card import Card
from daemon.setup.find import Found
from daemon.shapes import Grey, Homography

_MOST_PX = 2000
_FOUND, _MEANT = (40, 150, 60), (50, 40, 215)
"""Green is where a mark was found; red, the outline of the card as it is nearest to what was drawn."""
_BITS = 4


def found_picture(grey: Grey, card: Card, found: Sequence[Found], to_px: Homography) -> bytes:
    """A PNG, at most 2000 px: the frame in red, a green ring around each mark that was found."""
    scale = min(1.0, _MOST_PX / max(grey.shape))
    small = cv2.resize(grey, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    picture = cv2.cvtColor(small, cv2.COLOR_GRAY2BGR)
    frame = np.rint(through(to_px, card.corners_mm) * scale * (1 << _BITS)).astype(np.int32)
    cv2.polylines(picture, [frame], True, _MEANT, 1, cv2.LINE_AA, _BITS)
    for each in found:
        x, y = (round(at * scale * (1 << _BITS)) for at in each.at_px)
        cv2.circle(picture, (x, y), 5 << _BITS, _FOUND, 2, cv2.LINE_AA, _BITS)
    return bytes(cv2.imencode(".png", picture)[1])
