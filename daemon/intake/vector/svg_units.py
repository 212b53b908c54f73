"""Lengths, transforms and views of an SVG file (SVG 1.1, chapter 7): from its numbers to mm."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from daemon.intake.vector.svg_tree import Element

Matrix: TypeAlias = NDArray[np.float64]
"""(3, 3) float64, affine."""
IDENTITY: Matrix = np.eye(3)
MM_PER_PX = 25.4 / 96
UNSIZED_MM = 200.0
"""The longer side of a page whose file does not say how large it is."""
_PX = {"": 1.0, "px": 1.0, "mm": 96 / 25.4, "cm": 96 / 2.54, "q": 96 / 101.6, "in": 96.0, "pt": 96 / 72, "pc": 16.0}
_PX |= {"em": 16.0, "rem": 16.0, "ex": 8.0}
_LENGTH = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)\s*([a-z]*|%)\s*", re.IGNORECASE)
_TRANSFORM = re.compile(r"(\w+)\s*\(([^)]*)\)")
_DOWN = ("y", "y1", "y2", "cy", "height", "ry")


def length(text: str, whole: float) -> float:
    """In px, 0 where nothing is said. whole: what 100 % are of. Raises ValueError."""
    if not text.strip() or text.strip() == "auto":
        return 0.0
    found = _LENGTH.fullmatch(text)
    unit = found[2].lower() if found else ""
    if found is None or (unit != "%" and unit not in _PX):
        raise ValueError(f"holds the length {text[:40]!r}, which is none: correct it")
    return float(found[1]) * (whole / 100 if unit == "%" else _PX[unit])


def lengths(texts: Mapping[str, str], view: tuple[float, float]) -> dict[str, float]:
    """By name, in px; shares are of the view: of its width, its height, or for a radius of both."""
    both = math.hypot(*view) / math.sqrt(2)
    return {
        name: length(text, both if name == "r" else view[1] if name in _DOWN else view[0])
        for name, text in texts.items()
    }


def transform(text: str) -> Matrix:
    """The matrix of the attribute `transform`; what is no transform there changes nothing."""
    matrix = IDENTITY
    for name, numbers in _TRANSFORM.findall(text):
        values = [float(number) for number in re.findall(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?", numbers)]
        maker = _MAKERS.get(name)
        if maker and values:
            matrix = matrix @ maker(values)
    return matrix


def _matrix(v: list[float]) -> Matrix:
    a, b, c, d, e, f = (v + [0.0] * 6)[:6]
    return np.array([[a, c, e], [b, d, f], [0, 0, 1]], float)


def _rotate(v: list[float]) -> Matrix:
    cosine, sine = math.cos(math.radians(v[0])), math.sin(math.radians(v[0]))
    x, y = v[1:3] if len(v) >= 3 else (0.0, 0.0)
    turn = _matrix([cosine, sine, -sine, cosine, 0, 0])
    return _matrix([1, 0, 0, 1, x, y]) @ turn @ _matrix([1, 0, 0, 1, -x, -y])


_MAKERS: dict[str, Callable[[list[float]], Matrix]] = {
    "matrix": _matrix,
    "translate": lambda v: _matrix([1, 0, 0, 1, v[0], v[1] if len(v) > 1 else 0]),
    "scale": lambda v: _matrix([v[0], 0, 0, v[1] if len(v) > 1 else v[0], 0, 0]),
    "rotate": _rotate,
    "skewX": lambda v: _matrix([1, 0, math.tan(math.radians(v[0])), 1, 0, 0]),
    "skewY": lambda v: _matrix([1, math.tan(math.radians(v[0])), 0, 1, 0, 0]),
}


@dataclass(frozen=True, slots=True, eq=False)
class Room:
    """A view: its width and height in its own units, and where it lies in the units around it."""

    width: float
    height: float
    to_outer: Matrix

    @classmethod
    def within(cls, attributes: Mapping[str, str], around: tuple[float, float]) -> Room:
        """Of an svg or a symbol within a view of this size, in its units."""
        sides = (_stated(attributes, name, whole) for name, whole in zip(("width", "height"), around, strict=True))
        width, height = (whole if side is None else side for side, whole in zip(sides, around, strict=True))
        at = (length(attributes.get(name, ""), whole) for name, whole in zip("xy", around, strict=True))
        x, y = at
        view, fitted = _view(attributes, width, height)
        return cls(*view, _matrix([1, 0, 0, 1, x, y]) @ fitted)


@dataclass(frozen=True, slots=True, eq=False)
class Page:
    """The outermost view, and the page: sized says whether the file gives its size."""

    width: float
    height: float
    to_mm: Matrix
    width_mm: float
    height_mm: float
    sized: bool


def room_of(root: Element) -> Page:
    """The page that an SVG file describes; where it says no size, its longer side is UNSIZED_MM. Raises ValueError."""
    attributes = root.attributes
    box = _box(attributes)
    stated = [_stated(attributes, name, None) for name in ("width", "height")]
    if box is None and None in stated:
        raise ValueError("says neither its width and height nor a viewBox: save it anew with its size")
    width, height = _sides(stated, box)
    sized = stated != [None, None]
    scale = MM_PER_PX if sized else UNSIZED_MM / max(width, height)
    view, fitted = _view(attributes, width, height)
    return Page(*view, _matrix([scale, 0, 0, scale, 0, 0]) @ fitted, width * scale, height * scale, sized)


def _sides(stated: list[float | None], box: tuple[float, float, float, float] | None) -> tuple[float, float]:
    """In px; a side that is not stated follows the proportions of the viewBox."""
    width, height = stated
    if box is not None:
        ratio = box[2] / box[3]
        width = width if width is not None else height * ratio if height is not None else box[2]
        height = height if height is not None else width / ratio
    assert width is not None
    assert height is not None
    if min(width, height) <= 0:
        raise ValueError(f"is {width:g} x {height:g} px large: give it a size")
    return width, height


def _stated(attributes: Mapping[str, str], name: str, whole: float | None) -> float | None:
    text = attributes.get(name, "").strip()
    if not text or text == "auto" or (whole is None and text.endswith("%")):
        return None
    return length(text, whole or 0.0)


def _box(attributes: Mapping[str, str]) -> tuple[float, float, float, float] | None:
    try:
        numbers = [float(part) for part in re.split(r"[\s,]+", attributes.get("viewBox", "").strip()) if part]
    except ValueError:
        return None
    if len(numbers) != 4 or not all(map(math.isfinite, numbers)) or min(numbers[2:]) <= 0:
        return None
    return numbers[0], numbers[1], numbers[2], numbers[3]


def _view(attributes: Mapping[str, str], width: float, height: float) -> tuple[tuple[float, float], Matrix]:
    """The size of the view in its own units, and from these to px of its corner (preserveAspectRatio)."""
    box = _box(attributes)
    if box is None:
        return (width, height), IDENTITY
    x, y, wide, high = box
    words = attributes.get("preserveAspectRatio", "xMidYMid").split() or ["xMidYMid"]
    across, down = width / wide, height / high
    if words[0] != "none":
        across = down = max(across, down) if "slice" in words else min(across, down)
    left = _share(words[0], "xMid", "xMax") * (width - wide * across)
    top = _share(words[0], "YMid", "YMax") * (height - high * down)
    return (wide, high), _matrix([across, 0, 0, down, left - x * across, top - y * down])


def _share(words: str, middle: str, end: str) -> float:
    return 0.5 if middle in words else 1.0 if end in words else 0.0
