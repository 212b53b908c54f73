"""Any raster file becomes an upright grey page, or is refused with a reason."""

from __future__ import annotations

import errno
import hashlib
import math
import os
import stat
import struct
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.errors import BadPicture
from daemon.intake.header import Header, read_header
from daemon.intake.pages import checked_page
from daemon.intake.tags import is_tiff, page_directories, with_first
from daemon.intake.tone import darkened, to_colours, to_grey
from daemon.shapes import Colours, Grey, PageImage

_MOST_BYTES_PER_PX = 16
_MOST_OVERHEAD_BYTES = 64_000_000
_COLOUR_PX = 4_000_000
"""Colours are kept of so many pixels at most: pens are told apart by far less than the page's lines."""


def decode(
    path: Path, *, max_megapixels: float = 100.0, name: str = "", page: int = 1, in_colour: bool = False
) -> PageImage:
    """Reads a PNG, JPEG, TIFF (one of its pages, from 1 on), BMP, WebP or PNM file; its name and extension say nothing.

    The size is read from the header and checked before anything is decoded. The page is upright as EXIF says, alpha
    lies over white, every depth becomes 8 bits. name: what people call the file, if not by its path. in_colour: the
    page keeps its colours, and what is coloured counts as ink however light it is. Raises BadPicture
    when the file cannot be opened (links and what is no regular file are not), is none of these, is greater than
    max_megapixels, damaged or cut short, MemoryError where there is too little memory for its pixels.
    """
    name = name or str(path)
    data = read_file(path, name, most_bytes=int(max_megapixels * 1e6) * _MOST_BYTES_PER_PX + _MOST_OVERHEAD_BYTES)
    sha256 = hashlib.sha256(data).hexdigest()
    data = _with_page_first(name, data, page)
    header = _checked_header(name, data, max_megapixels)
    pixels = _pixels(name, data, header, in_colour=in_colour)
    grey = _upright(_toned(pixels, header, to_grey), header.turned)
    found = page_of(grey, sha256=sha256, px_per_mm=header.px_per_mm)
    return coloured(found, _upright(_toned(pixels, header, to_colours), header.turned)) if in_colour else found


def page_of(grey: Grey, *, sha256: str, px_per_mm: float | None = None, warnings: tuple[str, ...] = ()) -> PageImage:
    """The page of these pixels, just as they were given."""
    height_px, width_px = grey.shape
    return PageImage(
        grey=grey,
        to_given=np.eye(3),
        given_width_px=width_px,
        given_height_px=height_px,
        sha256=sha256,
        px_per_mm=px_per_mm,
        warnings=warnings,
    )


def coloured(page: PageImage, colours: Colours) -> PageImage:
    """The page with its colours, made smaller where they are many; what is coloured counts as ink on it."""
    scale = min(1.0, math.sqrt(_COLOUR_PX * 3 / colours.size))
    small = cv2.resize(colours, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA) if scale < 1 else colours
    return replace(page, grey=darkened(page.grey, colours), colour=np.asarray(small, np.uint8))


def read_file(path: Path, name: str, *, most_bytes: int) -> bytes:
    """The file's bytes, as `name`. Raises BadPicture for one that is larger, a link, or no regular file.

    O_NONBLOCK: opening a FIFO that nobody writes would wait for ever.
    """
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
        with open(descriptor, "rb") as file:
            status = os.fstat(descriptor)
            if not stat.S_ISREG(status.st_mode):
                raise BadPicture(f"{name} is no regular file: drop the picture itself")
            if status.st_size > most_bytes:
                raise BadPicture(f"{name} has {status.st_size} bytes, at most {most_bytes} are read: make it smaller")
            return file.read()
    except OSError as error:
        raise BadPicture(_why_unread(name, error)) from error


def _why_unread(name: str, error: OSError) -> str:
    if error.errno == errno.ELOOP:
        return f"{name} is a symbolic link, which is not followed: drop the picture itself"
    return f"{name} cannot be read ({error.strerror}): check that it is there and mend its rights"


def _with_page_first(name: str, data: bytes, page: int) -> bytes:
    """What is decoded of a TIFF is its first page. Every other picture is one page."""
    try:
        directories = page_directories(data) if is_tiff(data) else [0]
    except (ValueError, struct.error) as error:
        raise BadPicture(f"{name} is a TIFF that is damaged or cut short ({error}): copy it again") from error
    try:
        directory = directories[checked_page(page, len(directories)) - 1]
    except ValueError as error:
        raise BadPicture(f"{name} {error}") from error
    return with_first(data, directory) if directory else data


def _checked_header(name: str, data: bytes, max_megapixels: float) -> Header:
    try:
        header = read_header(data)
    except ValueError as error:
        raise BadPicture(f"{name} is no picture that can be read, {error}: save it anew as PNG") from error
    if header.width_px * header.height_px > max_megapixels * 1e6:
        raise BadPicture(
            f"{name} is a {header.kind} of {header.width_px} x {header.height_px} px, at most {max_megapixels:g} "
            "megapixels are read: make it smaller, or raise max_megapixels"
        )
    if not header.whole:
        raise BadPicture(_damaged(name, header))
    return header


def _pixels(name: str, data: bytes, header: Header, *, in_colour: bool) -> NDArray[Any]:
    # JPEG holds its luma apart: decoding that alone takes a third of the memory.
    jpeg = cv2.IMREAD_IGNORE_ORIENTATION | (cv2.IMREAD_COLOR if in_colour else cv2.IMREAD_GRAYSCALE)
    flags = jpeg if header.kind == "JPEG" else cv2.IMREAD_UNCHANGED
    try:
        pixels = cv2.imdecode(np.frombuffer(data, np.uint8), flags)
    except cv2.error as error:
        if error.code == cv2.Error.StsNoMem:
            raise MemoryError from error
        raise BadPicture(_damaged(name, header)) from error
    if pixels is None:
        raise BadPicture(_damaged(name, header))
    return np.asarray(pixels)


def _damaged(name: str, header: Header) -> str:
    return f"{name} is a {header.kind} that is damaged, cut short or of a rare form: copy it again, or save it as PNG"


def _toned(pixels: NDArray[Any], header: Header, tone: Callable[..., NDArray[np.uint8]]) -> NDArray[np.uint8]:
    # libtiff dims the colours of 8-bit TIFFs by their alpha and mends white-is-zero; it leaves deeper ones alone.
    shallow_tiff = header.kind == "TIFF" and pixels.dtype == np.uint8
    found = tone(pixels, white=header.white, premultiplied=shallow_tiff)
    return 255 - found if header.inverted and not shallow_tiff else found


def _upright(grey: NDArray[np.uint8], turned: int) -> NDArray[np.uint8]:
    """Undo the camera's turn (EXIF 2.3, tag 274)."""
    if turned >= 5:
        grey = grey.swapaxes(0, 1)
    if turned in (3, 4, 7, 8):
        grey = grey[::-1]
    if turned in (2, 3, 6, 7):
        grey = grey[:, ::-1]
    return np.ascontiguousarray(grey)
