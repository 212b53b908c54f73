"""The values that travel from room to room: frozen, with the unit of every number in its name.

Pixel coordinates are (x, y), x to the right, y down, the centre of the first pixel is (0, 0).
Machine coordinates are millimetres, x to the right, y up, seen from above the sheet.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

if TYPE_CHECKING:  # A process that only streams a Program need not load numpy.
    import numpy as np
    from numpy.typing import NDArray

Grey: TypeAlias = "NDArray[np.uint8]"
"""(H, W) uint8, 0 = black ink, 255 = white paper."""
Colours: TypeAlias = "NDArray[np.uint8]"
"""(H, W, 3) uint8: blue, green, red."""
Map: TypeAlias = "NDArray[np.float32]"
"""(H, W) float32 in 0..1."""
Points: TypeAlias = "NDArray[np.float64]"
"""(N, 2) float64, one (x, y) a row."""
Affine: TypeAlias = "NDArray[np.float64]"
"""(2, 3) float64: q = A[:, :2] @ p + A[:, 2]."""
Homography: TypeAlias = "NDArray[np.float64]"
"""(3, 3) float64: (u, v, w) = H @ (x, y, 1), q = (u / w, v / w)."""


@dataclass(frozen=True, slots=True, eq=False)
class Step:
    """Something that was done to a page, in a few words, and the page before it, small enough to be kept."""

    words: str
    before: Grey


@dataclass(frozen=True, slots=True, eq=False)
class PageImage:
    """A page as the rooms see it: upright, dark ink on light paper, bounded in size."""

    grey: Grey
    to_given: Homography
    """Page px to px of the given picture (upright, as a viewer shows it)."""
    given_width_px: int
    given_height_px: int
    sha256: str
    """Of the given file's bytes, hexadecimal."""
    line_width_px: float | None = None
    """Full width of the pen line on this page, where it has been estimated."""
    px_per_mm: float | None = None
    """Of the given picture, where its file states a resolution."""
    colour: Colours | None = None
    """The given picture in colour, as a whole but maybe smaller; None where nobody asks for its colours."""
    steps: tuple[Step, ...] = ()
    """What was done to it, in order; empty for a page on which nothing had to be put right."""
    warnings: tuple[str, ...] = ()
    """What of it lies outside the range that is worked in, in plain words."""
    hatching: tuple[Points, ...] = ()
    """Lines in px that are drawn beside those of the page: they fill its areas."""
    fills: tuple[Points, ...] = ()
    """Lines in px that ink small areas full, of which the page shows the rims: each is to be drawn with its rim."""


@dataclass(frozen=True, slots=True, eq=False)
class Segmentation:
    """What each pixel of a page is: three maps of the page's own shape that sum to 1."""

    background: Map
    lines: Map
    corners: Map


@dataclass(frozen=True, slots=True, eq=False)
class Edge:
    """A line between two vertices, as a polyline in px from vertex `start` to vertex `end`.

    A closed curve without a corner is an edge whose start and end are one vertex.
    """

    start: int
    end: int
    polyline: Points
    plausibility: float
    """Mean response of the lines channel along it, 0..1 (Raghav et al. 2020, Eq. 2)."""
    least_plausibility: float = 0.0
    """Response at its weakest pixel; 0 where nobody looked."""


@dataclass(frozen=True, slots=True, eq=False)
class LineGraph:
    """Vertices (V, 2) in px and the edges between them. Every edge ends in two vertices of the graph."""

    vertices: Points
    edges: tuple[Edge, ...]
    specks: int = 0
    """Pieces of ink that were too small to be anything but dirt, and were left out."""


class NamedPen(NamedTuple):
    """What a person calls a pen, and the colour of its lines as "#rrggbb"."""

    name: str
    colour: str


class Line(NamedTuple):
    """A straight move to `end`, (x, y) in mm, from where the pen is."""

    end: tuple[float, float]


class Arc(NamedTuple):
    """A move to `end` from where the pen is along a circle about `centre`, both (x, y) in mm; never a whole turn."""

    end: tuple[float, float]
    centre: tuple[float, float]
    clockwise: bool

    def sweep(self, start: tuple[float, float]) -> float:
        """The angle in rad, always positive, that is run through from `start` on."""
        from_rad, to_rad = (math.atan2(y - self.centre[1], x - self.centre[0]) for x, y in (start, self.end))
        return (from_rad - to_rad if self.clockwise else to_rad - from_rad) % math.tau


@dataclass(frozen=True, slots=True, eq=False)
class Stroke:
    """What is drawn between engaging and disengaging the pen: one polyline. A single point is a dot.

    moves: the same line as fewer moves from its first point on, where curves have been fitted to it; None where it is
    drawn along its points. Who moves the points moves these as well, or says None. Raises ValueError when the two do
    not end in the same place.
    """

    points: Points
    pen: int = 0
    moves: tuple[Line | Arc, ...] | None = None

    def __post_init__(self) -> None:
        if self.moves and self.moves[-1].end != tuple(self.points[-1].tolist()):
            raise ValueError(f"moves to {self.moves[-1].end} are not the line to {self.points[-1]}: fit them again")

    @property
    def length(self) -> float:
        return math.fsum(math.dist(a, b) for a, b in pairwise(self.points.tolist()))


@dataclass(frozen=True, slots=True, eq=False)
class Drawing:
    """Strokes in px of the picture whose size is stated; every edge is drawn exactly once."""

    strokes: tuple[Stroke, ...]
    width_px: int
    height_px: int
    px_per_mm: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Toolpath:
    """Strokes in machine mm, in drawing order; between them the machine travels with the pen up.

    The pen starts at `start_mm` and is parked at `park_mm`, where it is also changed: strokes of one pen follow each
    other.
    """

    strokes: tuple[Stroke, ...]
    from_px: Affine
    """Drawing px to machine mm."""
    start_mm: tuple[float, float] = (0.0, 0.0)
    park_mm: tuple[float, float] = (0.0, 0.0)
    pens: tuple[NamedPen, ...] = ()
    """By the strokes' `pen`; none where one pen without a name draws everything."""

    @property
    def passes(self) -> dict[int, str]:
        """With which stroke each pen begins, and what it is called; empty where no pen is named."""
        first = {stroke.pen: index for index, stroke in reversed(list(enumerate(self.strokes)))} if self.pens else {}
        return {index: self.pens[pen].name for pen, index in sorted(first.items(), key=lambda each: each[1])}

    @property
    def drawn_mm(self) -> float:
        return math.fsum(stroke.length for stroke in self.strokes)

    @property
    def travelled_mm(self) -> float:
        """With the pen up; where it is changed, by the park place."""
        here, pen, ways = self.start_mm, None, []
        for stroke in self.strokes:
            if pen not in (None, stroke.pen):
                ways.append(math.dist(here, self.park_mm))
                here = self.park_mm
            ways.append(math.dist(here, stroke.points[0]))
            here, pen = tuple(stroke.points[-1]), stroke.pen
        return math.fsum([*ways, math.dist(here, self.park_mm)])


@dataclass(frozen=True, slots=True)
class ProgramLine:
    """One line for the controller and the stroke it belongs to (None before the first and after the last)."""

    text: str
    stroke: int | None = None


@dataclass(frozen=True, slots=True)
class Program:
    """What is sent to a controller, line by line, comments removed."""

    lines: tuple[ProgramLine, ...]
    strokes: int
    passes: Mapping[int, str] = field(default_factory=dict)
    """With which stroke each pen begins, and what it is called; empty where one pen without a name draws it."""

    def pen_of(self, stroke: int) -> str:
        """What the pen of this stroke is called; "" where it has no name."""
        return next((name for first, name in sorted(self.passes.items(), reverse=True) if first <= stroke), "")
