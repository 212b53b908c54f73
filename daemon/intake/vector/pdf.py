"""A page of a PDF becomes lines where it holds nothing else, and a picture where it does. The only door to PDFium."""

from __future__ import annotations

import io
import math
import re
from collections.abc import Iterator
from contextlib import closing, contextmanager
from typing import Any

import numpy as np

from daemon.intake.pages import checked_page
from daemon.intake.vector.common import Rendered, Vectors, checked_size
from daemon.intake.vector.pdf_paths import Reading
from daemon.intake.vector.svg_units import Matrix

MOST_BYTES = 200_000_000
HEAD = re.compile(rb".{0,1019}%PDF-", re.DOTALL)
_MM_PER_PT = 25.4 / 72
_DPI = 300.0
_MOST_MEGAPIXELS = 35.0
"""A page of A2 at 300 dpi: the lines of a larger one are seen with fewer."""
_LINKS = ("LINK", "POPUP")
_UNIT = re.compile(rb"/Type\s*/Page\s*/UserUnit\s+([0-9.]+)")
_HIDDEN_LAYERS = re.compile(rb"/OFF\s*\[\s*\d|/BaseState\s*/OFF")


def read_pdf(data: bytes, *, page: int, max_megapixels: float) -> Vectors | Rendered:
    """One page of a PDF, from 1 on, as large as it says, turned and cropped as it is shown.

    Lines where it holds paths alone: outlines of what is filled, cut off at the box round its clip, without what is
    white. With text, pictures, shadings or notes on it, or where the file hides layers, all of it is a picture of
    300 dpi, fewer where the page is larger than A2, or that were more than max_megapixels. Raises ValueError with what
    is wrong and its cure, ModuleNotFoundError without pypdfium2.
    """
    with _opened(data) as document:
        index = checked_page(page, len(document)) - 1
        plain = _plain(document, data)
        unit_mm = _MM_PER_PT * (_user_unit(document, index) if b"/UserUnit" in plain else 1.0)
        with closing(document[index]) as sheet:
            size_mm = checked_size(*(side * unit_mm for side in sheet.get_size()))
            if not _HIDDEN_LAYERS.search(plain) and not _has_notes(sheet):
                found = Reading(_raw(), sheet, _to_mm(sheet, unit_mm)).vectors(size_mm)
                if found is not None:
                    return found
            return _rendered(sheet, unit_mm, max_megapixels)


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


def _plain(document: Any, data: bytes) -> bytes:
    """The file with what it says of its pages and layers in the open, of which PDFium tells nothing."""
    return _saved(document) if b"/ObjStm" in data else data


def _saved(document: Any) -> bytes:
    file = io.BytesIO()
    document.save(file)
    return file.getvalue()


def _user_unit(document: Any, index: int) -> float:
    """How many points a unit of this page is (PDF 1.6); PDFium takes it for 1."""
    alone = type(document).new()
    try:
        alone.import_pages(document, [index])
        found = _UNIT.search(_saved(alone))
        return float(found[1]) if found else 1.0
    finally:
        alone.close()


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


def _rendered(sheet: Any, unit_mm: float, max_megapixels: float) -> Rendered:
    width_pt, height_pt = sheet.get_size()
    most_px_per_pt = math.sqrt(0.98e6 * min(max_megapixels, _MOST_MEGAPIXELS) / (width_pt * height_pt))
    px_per_pt = min(_DPI / 25.4 * unit_mm, most_px_per_pt)
    picture = sheet.render(scale=px_per_pt, grayscale=True, may_draw_forms=False)
    grey = np.array(picture.to_numpy(), np.uint8).reshape(picture.height, picture.width)
    picture.close()
    px_per_mm = px_per_pt / unit_mm
    words = f"the page holds more than lines: it was read as a picture of {px_per_mm * 25.4:.0f} dpi"
    return Rendered(grey, px_per_mm, (words,))


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
