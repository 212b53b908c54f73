"""Tags of a TIFF file, which are also those of an EXIF block."""

from __future__ import annotations

import struct
from typing import TypeAlias

Tags: TypeAlias = dict[int, tuple[float, ...]]
"""Values by tag number; a tag of a kind that is not a number is left out."""

WIDTH, HEIGHT, PHOTOMETRIC, ORIENTATION = 256, 257, 262, 274
X_RESOLUTION, Y_RESOLUTION, RESOLUTION_UNIT = 282, 283, 296
_KIND = 254
_SMALLER_OR_MASK = 1 | 4
_MOST_DIRECTORIES = 1_000

_ORDERS = {b"II*\0": "<", b"MM\0*": ">"}
_FORMATS = {1: "B", 3: "H", 4: "I", 5: "II", 6: "b", 8: "h", 9: "i", 10: "ii"}
_RATIONALS = (5, 10)
_MM_PER_UNIT = {2: 25.4, 3: 10.0}
_MOST_VALUES = 4


def read_tags(data: bytes) -> Tags:
    """The first directory of a TIFF file or of an EXIF block, of either byte order (TIFF 6.0, section 2).

    Only the first four values of a tag are read. Raises ValueError or struct.error where data is no TIFF or cut short.
    """
    order = _order(data)
    (directory,) = struct.unpack_from(order + "I", data, 4)
    return _directory(data, directory, order)[0]


def is_tiff(data: bytes) -> bool:
    return data[:4] in _ORDERS


def page_directories(data: bytes) -> list[int]:
    """Where the directory of each page of a TIFF file lies; smaller copies and masks of pages are left out.

    Each is met once, also where they point at each other. Raises ValueError or struct.error where data is no TIFF or
    cut short.
    """
    order = _order(data)
    (first,) = struct.unpack_from(order + "I", data, 4)
    at, pages, met = first, list[int](), set[int]()
    while at and at not in met and len(met) < _MOST_DIRECTORIES:
        met.add(at)
        tags, following = _directory(data, at, order)
        if not int(tags.get(_KIND, (0,))[0]) & _SMALLER_OR_MASK:
            pages.append(at)
        at = following
    return pages or [first]


def with_first(data: bytes, directory: int) -> bytes:
    """The same TIFF file, its first page that of this directory."""
    place = struct.pack(_order(data) + "I", directory)
    return data if data[4:8] == place else b"".join((data[:4], place, memoryview(data)[8:]))


def orientation(tags: Tags) -> int:
    """How the picture is to be turned, 1 (not at all) to 8."""
    value = int(tags.get(ORIENTATION, (1,))[0])
    return value if 1 <= value <= 8 else 1


def resolution(tags: Tags) -> float | None:
    """Pixels a mm, None where the tags state none."""
    unit_mm = _MM_PER_UNIT.get(int(tags.get(RESOLUTION_UNIT, (2,))[0]))
    if unit_mm is None or X_RESOLUTION not in tags:
        return None
    across = tags[X_RESOLUTION][0]
    return px_per_mm(across, tags.get(Y_RESOLUTION, (across,))[0], unit_mm=unit_mm)


def px_per_mm(across: float, down: float, *, unit_mm: float) -> float | None:
    """From pixels a unit; None where none are stated or the pixels are not square."""
    if min(across, down) <= 0 or max(across, down) > 1.02 * min(across, down):
        return None
    return across / unit_mm


def _order(data: bytes) -> str:
    order = _ORDERS.get(data[:4])
    if order is None:
        raise ValueError("it is no TIFF with 32-bit offsets")
    return order


def _directory(data: bytes, at: int, order: str) -> tuple[Tags, int]:
    """Its tags, and where the next one lies; 0: there is none, or the file ends with this one."""
    (count,) = struct.unpack_from(order + "H", data, at)
    entries = (at + 2 + 12 * index for index in range(count))
    tags = {tag: values for tag, values in (_entry(data, entry, order) for entry in entries) if values}
    end = at + 2 + 12 * count
    return tags, struct.unpack_from(order + "I", data, end)[0] if end + 4 <= len(data) else 0


def _entry(data: bytes, at: int, order: str) -> tuple[int, tuple[float, ...]]:
    tag, kind, count = struct.unpack_from(order + "HHI", data, at)
    if kind not in _FORMATS or count == 0:
        return tag, ()
    count = min(count, _MOST_VALUES)
    form = order + _FORMATS[kind] * count
    where = at + 8
    if struct.calcsize(form) > 4:
        (where,) = struct.unpack_from(order + "I", data, where)
    values = struct.unpack_from(form, data, where)
    if kind not in _RATIONALS:
        return tag, values
    return tag, tuple(up / down if down else 0.0 for up, down in zip(values[::2], values[1::2], strict=True))
