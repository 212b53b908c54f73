"""Any file that can be drawn becomes a page: a raster to be read, or a page of lines that are known."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable
from functools import partial
from pathlib import Path

from daemon.colours import ONE_PEN, Pens
from daemon.errors import BadPicture
from daemon.intake.decode import coloured, decode, page_of, read_file
from daemon.intake.heif import HEAD as HEIC
from daemon.intake.heif import read_heif
from daemon.intake.vector import dxf, pdf, svg
from daemon.intake.vector.common import Rendered, Vectors
from daemon.intake.vector.sheet import VectorPage, as_page
from daemon.shapes import PageImage

WITHOUT = {
    "a PDF": "save it as SVG or PNG; where linedrawd came by pip: pip install 'linedrawd[pdf]'",
    "a DXF": "save it as SVG or PDF; where linedrawd came by pip: pip install 'linedrawd[documents]'",
    "a HEIC": "save it as JPEG; where linedrawd came by pip: pip install 'linedrawd[documents]'",
}
"""What helps where the library for a kind of file is missing; Debian's package cannot be added to."""
MOST_HEIC_BYTES = 100_000_000
_HEAD_BYTES = 4096
_SVG = re.compile(rb"(?:\xef\xbb\xbf)?\s*<(?:\?xml|!--|!DOCTYPE\s+svg|svg)", re.IGNORECASE)


def open_picture(
    path: Path, *, max_megapixels: float = 100.0, name: str = "", page: int = 1, pens: Pens = ONE_PEN
) -> PageImage | VectorPage:
    """What lies in a file, told by its content: a raster as `decode` gives it, an SVG or DXF as a page of lines.

    A page of a PDF is one or the other; a HEIC photograph is a raster. page: of a PDF or TIFF, from 1 on. name: what
    people call the file, if not by its path. pens: where there are some, lines have theirs and a raster its colours.
    Raises BadPicture as `decode` does, and for a file that is too large, damaged, or holds what is not drawn.
    """
    name = name or str(path)
    head = _head(path)
    if _SVG.match(head):
        return _read(path, name, "an SVG", svg.MOST_BYTES, svg.read_svg, pens)
    if dxf.HEAD.match(head):
        return _read(path, name, "a DXF", dxf.MOST_BYTES, dxf.read_dxf, pens)
    if pdf.HEAD.match(head):
        in_colour = bool(pens.names)
        read_pdf = partial(pdf.read_pdf, page=page, max_megapixels=max_megapixels, in_colour=in_colour)
        return _read(path, name, "a PDF", pdf.MOST_BYTES, read_pdf, pens)
    if HEIC.match(head):
        read = partial(read_heif, max_megapixels=max_megapixels, in_colour=bool(pens.names))
        return _read(path, name, "a HEIC", MOST_HEIC_BYTES, read, pens)
    return decode(path, max_megapixels=max_megapixels, name=name, page=page, in_colour=bool(pens.names))


def _read(
    path: Path, name: str, kind: str, most_bytes: int, read: Callable[[bytes], Vectors | Rendered], pens: Pens
) -> PageImage | VectorPage:
    data = read_file(path, name, most_bytes=most_bytes)
    try:
        found, sha256 = read(data), hashlib.sha256(data).hexdigest()
        if isinstance(found, Vectors):
            return as_page(found, sha256=sha256, pens=pens)
        page = page_of(found.grey, sha256=sha256, px_per_mm=found.px_per_mm, warnings=found.warnings)
        return page if found.colour is None else coloured(page, found.colour)
    except ValueError as error:
        raise BadPicture(f"{name} is {kind} that {error}") from error
    except ModuleNotFoundError as error:
        raise BadPicture(f"{name} is {kind}, and {error.name} is not installed: {WITHOUT[kind]}") from error


def _head(path: Path) -> bytes:
    """Of a file that cannot be opened nothing: reading it says why."""
    if path.is_symlink() or not path.is_file():
        return b""
    try:
        with path.open("rb") as file:
            return file.read(_HEAD_BYTES)
    except OSError:
        return b""
