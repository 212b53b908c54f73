"""What of an SVG file is seen: presentation attributes, `style`, and the plain rules of its style sheets."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Literal

from daemon.colours import BLACK, Rgb, rgb_of
from daemon.intake.vector.svg_tree import Element

_RULE = re.compile(r"([^{}]+)\{([^{}]*)\}")
_COMMENT = re.compile(r"/\*.*?\*/|<!--|-->", re.DOTALL)
_SELECTOR = re.compile(r"([\w-]+|\*)?(?:\.([\w-]+))?(?:#([\w-]+))?")
_INHERITED = ("stroke", "fill", "visibility", "stroke-opacity", "fill-opacity", "stroke-dasharray", "color")
_OWN = ("display", "opacity", "clip-path", "mask", "marker-start", "marker-mid", "marker-end")
_SEEN_FROM = 0.02
"""Opacity."""
_WHITE_FROM = 250
_NEARLY_WHITE = ("ivory", "floralwhite", "ghostwhite", "mintcream", "azure")


@dataclass(frozen=True, slots=True)
class Rule:
    tag: str
    class_name: str
    id: str
    declared: dict[str, str]

    def holds_for(self, element: Element) -> bool:
        attributes = element.attributes
        return (
            self.tag in ("", "*", element.tag)
            and (not self.class_name or self.class_name in attributes.get("class", "").split())
            and (not self.id or self.id == attributes.get("id"))
        )


@dataclass(slots=True)
class Sheets:
    """The rules of all style sheets, the weakest first, and whether some are of a kind that is not read."""

    rules: list[Rule] = field(default_factory=list)
    unread: bool = False

    def style_of(self, element: Element, inherited: dict[str, str]) -> dict[str, str]:
        """The properties that hold for this element: its own over those of the sheets over those of its parent."""
        attributes = element.attributes
        found = {name: value for name, value in inherited.items() if name in _INHERITED}
        own = {name: attributes[name].strip() for name in (*_INHERITED, *_OWN) if name in attributes}
        for rule in self.rules:
            if rule.holds_for(element):
                own |= rule.declared
        own |= _declared(attributes.get("style", ""))
        return found | {name: value for name, value in own.items() if value != "inherit"}


def sheets_of(texts: Iterable[str]) -> Sheets:
    """The rules of the `<style>` elements: by tag, class and id, alone or together; others are left out."""
    sheets = Sheets()
    for text in texts:
        plain = _COMMENT.sub("", text)
        for selectors, body in _RULE.findall(plain):
            for selector in selectors.split(","):
                found = _SELECTOR.fullmatch(selector.strip())
                if found and any(found.groups()):
                    sheets.rules.append(Rule(found[1] or "", found[2] or "", found[3] or "", _declared(body)))
                elif not selector.strip().startswith("@"):
                    sheets.unread = True
    sheets.rules.sort(key=lambda rule: (bool(rule.id), bool(rule.class_name), bool(rule.tag)))
    return sheets


def _declared(text: str) -> dict[str, str]:
    pairs = (part.partition(":") for part in text.split(";") if ":" in part)
    return {name.strip(): value.replace("!important", "").strip() for name, _, value in pairs}


def shown(style: dict[str, str]) -> bool:
    """False for an element that is not there, with everything in it."""
    return style.get("display") != "none" and _opacity(style.get("opacity", "1")) >= _SEEN_FROM


def visible(style: dict[str, str]) -> bool:
    return style.get("visibility", "visible") == "visible"


def stroked(style: dict[str, str]) -> bool:
    """Its line has a colour that is seen on white paper."""
    return _inked(style.get("stroke", "none"), style.get("stroke-opacity", "1"), style)


def filled(style: dict[str, str]) -> bool:
    """Its area has a colour that is seen on white paper."""
    return _inked(style.get("fill", "black"), style.get("fill-opacity", "1"), style)


def painted(style: dict[str, str]) -> bool:
    """It has a line or an area, be it white."""
    return {style.get("stroke", "none"), style.get("fill", "black")} - {"none", "transparent"} != set()


def colour_of(style: dict[str, str], what: Literal["stroke", "fill"]) -> Rgb:
    """Of its line or its area; black where a pattern or a colour that is not read paints it."""
    return rgb_of(_paint(style.get(what, "black"), style)) or BLACK


def _paint(paint: str, style: dict[str, str]) -> str:
    return style.get("color", "black") if paint.lower() == "currentcolor" else paint


def _inked(paint: str, opacity: str, style: dict[str, str]) -> bool:
    paint = _paint(paint, style)
    return paint.lower() not in ("none", "transparent") and _opacity(opacity) >= _SEEN_FROM and not _white(paint)


def _opacity(text: str) -> float:
    try:
        return float(text.rstrip("%")) / (100 if text.endswith("%") else 1)
    except ValueError:
        return 1.0


def _white(paint: str) -> bool:
    colour = rgb_of(paint)
    return (colour is not None and min(colour) >= _WHITE_FROM) or paint.lower().strip() in _NEARLY_WHITE
