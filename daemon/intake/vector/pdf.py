"""A page of a PDF becomes lines where it holds nothing else, and a picture where it does. The only door to PDFium."""

from __future__ import annotations

import io
import math
import re
from collections.abc import Iterator
from contextlib import closing, contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray

from daemon.intake.pages import PDF_HEAD, checked_page
from daemon.intake.vector.common import Rendered, Vectors, checked_size
from daemon.intake.vector.pdf_paths import Reading
from daemon.intake.vector.seen import share_seen
from daemon.intake.vector.svg_units import Matrix

MOST_BYTES = 200_000_000
HEAD = PDF_HEAD
_MM_PER_PT = 25.4 / 72
_DPI = 300.0
_MOST_MEGAPIXELS = 35.0
"""A page of A2 at 300 dpi: the lines of a larger one are seen with fewer."""
_LOOK_DPI, _LOOK_MEGAPIXELS = 150.0, 4.0
_LEAST_SEEN = 0.98
_LINKS = ("LINK", "POPUP")
_UNIT = re.compile(rb"/Type\s*/Page\s*/UserUnit\s+([0-9.]+)")


def read_pdf(data: bytes, *, page: int, max_megapixels: float, in_colour: bool = False) -> Vectors | Rendered:
    """One page of a PDF, from 1 on, as large as it says, turned and cropped as it is shown.

    Lines where it holds paths alone and looks like them: outlines of what is filled, cut off at the box round its clip,
    without what is white. With text, pictures, shadings or notes on it, or where something hides lines, all of it is a
    picture of 300 dpi, fewer where the page is larger than A2, or that were more than max_megapixels. in_colour: such a
    picture keeps its colours. Raises ValueError with what is wrong and its cure, ModuleNotFoundError without pypdfium2.
    """
    with _opened(data) as document:
        index = checked_page(page, len(document)) - 1
        unit_mm = _MM_PER_PT * _user_unit(document, data, index)
        with closing(document[index]) as sheet:
            size_mm = checked_size(*(side * unit_mm for side in sheet.get_size()))
            reading = Reading(_raw(), sheet, _to_mm(sheet, unit_mm))
            found = None if _has_notes(sheet) else reading.vectors(size_mm)
            if found is None or not _looks_like(sheet, unit_mm, found):
                return _rendered(sheet, unit_mm, max_megapixels, in_colour=in_colour)
            return found


def pages_of_pdf(data: bytes) -> int:
    """How many pages it has. Raises as `read_pdf` does."""
    with _opened(data) as document:
        return len(document)


@contextmanager
def _opened(data: bytes) -> Iterator[Any]:
    import pypdfium2  # noqa: PLC0415 - an extra

    try:
        document = pypdfium2.PdfDocument(data)
    except pypdfium2.PdfiumError as error:
        if "password" in str(error).lower():
            raise ValueError("is encrypted: save it anew without a password") from error
        raise ValueError(f"is damaged ({error}): save it anew") from error
    try:
        yield document
    except pypdfium2.PdfiumError as error:
        raise ValueError(f"is damaged ({error}): save it anew") from error
    finally:
        document.close()


def _raw() -> Any:
    import pypdfium2.raw  # noqa: PLC0415 - an extra

    return pypdfium2.raw


def _user_unit(document: Any, data: bytes, index: int) -> float:
    """How many points a unit of this page is (PDF 1.6); PDFium takes it for 1, and tells it only to files."""
    if b"/UserUnit" not in (_saved(document) if b"/ObjStm" in data else data):
        return 1.0
    alone = type(document).new()
    try:
        alone.import_pages(document, [index])
        found = _UNIT.search(_saved(alone))
        return float(found[1]) if found else 1.0
    finally:
        alone.close()


def _saved(document: Any) -> bytes:
    """The file anew, with nothing but streams squeezed."""
    file = io.BytesIO()
    document.save(file)
    return file.getvalue()


def _has_notes(sheet: Any) -> bool:
    """Links are no more to be seen than to be drawn."""
    c = _raw()
    links = [getattr(c, f"FPDF_ANNOT_{name}") for name in _LINKS]
    for index in range(c.FPDFPage_GetAnnotCount(sheet)):
        note = c.FPDFPage_GetAnnot(sheet, index)
        kind = c.FPDFAnnot_GetSubtype(note)
        c.FPDFPage_CloseAnnot(note)
        if kind not in links:
            return True
    return False


def _looks_like(sheet: Any, unit_mm: float, found: Vectors) -> bool:
    """Whether ink begins or ends along the lines: a mask, a layer that is off or a white shape may hide them."""
    px_per_pt = min(_LOOK_DPI / 25.4 * unit_mm, _px_per_pt(sheet, _LOOK_MEGAPIXELS))
    grey = _painted(sheet, px_per_pt, grayscale=True)
    return share_seen(grey, [line * px_per_pt / unit_mm for line in found.lines]) >= _LEAST_SEEN


def _rendered(sheet: Any, unit_mm: float, max_megapixels: float, *, in_colour: bool) -> Rendered:
    px_per_pt = min(_DPI / 25.4 * unit_mm, _px_per_pt(sheet, min(max_megapixels, _MOST_MEGAPIXELS)))
    colour = _painted(sheet, px_per_pt, grayscale=False) if in_colour else None
    grey = _painted(sheet, px_per_pt, grayscale=True)
    px_per_mm = px_per_pt / unit_mm
    words = f"the page holds more than plain lines: it was read as a picture of {px_per_mm * 25.4:.0f} dpi"
    return Rendered(grey, px_per_mm, (words,), colour)


def _px_per_pt(sheet: Any, most_megapixels: float) -> float:
    """The scale at which the page has as many pixels as that, nearly."""
    width_pt, height_pt = sheet.get_size()
    return math.sqrt(0.98e6 * most_megapixels / (width_pt * height_pt))


def _painted(sheet: Any, px_per_pt: float, *, grayscale: bool) -> NDArray[np.uint8]:
    """(H, W), or (H, W, 3) as blue green red."""
    picture = sheet.render(scale=px_per_pt, grayscale=grayscale, may_draw_forms=False)
    try:
        return np.array(picture.to_numpy(), np.uint8)
    finally:
        picture.close()


def _to_mm(sheet: Any, unit_mm: float) -> Matrix:
    """From units of the page, y upwards, to mm of the page as it is shown: cropped, turned, y downwards."""
    left, bottom, right, top = sheet.get_bbox()
    width, height = right - left, top - bottom
    turned = {
        0: [[1, 0, -left], [0, -1, top]],
        90: [[0, 1, -bottom], [1, 0, -left]],
        180: [[-1, 0, right], [0, 1, -bottom]],
        270: [[0, -1, top], [-1, 0, right]],
    }[sheet.get_rotation()]
    across, down = sheet.get_size()
    if not math.isclose(across, height if sheet.get_rotation() % 180 else width, rel_tol=1e-3) or down <= 0:
        raise ValueError("says two different sizes of its page: save it anew")
    return np.array([*turned, [0, 0, 1 / unit_mm]], float) * unit_mm
