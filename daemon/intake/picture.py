"""Any file that can be drawn becomes a page: a raster to be read, or a page of lines that are known."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable
from pathlib import Path

from daemon.errors import BadPicture
from daemon.intake.decode import decode, read_file
from daemon.intake.vector import dxf, svg
from daemon.intake.vector.common import Vectors
from daemon.intake.vector.sheet import VectorPage, as_page
from daemon.shapes import PageImage

INSTALL = "pip install 'linedrawd[documents]'"
_HEAD_BYTES = 4096
_SVG = re.compile(rb"(?:\xef\xbb\xbf)?\s*<(?:\?xml|!--|!DOCTYPE\s+svg|svg)", re.IGNORECASE)


def open_picture(path: Path, *, max_megapixels: float = 100.0, name: str = "") -> PageImage | VectorPage:
    """What lies in a file, told by its content: a raster as `decode` gives it, an SVG or DXF as a page of lines.

    name: what people call the file, if not by its path. Raises BadPicture as `decode` does, and for a vector file that
    is too large, damaged, or holds what is not drawn.
    """
    name = name or str(path)
    head = _head(path)
    if _SVG.match(head):
        return _lines(path, name, "an SVG", svg.MOST_BYTES, svg.read_svg)
    if dxf.HEAD.match(head):
        return _lines(path, name, "a DXF", dxf.MOST_BYTES, dxf.read_dxf)
    return decode(path, max_megapixels=max_megapixels, name=name)


def _lines(path: Path, name: str, kind: str, most_bytes: int, read: Callable[[bytes], Vectors]) -> VectorPage:
    data = read_file(path, name, most_bytes=most_bytes)
    try:
        return as_page(read(data), sha256=hashlib.sha256(data).hexdigest())
    except ValueError as error:
        raise BadPicture(f"{name} is {kind} that {error}") from error
    except ModuleNotFoundError as error:
        raise BadPicture(f"{name} is {kind}, and {error.name} is not installed: {INSTALL}") from error


def _head(path: Path) -> bytes:
    """Of a file that cannot be opened nothing: reading it says why."""
    if path.is_symlink() or not path.is_file():
        return b""
    try:
        with path.open("rb") as file:
            return file.read(_HEAD_BYTES)
    except OSError:
        return b""
