"""Colours by name and in numbers: what CSS calls them, and how far apart a person sees them."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias, TypeVar

Rgb: TypeAlias = tuple[int, int, int]
"""Red, green, blue, 0 to 255 (sRGB)."""
BLACK: Rgb = (0, 0, 0)
Lab: TypeAlias = tuple[float, float, float]
"""CIE L*a*b* under D65: lightness 0 to 100, green to red, blue to yellow."""

_NAMED = """
aliceblue f0f8ff antiquewhite faebd7 aqua 00ffff aquamarine 7fffd4 azure f0ffff beige f5f5dc bisque ffe4c4 black
000000 blanchedalmond ffebcd blue 0000ff blueviolet 8a2be2 brown a52a2a burlywood deb887 cadetblue 5f9ea0
chartreuse 7fff00 chocolate d2691e coral ff7f50 cornflowerblue 6495ed cornsilk fff8dc crimson dc143c cyan 00ffff
darkblue 00008b darkcyan 008b8b darkgoldenrod b8860b darkgray a9a9a9 darkgrey a9a9a9 darkgreen 006400 darkkhaki
bdb76b darkmagenta 8b008b darkolivegreen 556b2f darkorange ff8c00 darkorchid 9932cc darkred 8b0000 darksalmon
e9967a darkseagreen 8fbc8f darkslateblue 483d8b darkslategray 2f4f4f darkslategrey 2f4f4f darkturquoise 00ced1
darkviolet 9400d3 deeppink ff1493 deepskyblue 00bfff dimgray 696969 dimgrey 696969 dodgerblue 1e90ff firebrick
b22222 floralwhite fffaf0 forestgreen 228b22 fuchsia ff00ff gainsboro dcdcdc ghostwhite f8f8ff gold ffd700
goldenrod daa520 gray 808080 grey 808080 green 008000 greenyellow adff2f honeydew f0fff0 hotpink ff69b4
indianred cd5c5c indigo 4b0082 ivory fffff0 khaki f0e68c lavender e6e6fa lavenderblush fff0f5 lawngreen 7cfc00
lemonchiffon fffacd lightblue add8e6 lightcoral f08080 lightcyan e0ffff lightgoldenrodyellow fafad2 lightgreen
90ee90 lightgray d3d3d3 lightgrey d3d3d3 lightpink ffb6c1 lightsalmon ffa07a lightseagreen 20b2aa lightskyblue
87cefa lightslategray 778899 lightslategrey 778899 lightsteelblue b0c4de lightyellow ffffe0 lime 00ff00
limegreen 32cd32 linen faf0e6 magenta ff00ff maroon 800000 mediumaquamarine 66cdaa mediumblue 0000cd
mediumorchid ba55d3 mediumpurple 9370db mediumseagreen 3cb371 mediumslateblue 7b68ee mediumspringgreen 00fa9a
mediumturquoise 48d1cc mediumvioletred c71585 midnightblue 191970 mintcream f5fffa mistyrose ffe4e1 moccasin
ffe4b5 navajowhite ffdead navy 000080 oldlace fdf5e6 olive 808000 olivedrab 6b8e23 orange ffa500 orangered
ff4500 orchid da70d6 palegoldenrod eee8aa palegreen 98fb98 paleturquoise afeeee palevioletred db7093 papayawhip
ffefd5 peachpuff ffdab9 peru cd853f pink ffc0cb plum dda0dd powderblue b0e0e6 purple 800080 rebeccapurple 663399
red ff0000 rosybrown bc8f8f royalblue 4169e1 saddlebrown 8b4513 salmon fa8072 sandybrown f4a460 seagreen 2e8b57
seashell fff5ee sienna a0522d silver c0c0c0 skyblue 87ceeb slateblue 6a5acd slategray 708090 slategrey 708090
snow fffafa springgreen 00ff7f steelblue 4682b4 tan d2b48c teal 008080 thistle d8bfd8 tomato ff6347 turquoise
40e0d0 violet ee82ee wheat f5deb3 white ffffff whitesmoke f5f5f5 yellow ffff00 yellowgreen 9acd32
"""
"""The named colours of CSS Color Module Level 4."""
NAMED = dict(zip(_NAMED.split()[::2], _NAMED.split()[1::2], strict=True))
T = TypeVar("T")


def rgb_of(text: str) -> Rgb | None:
    """What a colour written as in CSS is: a name, #rgb, #rrggbb or rgb(...); None for anything else."""
    plain = text.lower().strip()
    if found := re.fullmatch(r"#([0-9a-f]{3}|[0-9a-f]{6})", plain):
        digits = found[1] if len(found[1]) == 6 else "".join(2 * digit for digit in found[1])
        red, green, blue = bytes.fromhex(digits)
        return red, green, blue
    if found := re.fullmatch(r"rgba?\(([^)]*)\)", plain):
        parts = re.findall(r"[\d.]+%?", found[1])[:3]
        levels = [min(255, round(float(part.rstrip("%")) * (2.55 if "%" in part else 1))) for part in parts]
        return (levels[0], levels[1], levels[2]) if len(levels) == 3 else None
    return rgb_of(f"#{NAMED[plain]}") if plain in NAMED else None


def lab_of(colour: Rgb) -> Lab:
    """A colour of sRGB as a person sees it on white paper (CIE 1976, D65)."""
    red, green, blue = (_linear(level / 255) for level in colour)
    x = (0.4124564 * red + 0.3575761 * green + 0.1804375 * blue) / 0.950456
    y = 0.2126729 * red + 0.7151522 * green + 0.0721750 * blue
    z = (0.0193339 * red + 0.1191920 * green + 0.9503041 * blue) / 1.088754
    x, y, z = (_cube_root(each) for each in (x, y, z))
    return 116 * y - 16, 500 * (x - y), 200 * (y - z)


@dataclass(frozen=True, slots=True)
class Pens:
    """The pens that there are, in drawing order. colours: of their lines on white paper; none: one pen of any colour.

    skip: numbers of those whose lines are told apart and not drawn.
    """

    names: tuple[str, ...] = ()
    colours: tuple[Rgb, ...] = ()
    skip: frozenset[int] = frozenset()

    def nearest(self, colour: Rgb) -> int:
        """Which of them a person would take for this colour."""
        lab = lab_of(colour)
        return min(range(len(self.colours)), key=lambda pen: math.dist(lab, lab_of(self.colours[pen])), default=0)

    def sorted(self, lines: Sequence[T], colours: Sequence[Rgb]) -> dict[int, list[T]]:
        """The lines by the pen that draws them, the pens in order. colours: of each line; none: all are black."""
        pen_of = {colour: self.nearest(colour) for colour in {*colours, BLACK}}
        found: dict[int, list[T]] = {pen: [] for pen in sorted(set(pen_of.values()) - self.skip)}
        for line, colour in zip(lines, colours or [BLACK] * len(lines), strict=True):
            if (pen := pen_of[colour]) in found:
                found[pen].append(line)
        return found


ONE_PEN = Pens()


def _linear(level: float) -> float:
    return level / 12.92 if level <= 0.04045 else float(((level + 0.055) / 1.055) ** 2.4)


def _cube_root(share: float) -> float:
    return float(share ** (1 / 3)) if share > 0.008856 else 7.787 * share + 16 / 116
