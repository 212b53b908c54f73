"""A DXF file becomes lines: what its model space shows, in mm by its own units. The only door to ezdxf."""

from __future__ import annotations

import io
import re
import struct
from collections import Counter
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from daemon.colours import BLACK, Rgb
from daemon.intake.vector.common import FLAT_MM, Collected, Vectors, checked_size, left_out
from daemon.shapes import Points

MOST_BYTES = 32_000_000
_BINARY = b"AutoCAD Binary DXF\r\n\x1a\x00"
HEAD = re.compile(re.escape(_BINARY) + rb"|\s*(?:999[ \t]*\r?\n[^\n]*\n\s*)*0[ \t]*\r?\n\s*SECTION\s")
_END = re.compile(rb"\n\s*0\s*\n\s*EOF\s*$")
MOST_ENTITIES = 100_000
_MARGIN_MM = 1.0
"""A DXF file has no page: so much is left round its lines."""
_WHITE = 7
"""Of AutoCAD's colours; black on a light ground."""
_MM = 4
"""Of $INSUNITS."""
_FRAMES = ("IMAGE", "WIPEOUT", "VIEWPORT")
"""Of these ezdxf gives the frame."""
_TEXTS = ("TEXT", "MTEXT", "ATTRIB", "ATTDEF", "ARCALIGNEDTEXT")


def read_dxf(data: bytes) -> Vectors:
    """The lines of a DXF file, text or binary. Raises ValueError with its cure, ModuleNotFoundError without ezdxf.

    Lines, arcs, circles, ellipses, splines, polylines, points, outlines of hatches and solids, and all of these within
    blocks; seen from above. What lies on a layer that is off or frozen is left out; so are text and what has no lines,
    with a warning. Without a unit mm are taken, with a warning.
    """
    from ezdxf import DXFError  # noqa: PLC0415 - an extra

    broken = (DXFError, RecursionError, ArithmeticError, LookupError, TypeError, AttributeError, struct.error)
    # What is read nevertheless of a file that is cut short would be drawn as if it were all of it.
    if not data.startswith(_BINARY) and not _END.search(data[-64:]):
        raise ValueError("is damaged (its end is missing): copy it again")
    try:
        document = _document(data)
    except (*broken, ValueError) as error:
        raise ValueError(f"is damaged ({type(error).__name__}: {error}): save it anew") from error
    try:
        return _page_of(document)
    except broken as error:
        raise ValueError(f"is damaged ({type(error).__name__}: {error}): save it anew") from error


def _document(data: bytes) -> Any:
    from ezdxf import recover  # noqa: PLC0415 - an extra
    from ezdxf.document import Drawing  # noqa: PLC0415 - an extra
    from ezdxf.lldxf.tagger import binary_tags_loader  # noqa: PLC0415 - an extra

    if data.startswith(_BINARY):
        return Drawing.load(binary_tags_loader(data, errors="ignore"))
    return recover.read(io.BytesIO(data))[0]


def _page_of(document: Any) -> Vectors:
    mm, warnings = _unit_mm(document)
    missing: Counter[str] = Counter()
    collected = Collected()
    for entity in _Shown(document, missing).of(document.modelspace()):
        for points in _lines(entity, FLAT_MM / mm, missing):
            collected.add(points[:, :2] * mm, _colour(entity, document))
    texts = left_out(sum(missing.pop(kind, 0) for kind in _TEXTS), "text", "texts")
    warnings += [f"{words}: turn what shall be drawn into lines" for words in texts]
    for kind, count in sorted(missing.items()):
        warnings += left_out(count, *[f"of the kind {kind}"] * 2)
    return _laid_out(collected.lines, collected.colours, warnings)


def _colour(entity: Any, document: Any) -> Rgb:
    """Its own or that of its layer; what is drawn white on a dark screen is black on paper."""
    from ezdxf.colors import BYBLOCK, BYLAYER, aci2rgb  # noqa: PLC0415 - an extra

    index, rgb = entity.dxf.get("color", BYLAYER), entity.rgb
    if rgb is None and index == BYLAYER:
        name = entity.dxf.get("layer", "0")
        layer = document.layers.get(name) if document.layers.has_entry(name) else None
        index, rgb = (layer.color, layer.rgb) if layer else (_WHITE, None)
    if rgb is None and abs(index) in (BYBLOCK, _WHITE):
        return BLACK
    red, green, blue = rgb or aci2rgb(abs(index))
    return red, green, blue


def _laid_out(lines: list[Points], colours: list[Rgb], warnings: list[str]) -> Vectors:
    """On a page as large as the lines, y downwards."""
    corners = [np.stack([line.min(axis=0), line.max(axis=0)]) for line in lines] or [np.zeros((2, 2))]
    low, high = np.min(corners, axis=(0, 1)) - _MARGIN_MM, np.max(corners, axis=(0, 1)) + _MARGIN_MM
    width_mm, height_mm = checked_size(*(high - low).tolist())
    placed = tuple((line - (low[0], high[1])) * (1, -1) for line in lines)
    return Vectors(placed, width_mm, height_mm, True, tuple(warnings), tuple(colours))


def _unit_mm(document: Any) -> tuple[float, list[str]]:
    from ezdxf.units import conversion_factor  # noqa: PLC0415 - an extra

    if document.units == 0:
        return 1.0, ["the file says no unit: mm are taken"]
    return float(conversion_factor(document.units, _MM)), []


class _Shown:
    """What is shown of a document, blocks taken apart; at most MOST_ENTITIES, blocks counted."""

    def __init__(self, document: Any, missing: Counter[str]) -> None:
        self._missing, self._count = missing, 0
        self._hidden = {layer.dxf.name.lower() for layer in document.layers if layer.is_off() or layer.is_frozen()}
        self._hidden |= {"defpoints"}

    def of(self, entities: Iterable[Any]) -> Iterator[Any]:
        from ezdxf.protocols import SupportsVirtualEntities, virtual_entities  # noqa: PLC0415 - an extra

        for entity in entities:
            self._count += 1
            if self._count > MOST_ENTITIES:
                raise ValueError(f"holds more than {MOST_ENTITIES} lines, each block counted: simplify it")
            if entity.dxf.get("invisible", 0) or entity.dxf.get("layer", "0").lower() in self._hidden:
                continue
            if entity.dxftype() == "INSERT":
                yield from self._inserted(entity)
            elif isinstance(entity, SupportsVirtualEntities):
                yield from self.of(virtual_entities(entity))
            else:
                yield entity

    def _inserted(self, insert: Any) -> Iterator[Any]:
        block = insert.block()
        if block is None or block.block.is_xref or block.block.is_xref_overlay:
            self._missing["reference to another file"] += 1
        elif insert.mcount > 1:
            yield from self.of(insert.multi_insert())
        else:
            yield from insert.attribs
            yield from self.of(insert.virtual_entities())


def _lines(entity: Any, within: float, missing: Counter[str]) -> list[Points]:
    """Each (N, 3) in the file's units."""
    from ezdxf.path import make_path  # noqa: PLC0415 - an extra

    if entity.dxftype() == "POINT":
        return [np.array([entity.dxf.location], float)]
    try:
        path = None if entity.dxftype() in _FRAMES else make_path(entity)
    except (TypeError, ValueError):
        path = None
    if path is None:
        missing[entity.dxftype()] += 1
        return []
    parts = path.sub_paths() if path.has_sub_paths else [path]
    found = [np.array([tuple(point) for point in part.flattening(within)], float) for part in parts]
    return [points for points in found if len(points)]
