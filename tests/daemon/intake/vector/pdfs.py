"""PDF files made by hand, page by page."""

from __future__ import annotations

import re
import struct
import zlib
from collections.abc import Sequence

import numpy as np

FONT = "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>"


def pdf(
    contents: Sequence[str],
    *,
    page: str = "",
    resources: str = "",
    more: Sequence[str] = (),
    catalog: str = "",
    trailer: str = "",
) -> bytes:
    """A PDF with a page of 72 x 144 points for each content stream.

    page, resources, catalog, trailer: further entries of each page, its resources, the catalog and the trailer.
    more: further objects, numbered from 3 on.
    """
    first = 3 + len(more)
    kids = " ".join(f"{first + 2 * index} 0 R" for index in range(len(contents)))
    objects = [
        f"<< /Type /Catalog /Pages 2 0 R {catalog} >>",
        f"<< /Type /Pages /Kids [{kids}] /Count {len(contents)} >>",
        *more,
    ]
    for index, content in enumerate(contents):
        box = "" if "/MediaBox" in page else "/MediaBox [0 0 72 144]"
        objects.append(
            f"<< /Type /Page /Parent 2 0 R {box} {page} /Resources << {resources} >> "
            f"/Contents {first + 2 * index + 1} 0 R >>"
        )
        objects.append(stream(content))
    return _file(objects, trailer)


def stream(content: str, entries: str = "") -> str:
    return f"<< {entries} /Length {len(content)} >>\nstream\n{content}\nendstream"


def object_stream(data: bytes) -> bytes:
    """The same file with all its objects but streams squeezed into one (PDF 1.5, sections 7.5.7 and 7.5.8)."""
    objects = re.findall(rb"(\d+) 0 obj\n(.*?)\nendobj", data, re.DOTALL)
    plain = [(int(number), body) for number, body in objects if b"stream" not in body]
    whole = {int(number): body for number, body in objects if b"stream" in body}
    places = np.cumsum([0, *(len(body) + 1 for _, body in plain)])[:-1].tolist()
    index = b" ".join(b"%d %d" % (number, place) for (number, _), place in zip(plain, places, strict=True)) + b" "
    packed = zlib.compress(index + b" ".join(body for _, body in plain))
    first, second = len(objects) + 1, len(objects) + 2
    head = b"<< /Type /ObjStm /N %d /First %d /Filter /FlateDecode /Length %d >>\nstream\n"
    whole[first] = head % (len(plain), len(index), len(packed)) + packed + b"\nendstream"
    rows = {0: (0, 0, 65535)} | {number: (2, first, at) for at, (number, _) in enumerate(plain)}
    file = b"%PDF-1.7\n"
    for number, body in whole.items():
        rows[number] = (1, len(file), 0)
        file += b"%d 0 obj\n%s\nendobj\n" % (number, body)
    rows[second] = (1, len(file), 0)
    table = b"".join(struct.pack(">BIH", *rows[number]) for number in sorted(rows))
    about = b"<< /Type /XRef /W [1 4 2] /Size %d /Root 1 0 R /Length %d >>" % (second + 1, len(table))
    end = b"%d 0 obj\n%s\nstream\n%s\nendstream\nendobj\nstartxref\n%d\n%%%%EOF\n"
    return file + end % (second, about, table, len(file))


def _file(objects: Sequence[str], trailer: str) -> bytes:
    body, places = "%PDF-1.7\n", []
    for number, each in enumerate(objects, start=1):
        places.append(len(body))
        body += f"{number} 0 obj\n{each}\nendobj\n"
    table = "".join(f"{place:010d} 00000 n \n" for place in places)
    size = len(objects) + 1
    ends = f"trailer\n<< /Size {size} /Root 1 0 R {trailer} >>\nstartxref\n{len(body)}\n%%EOF\n"
    return (f"{body}xref\n0 {size}\n0000000000 65535 f \n{table}{ends}").encode("latin-1")


ENCRYPTED = pdf(
    ["0 0 m 9 9 l S"],
    trailer=f"/Encrypt << /Filter /Standard /V 1 /R 2 /P -4 /O <{'ab' * 32}> /U <{'cd' * 32}> >> /ID [<00> <00>]",
)
