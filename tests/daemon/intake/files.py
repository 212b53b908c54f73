"""Picture files written byte by byte, so that every kind and depth can be asked for."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np

from daemon.intake.decode import decode
from daemon.shapes import Grey, PageImage

CORNER = np.full((24, 40), 255, np.uint8)
CORNER[:8, :8] = 0  # ink in the top left corner, 40 px wide, 24 high

GREY, RGB, PALETTE, GREY_ALPHA, RGBA = 0, 2, 3, 4, 6


def decoded(tmp_path: Path, data: bytes, name: str = "picture", *, max_megapixels: float = 100.0) -> PageImage:
    (tmp_path / name).write_bytes(data)
    return decode(tmp_path / name, max_megapixels=max_megapixels)


def wavy() -> Grey:
    """A picture that is hard to compress."""
    return np.random.default_rng(0).integers(0, 256, (120, 160), np.uint8)


def encoded(extension: str, picture: Grey, *options: int) -> bytes:
    done, data = cv2.imencode(extension, picture, options)
    assert done
    return bytes(data)


def chunk(name: bytes, content: bytes) -> bytes:
    return struct.pack(">I", len(content)) + name + content + struct.pack(">I", zlib.crc32(name + content))


def png(
    width_px: int, height_px: int, rows: Sequence[bytes], *, depth: int = 8, colour: int = GREY, more: bytes = b""
) -> bytes:
    head = struct.pack(">IIBBBBB", width_px, height_px, depth, colour, 0, 0, 0)
    body = zlib.compress(b"".join(b"\0" + row for row in rows))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + more + chunk(b"IDAT", body) + chunk(b"IEND", b"")


def tags(order: str, entries: dict[int, tuple[int, Sequence[int]]], pixels: bytes = b"") -> bytes:
    """A TIFF file, or without pixels an EXIF block: tag -> (type, values); the pixels' place (tag 273) is filled in."""
    kinds = {3: "H", 4: "I", 5: "I"}
    after = 8 + 2 + 12 * len(entries) + 4
    rows, tail = b"", b""
    for tag, (kind, values) in sorted(entries.items()):
        content = struct.pack(f"{order}{len(values)}{kinds[kind]}", *values)
        count = len(values) // 2 if kind == 5 else len(values)
        if len(content) > 4:
            tail, content = tail + content, struct.pack(order + "I", after + len(tail))
        rows += struct.pack(order + "HHI", tag, kind, count) + (b"PLCE" if tag == 273 else content.ljust(4, b"\0"))
    place = struct.pack(order + "I", after + len(tail))
    magic = {"<": b"II*\0", ">": b"MM\0*"}[order]
    head = magic + struct.pack(order + "IH", 8, len(entries))
    return head + rows.replace(b"PLCE", place) + bytes(4) + tail + pixels


def tiff(
    width_px: int,
    height_px: int,
    pixels: bytes,
    *,
    bits: Sequence[int] = (8,),
    photometric: int = 1,
    order: str = "<",
    more: dict[int, tuple[int, Sequence[int]]] | None = None,
) -> bytes:
    entries: dict[int, tuple[int, Sequence[int]]] = {
        256: (3, [width_px]),
        257: (3, [height_px]),
        258: (3, bits),
        259: (3, [1]),
        262: (3, [photometric]),
        273: (4, [0]),
        277: (3, [len(bits)]),
        278: (3, [height_px]),
        279: (4, [len(pixels)]),
    }
    return tags(order, entries | (more or {}), pixels)


def exif(*, turned: int = 1, dpi: int = 300, order: str = "<") -> bytes:
    return tags(order, {274: (3, [turned]), 282: (5, [dpi, 1]), 283: (5, [dpi, 1]), 296: (3, [2])})


def jpeg_with_exif(jpeg: bytes, block: bytes) -> bytes:
    segment = b"Exif\0\0" + block
    return jpeg[:2] + b"\xff\xe1" + struct.pack(">H", len(segment) + 2) + segment + jpeg[2:]


def webp_with_exif(webp: bytes, width_px: int, height_px: int, block: bytes) -> bytes:
    """An extended file (VP8X) around a simple one."""
    wide, high = ((side - 1).to_bytes(3, "little") for side in (width_px, height_px))
    head = b"VP8X" + struct.pack("<II", 10, 0x08) + wide + high
    block += bytes(len(block) % 2)
    content = b"WEBP" + head + webp[12:] + b"EXIF" + struct.pack("<I", len(block)) + block
    return b"RIFF" + struct.pack("<I", len(content)) + content


def cmyk_jpeg(levels: Sequence[int]) -> bytes:
    """8 x 8 px of one CMYK colour, inverted (255 = no ink) as Adobe writes it: a baseline file, four blocks with DC."""

    def segment(marker: int, content: bytes) -> bytes:
        return struct.pack(">BBH", 0xFF, marker, len(content) + 2) + content

    # DC sizes 0 to 11 have the four-bit codes 0 to 11; the AC end of block is "0".
    dc = segment(0xC4, b"\x00" + bytes([0, 0, 0, 12] + [0] * 12) + bytes(range(12)))
    ac = segment(0xC4, b"\x10" + bytes([1] + [0] * 15) + b"\x00")
    frame = segment(0xC0, struct.pack(">BHHB", 8, 8, 8, 4) + b"".join(bytes([c, 0x11, 0]) for c in range(1, 5)))
    scan = segment(0xDA, b"\x04" + b"".join(bytes([c, 0]) for c in range(1, 5)) + b"\x00\x3f\x00")
    adobe = segment(0xEE, b"Adobe" + struct.pack(">HHHB", 100, 0, 0, 0))
    bits = ""
    for level in levels:
        value = 8 * (level - 128)
        size = abs(value).bit_length()
        coded = value if value >= 0 else value + (1 << size) - 1
        bits += f"{size:04b}" + (f"{coded:0{size}b}" if size else "") + "0"
    bits += "1" * (-len(bits) % 8)
    data = int(bits, 2).to_bytes(len(bits) // 8, "big").replace(b"\xff", b"\xff\0")
    table = segment(0xDB, b"\0" + bytes([1] * 64))
    return b"\xff\xd8" + adobe + table + frame + dc + ac + scan + data + b"\xff\xd9"
