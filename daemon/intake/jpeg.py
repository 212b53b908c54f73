"""The segments of a JPEG file: its size, resolution and EXIF block, and whether its end is there."""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator
from dataclasses import dataclass

from daemon.intake.tags import px_per_mm

_EOI, _APP0, _APP1 = 0xD9, 0xE0, 0xE1
_FRAMES = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
_MM_PER_UNIT = {1: 25.4, 2: 10.0}
# In coded data 0xFF is followed by 0 or is a restart marker; anything else ends the scan.
_NEXT_MARKER = re.compile(rb"\xff+([^\x00\xd0-\xd7\xff])")


@dataclass(frozen=True, slots=True)
class Jpeg:
    width_px: int
    height_px: int
    px_per_mm: float | None
    exif: bytes
    whole: bool


def read_jpeg(data: bytes) -> Jpeg:
    """Walks the segments (ITU-T T.81, annex B), baseline and progressive alike, to the end of the picture.

    Raises ValueError where there is no frame before the end, struct.error where a segment is cut short.
    """
    size: tuple[int, int] | None = None
    stated: float | None = None
    exif, whole = b"", False
    for marker, segment in _segments(data):
        if marker in _FRAMES and size is None:
            height_px, width_px = struct.unpack_from(">HH", segment, 1)
            size = (width_px, height_px)
        elif marker == _APP0 and segment.startswith(b"JFIF\0"):
            stated = _density(segment)
        elif marker == _APP1 and segment.startswith(b"Exif\0\0"):
            exif = segment[6:]
        whole = marker == _EOI
    if size is None:
        raise ValueError("it ends before the size is stated")
    return Jpeg(*size, stated, exif, whole)


def _segments(data: bytes) -> Iterator[tuple[int, bytes]]:
    """Each marker with its segment, up to the end of the picture or of the data."""
    at = 2
    while (found := _NEXT_MARKER.search(data, at)) is not None:
        marker, at = found[1][0], found.end()
        if marker == _EOI:
            yield marker, b""
            return
        if at + 2 > len(data):
            return
        (length,) = struct.unpack_from(">H", data, at)
        yield marker, data[at + 2 : at + length]
        at += length


def _density(segment: bytes) -> float | None:
    unit, across, down = struct.unpack_from(">BHH", segment, 7)
    return px_per_mm(across, down, unit_mm=_MM_PER_UNIT[unit]) if unit in _MM_PER_UNIT else None
