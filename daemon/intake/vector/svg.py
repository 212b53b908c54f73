"""An SVG file becomes lines: outlines of what is seen of it, in mm of its page."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import numpy as np

from daemon.intake.vector.common import FLAT_MM, Collected, Vectors, checked_size, chords_of_bezier, left_out
from daemon.intake.vector.dashes import dashed
from daemon.intake.vector.svg_path import Run, runs_of_path, runs_of_shape
from daemon.intake.vector.svg_style import Sheets, colour_of, filled, painted, sheets_of, shown, stroked, visible
from daemon.intake.vector.svg_tree import MOST_ELEMENTS, Element, read_tree
from daemon.intake.vector.svg_units import Matrix, Room, length, lengths, room_of, transform
from daemon.shapes import Points

MOST_BYTES = 16_000_000
_SHAPES = {
    "line": ("x1", "y1", "x2", "y2"),
    "rect": ("x", "y", "width", "height", "rx", "ry"),
    "circle": ("cx", "cy", "r"),
    "ellipse": ("cx", "cy", "rx", "ry"),
    "polyline": (),
    "polygon": (),
}
_REFUSED = {
    "text": "holds text, which is not drawn: turn it into paths (in Inkscape: Path, Object to Path)",
    "image": "holds a picture, which is not drawn with it: drop the picture itself, or take it out",
    "foreignObject": "holds a page of HTML, which is not drawn: turn it into paths, or take it out",
}
_GROUPS = ("g", "a", "switch", "svg", "symbol")
_NOT_FOLLOWED = ("clip-path", "mask", "marker-start", "marker-mid", "marker-end")
_MOST_NESTED = 32


def read_svg(data: bytes) -> Vectors:
    """The lines of an SVG file. Raises ValueError with what is wrong or not drawn, and its cure.

    What is filled alone is drawn by its outline; what is white or not painted is left out. Text, pictures, scripts,
    entities and what refers to other files are refused. Clipped to the page. Without width and height in units its
    size is not known: the longer side is then taken for 200 mm.
    """
    root = read_tree(data)
    room = room_of(root)
    checked_size(room.width_mm, room.height_mm)
    sheets = sheets_of(element.text for element in root.all() if element.tag == "style")
    walk = _Walk(sheets, {element.attributes["id"]: element for element in root.all() if "id" in element.attributes})
    # Numbers may be too large to be reckoned with: what comes of them is looked at when it is collected.
    with np.errstate(all="ignore"):
        walk.children(root, _State(room.to_mm, sheets.style_of(root, {}), (room.width, room.height)))
    found = walk.collected
    found.clip((room.width_mm, room.height_mm))
    warnings = tuple(walk.warnings())
    return Vectors(tuple(found.lines), room.width_mm, room.height_mm, room.sized, warnings, tuple(found.colours))


@dataclass(frozen=True, slots=True)
class _State:
    """Where an element lies, how it looks, the size that its shares are of, and how many `use` it is within."""

    to_mm: Matrix
    style: dict[str, str]
    view: tuple[float, float]
    nested: int = 0


class _Walk:
    def __init__(self, sheets: Sheets, by_id: dict[str, Element]) -> None:
        self._sheets, self._by_id = sheets, by_id
        self.collected = Collected()
        self._visited = self._white = 0
        self._ignored: set[str] = set()

    def warnings(self) -> list[str]:
        found = left_out(self._white, "white shape", "white shapes")
        found += [f"{name} is not followed: what it hides or adds is not" for name in sorted(self._ignored)]
        return found + (["rules of its style sheet are not read"] if self._sheets.unread else [])

    def children(self, element: Element, state: _State) -> None:
        for child in element.children:
            self._element(child, state)

    def _element(self, element: Element, outer: _State) -> None:
        self._visited += 1
        if self._visited > MOST_ELEMENTS:
            raise ValueError(f"shows more than {MOST_ELEMENTS} elements, each use counted: simplify it")
        tag, attributes = element.tag, element.attributes
        style = self._sheets.style_of(element, outer.style)
        if not shown(style) or not (tag in _GROUPS or tag in _SHAPES or tag in _REFUSED or tag in ("use", "path")):
            return
        if tag in _REFUSED:
            if visible(style):
                raise ValueError(_REFUSED[tag])
            return
        self._ignored |= {name for name in _NOT_FOLLOWED if style.get(name, "none") != "none"}
        to_mm = outer.to_mm @ transform(attributes.get("transform", ""))
        state = _State(to_mm, style, outer.view, outer.nested)
        if tag == "use":
            self._use(element, state)
        elif tag == "svg":
            self.children(element, _inside(element, state, attributes))
        elif tag in _GROUPS:
            if tag != "symbol":
                self.children(element, state)
        elif visible(style):
            self._shape(element, state)

    def _use(self, element: Element, state: _State) -> None:
        target = element.attributes.get("href", "")
        if target and not target.startswith("#"):
            raise ValueError(f"refers to another file ({target[:60]}), which is never opened: put it into this one")
        used = self._by_id.get(target[1:])
        if used is None:
            return
        if state.nested >= _MOST_NESTED:
            raise ValueError(f"holds more than {_MOST_NESTED} uses within each other: simplify it")
        x, y = (length(element.attributes.get(name, ""), whole) for name, whole in zip("xy", state.view, strict=True))
        moved = np.array([[1, 0, x], [0, 1, y], [0, 0, 1]], float)
        inner = _State(state.to_mm @ moved, state.style, state.view, state.nested + 1)
        if used.tag in ("symbol", "svg"):
            style = self._sheets.style_of(used, inner.style)
            sized = {name: element.attributes[name] for name in ("width", "height") if name in element.attributes}
            here = _State(inner.to_mm, style, inner.view, inner.nested)
            if shown(style):
                self.children(used, _inside(used, here, used.attributes | sized | {"x": "0", "y": "0"}))
        else:
            self._element(used, inner)

    def _shape(self, element: Element, state: _State) -> None:
        line, area = stroked(state.style), filled(state.style) and element.tag != "line"
        if not line and not area:
            self._white += painted(state.style)
            return
        runs = self._runs(element, state)
        scale = math.sqrt(abs(float(np.linalg.det(state.to_mm[:2, :2]))))
        dashes = [dash * scale for dash in _dashes(state.style.get("stroke-dasharray", "none"))]
        for run in runs:
            if area and not line:
                run.close()
            flat = _flat(run, state.to_mm)
            for part in dashed(flat, dashes) if line and not area else [flat]:
                self.collected.add(part, colour_of(state.style, "stroke" if line else "fill"))

    def _runs(self, element: Element, state: _State) -> list[Run]:
        attributes = element.attributes
        if element.tag == "path":
            return runs_of_path(attributes.get("d", ""))
        numbers = lengths({name: attributes.get(name, "") for name in _SHAPES[element.tag]}, state.view)
        return runs_of_shape(element.tag, numbers, attributes.get("points", ""))


def _inside(element: Element, state: _State, attributes: dict[str, str]) -> _State:
    """Within an svg or a symbol that has a view of its own."""
    room = Room.within(attributes, state.view)
    return _State(state.to_mm @ room.to_outer, state.style, (room.width, room.height), state.nested)


def _dashes(text: str) -> list[float]:
    """In units of the file; none where the line is whole."""
    try:
        found = [length(part, 0.0) for part in re.split(r"[\s,]+", text.strip()) if part and part != "none"]
    except ValueError:
        return []
    return [] if not found or min(found) < 0 or sum(found) <= 0 else found * (1 + len(found) % 2)


def _flat(run: Run, to_mm: Matrix) -> Points:
    """The subpath as points in mm; a single one where it only begins."""
    parts = [np.array([run.start], float)]
    placed = [piece @ to_mm[:2, :2].T + to_mm[:2, 2] for piece in run.pieces]
    parts[0] = parts[0] @ to_mm[:2, :2].T + to_mm[:2, 2]
    for piece in placed:
        parts.append(piece[1:] if len(piece) == 2 else chords_of_bezier(piece, within=FLAT_MM))
    points = np.concatenate(parts)
    moved = np.r_[True, (np.diff(points, axis=0) != 0).any(axis=1)]
    return np.asarray(points[moved])
