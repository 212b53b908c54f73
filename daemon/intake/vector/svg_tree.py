"""The elements of an SVG file, read without entities, scripts, or anything that lies outside the file."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NoReturn
from xml.parsers import expat

MOST_ELEMENTS = 100_000
_MOST_DEEP = 100
_KEPT_TEXT = ("style",)
_SVG = "http://www.w3.org/2000/svg"
_XLINK = "http://www.w3.org/1999/xlink"
_OUTSIDE = re.compile(r"@import|url\(\s*['\"]?\s*(?!#|data:)", re.IGNORECASE)


@dataclass(slots=True)
class Element:
    """tag and attributes without their name spaces (SVG's own and xlink's only; others are left out)."""

    tag: str
    attributes: dict[str, str]
    children: list[Element] = field(default_factory=list)
    text: str = ""

    def all(self) -> Iterator[Element]:
        """It and everything in it, in the order of the file."""
        waiting = [self]
        while waiting:
            element = waiting.pop()
            yield element
            waiting += reversed(element.children)


def read_tree(data: bytes) -> Element:
    """The root of an SVG file. Raises ValueError with what is wrong, and its cure.

    Refused: a document type that declares entities, a script, what an outside file would be needed for, more than
    MOST_ELEMENTS elements, a hundred of them in each other, XML that is damaged.
    """
    reader = _Reader()
    parser = expat.ParserCreate(namespace_separator=" ")
    parser.StartElementHandler = reader.start
    parser.EndElementHandler = reader.end
    parser.CharacterDataHandler = reader.characters
    parser.EntityDeclHandler = _refuse_entity
    parser.ExternalEntityRefHandler = _refuse_entity
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        raise ValueError(f"is no whole SVG file ({error}): save it anew") from error
    if reader.root is None or reader.root.tag != "svg":
        raise ValueError("holds no <svg>: save it anew as SVG")
    return reader.root


def _refuse_entity(*_: object) -> NoReturn:
    raise ValueError("declares XML entities, which are not read: save it anew as plain SVG")


class _Reader:
    def __init__(self) -> None:
        self.root: Element | None = None
        self._open: list[Element] = []
        self._count = 0

    def start(self, name: str, attributes: dict[str, str]) -> None:
        space, _, tag = name.rpartition(" ")
        self._count += 1
        if self._count > MOST_ELEMENTS or len(self._open) >= _MOST_DEEP:
            raise ValueError(
                f"holds more than {MOST_ELEMENTS} elements, or {_MOST_DEEP} of them in each other: simplify it"
            )
        if tag == "script" and space in ("", _SVG):
            raise ValueError("holds a script, which is never run: save it anew without")
        element = Element(tag if space in ("", _SVG) else f"{{{space}}}{tag}", _plain(attributes))
        if self._open:
            self._open[-1].children.append(element)
        else:
            self.root = element
        self._open.append(element)

    def end(self, _: str) -> None:
        element = self._open.pop()
        if element.tag == "style":
            _check_inside(element.text)

    def characters(self, text: str) -> None:
        if self._open[-1].tag in _KEPT_TEXT:
            self._open[-1].text += text


def _plain(attributes: dict[str, str]) -> dict[str, str]:
    plain = {}
    for name, value in attributes.items():
        space, _, local = name.rpartition(" ")
        if space in ("", _XLINK):
            plain[local] = value
        if space == "" and local.lower().startswith("on"):
            raise ValueError(f"holds a script ({local}), which is never run: save it anew without")
        if local != "d":
            _check_inside(value)
    return plain


def _check_inside(text: str) -> None:
    if _OUTSIDE.search(text):
        raise ValueError("refers to another file, which is never opened: put everything into this one")
