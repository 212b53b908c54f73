"""What a picture file says of itself before it is decoded: its kind by content, its size, how it is turned."""

from __future__ import annotations

import re
import struct
from collections.abc import Callable
from dataclasses import dataclass, replace

from daemon.intake.jpeg import read_jpeg
from daemon.intake.tags import HEIGHT, PHOTOMETRIC, WIDTH, Tags, orientation, px_per_mm, read_tags, resolution

KINDS = "PNG, JPEG, TIFF, BMP, WebP, PNM"


@dataclass(frozen=True, slots=True)
class Header:
    """Size in px as the file stores it; turned: EXIF orientation that decoding leaves to us, 1 = upright.

    white: the sample value of white, where it is not the greatest of its type. inverted: 0 is white and decoding does
    not mend it. whole: the end of the file is there.
    """

    kind: str
    width_px: int
    height_px: int
    px_per_mm: float | None = None
    turned: int = 1
    white: int | None = None
    inverted: bool = False
    whole: bool = True


def read_header(data: bytes) -> Header:
    """Reads the header of a PNG, JPEG, TIFF, BMP, WebP or PNM file, told apart by their first bytes.

    Raises ValueError with the reason when it is none of these or its header is damaged.
    """
    for magic, reader in _READERS.items():
        if re.match(magic, data, re.DOTALL):
            return _read(reader, data)
    raise ValueError(f"it is empty, {KINDS} expected" if not data else f"it begins with {data[:8]!r}, no {KINDS} does")


def _read(reader: Callable[[bytes], Header], data: bytes) -> Header:
    try:
        header = reader(data)
    except (struct.error, IndexError, KeyError, UnicodeDecodeError) as error:
        raise ValueError(f"its header is damaged or cut short ({error})") from error
    if min(header.width_px, header.height_px) < 1:
        raise ValueError(f"its header says {header.width_px} x {header.height_px} px")
    return header


def _png(data: bytes) -> Header:
    """PNG specification, third edition, section 11."""
    if data[12:16] != b"IHDR":
        raise ValueError("its first chunk is no IHDR")
    width_px, height_px = struct.unpack_from(">II", data, 16)
    header = Header("PNG", width_px, height_px, whole=False)
    at = 8
    while at + 8 <= len(data):
        length, name = struct.unpack_from(">I4s", data, at)
        if name == b"pHYs" and data[at + 16] == 1:
            across, down = struct.unpack_from(">II", data, at + 8)
            header = replace(header, px_per_mm=px_per_mm(across, down, unit_mm=1000.0))
        elif name == b"eXIf":
            header = _with_exif(header, data[at + 8 : at + 8 + length])
        at += 12 + length
        if name == b"IEND":
            return replace(header, whole=at <= len(data))
    return header


def _jpeg(data: bytes) -> Header:
    jpeg = read_jpeg(data)
    header = Header("JPEG", jpeg.width_px, jpeg.height_px, whole=jpeg.whole)
    header = _with_exif(header, jpeg.exif) if jpeg.exif else header
    return header if jpeg.px_per_mm is None else replace(header, px_per_mm=jpeg.px_per_mm)


def _tiff(data: bytes) -> Header:
    tags = read_tags(data)
    width_px, height_px = int(tags[WIDTH][0]), int(tags[HEIGHT][0])
    inverted = tags.get(PHOTOMETRIC, (1,))[0] == 0
    # OpenCV turns a TIFF upright itself: its sizes change sides, `turned` stays 1.
    return Header("TIFF", width_px, height_px, resolution(tags), inverted=inverted)


def _bmp(data: bytes) -> Header:
    """Of OS/2 (12 bytes, no resolution) and of Windows; a negative height means from top to bottom."""
    (size,) = struct.unpack_from("<I", data, 14)
    if size == 12:
        return Header("BMP", *struct.unpack_from("<HH", data, 18))
    width_px, height_px = struct.unpack_from("<ii", data, 18)
    across, down = struct.unpack_from("<ii", data, 38)
    return Header("BMP", width_px, abs(height_px), px_per_mm(across, down, unit_mm=1000.0))


def _webp(data: bytes) -> Header:
    """WebP container specification; RFC 6386, section 9.1, for VP8; the lossless bitstream's section 3 for VP8L."""
    (riff,) = struct.unpack_from("<I", data, 4)
    header = replace(_webp_size(data), whole=8 + riff <= len(data))
    at = 12
    while at + 8 <= len(data):
        name, length = struct.unpack_from("<4sI", data, at)
        if name == b"EXIF":
            return _with_exif(header, data[at + 8 : at + 8 + length].removeprefix(b"Exif\0\0"))
        at += 8 + length + length % 2
    return header


def _webp_size(data: bytes) -> Header:
    match data[12:16]:
        case b"VP8X":
            low_wide, high_wide, low_high, high_high = struct.unpack_from("<HBHB", data, 24)
            return Header("WebP", 1 + low_wide + (high_wide << 16), 1 + low_high + (high_high << 16))
        case b"VP8L":
            (bits,) = struct.unpack_from("<I", data, 21)
            return Header("WebP", 1 + (bits & 0x3FFF), 1 + (bits >> 14 & 0x3FFF))
        case b"VP8 ":
            width_px, height_px = struct.unpack_from("<HH", data, 26)
            return Header("WebP", width_px & 0x3FFF, height_px & 0x3FFF)
    raise ValueError(f"its first chunk is {data[12:16]!r}, no picture")


def _pnm(data: bytes) -> Header:
    """P1 to P6, with comments. OpenCV leaves the samples of P5 and P6, and all of 16 bits, unscaled."""
    kind = data[:2]
    words = rb"P[1-6](?:(?:\s|#[^\n]*\n)+(\d{1,9}))(?:(?:\s|#[^\n]*\n)+(\d{1,9}))(?:(?:\s|#[^\n]*\n)+(\d{1,9}))?"
    found = re.match(words, data[:4096])
    if found is None:
        raise ValueError("its header is damaged or cut short")
    width_px, height_px = int(found[1]), int(found[2])
    if kind in (b"P1", b"P4"):
        return Header("PNM", width_px, height_px)
    white = int(found[3] or 0)
    if not 0 < white < 65536:
        raise ValueError(f"its header says that white is {white}")
    return Header("PNM", width_px, height_px, white=white if kind in (b"P5", b"P6") or white > 255 else None)


def _with_exif(header: Header, exif: bytes) -> Header:
    """Turned, and of the resolution, that EXIF says; a damaged block says nothing."""
    try:
        tags: Tags = read_tags(exif)
    except (ValueError, struct.error):
        return header
    return replace(header, turned=orientation(tags), px_per_mm=header.px_per_mm or resolution(tags))


_READERS: dict[bytes, Callable[[bytes], Header]] = {
    rb"\x89PNG\r\n\x1a\n": _png,
    rb"\xff\xd8\xff": _jpeg,
    rb"II\*\0|MM\0\*": _tiff,
    rb"BM.{12}[\x0c-\x7c]\0\0\0": _bmp,
    rb"RIFF....WEBP": _webp,
    rb"P[1-6][\s#]": _pnm,
}
