"""The inputs of the gallery: own drawings and drawings made here, kind by kind, each with a line of words."""

from __future__ import annotations

import io
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from pathlib import Path

import cv2
import ezdxf
import numpy as np

from daemon.report.canvas import Picture
from daemon.shapes import Grey
from tests.benchmarks.fidelity import curves, overdrawn, photographed, scanned, technical
from tests.benchmarks.fidelity.known import Known
from tests.daemon.intake.vector.pdfs import pdf
from tests.daemon.page.test_sheet import on_desk, turned
from tests.drawings import scenes
from tests.drawings.make import Sheet, draw
from tests.gallery import sheets

DRAWINGS = Path(__file__).parents[1] / "drawings"


@dataclass(frozen=True, slots=True)
class Input:
    """A file as somebody gives it. words: what it is, and what to look at."""

    file: str
    words: str
    make: Callable[[], bytes]


def kinds() -> dict[str, tuple[Input, ...]]:
    """For each kind its inputs; the last kind are those that are no drawings, or broken."""
    return {**_DRAWN, **_WORN, **_HARD, "Vector files": _VECTORS, "No drawings": _BAD}


def _own(file: str, words: str) -> Input:
    return Input(file, words, (DRAWINGS / file).read_bytes)


def _png(file: str, words: str, picture: Callable[[], Grey | Picture]) -> Input:
    return Input(file, words, lambda: _encoded(".png", picture()))


def _of_set(file: str, words: str, known: Callable[[], list[Known]], number: int) -> Input:
    """The one with that number of a set of the fidelity benchmark, as it is given there."""
    return _png(file, words, lambda: _set(known)[number].grey)


@cache
def _set(known: Callable[[], list[Known]]) -> list[Known]:
    return known()


def _encoded(kind: str, picture: Grey | Picture) -> bytes:
    return bytes(cv2.imencode(kind, picture)[1])


_HAIR = Sheet("hair_lines.png", scenes.flower, 1600, 1.2)

_DRAWN = {
    "Clean drawings": (
        _own("face.png", "A face, drawn by an unsteady hand."),
        _of_set("rose.png", "A rose of five petals: curves that cross in one point.", curves.curves, 2),
        _own("spiral.png", "One line of six turns."),
    ),
    "Pens": (
        _own("thick_marker.jpg", "A marker 18 px wide: one line along its middle."),
        _png("hair_lines.png", "Lines of one pixel on a large page.", lambda: draw(_HAIR)[0]),
        _own("faint_pencil.jpg", "Faint pencil on grey paper, lit from one corner."),
    ),
    "Writing and music": (
        _own("script.png", "Joined-up writing, and the dot."),
        _of_set("words.png", "The same with a ball pen, scanned at 300 dpi.", scanned.scans, 16),
        _png("music.png", "Two staves: the filled heads of the notes are inked to and fro.", sheets.music),
    ),
    "Plans and technical drawings": (
        _own("floor_plan.png", "A flat with doors and stairs."),
        _of_set("cross_hatch.png", "Hatches that cross at 45 degrees: every line once, straight through.",
                technical.technical, 6),
        _of_set("mesh.png", "A mesh of triangles, six lines into most corners.", technical.technical, 5),
    ),
}  # fmt: skip
_WORN = {
    "Photographs": (
        _of_set("photo.png", "Uneven light, blur, noise, JPEG; 256 px.", photographed.photos, 33),
        _of_set("on_desk.png", "Squared paper on a desk, taken from an angle, in a shadow.",
                photographed.hard_photos, 5),
        _of_set("in_shadow.png", "Squared paper in a shadow: the squares are not drawn.",
                photographed.hard_photos, 34),
    ),
    "Scans, 300 dpi": (
        _of_set("ruled.png", "Ball pen on ruled paper: the ruling is not drawn.", scanned.scans, 13),
        _of_set("squared.png", "Pencil on squared paper.", scanned.scans, 6),
        _of_set("recycled.png", "A marker of 2 mm on recycled paper, full of fibres.", scanned.scans, 35),
    ),
    "Boards and colours": (
        _own("dark_paper.jpg", "Chalk on a dark board."),
        _png("colours.png", "Three colours, read by their darkness: no pens are set.", sheets.colours),
        _png("yellow_paper.png", "Indigo ink on yellow paper.", sheets.on_coloured_paper),
    ),
}  # fmt: skip

_HARD = {
    "Drawn over, drawn close": (
        _of_set("overdrawn.png", "Each line drawn twice, the passes touching.", overdrawn.overdrawn, 14),
        _of_set("apart.png", "Each line drawn twice, paper between them: one line is drawn, as people trace it.",
                overdrawn.apart, 14),
        _own("hatch.png", "Shading by parallel lines."),
    ),
    "Areas, dashes and dots": (
        _png("hills.png", "A filled sun and hill: their outlines; what stays bare of them counts against F1.",
             sheets.hills),
        _own("dot_and_dash.png", "A dashed way and dots stay dashes and dots."),
        _png("dominoes.png", "Tiles: each filled eye is one stroke, round its rim and to and fro.", sheets.dominoes),
    ),
}  # fmt: skip


def _dxf() -> bytes:
    """A flange: circles, arcs, a slot of a polyline with bulges, a spline. In mm."""
    document = ezdxf.new("R2010", setup=False, units=4)
    space = document.modelspace()
    for radius in (28, 22, 9):
        space.add_circle((30, 30), radius)
    for number in range(6):
        angle = np.radians(60 * number)
        space.add_circle((30 + 15.5 * np.cos(angle), 30 + 15.5 * np.sin(angle)), 3)
    space.add_line((0, 30), (60, 30))
    space.add_line((30, 0), (30, 60))
    space.add_arc((30, 30), 25, 10, 80)
    slot = [(70.0, 20.0, 0.0), (70.0, 40.0, -1.0), (80.0, 40.0, 0.0), (80.0, 20.0, -1.0)]
    space.add_lwpolyline(slot, format="xyb", close=True)
    space.add_spline([(66, 8), (74, 14), (78, 4), (86, 10)])
    stream = io.StringIO()
    document.write(stream)
    return stream.getvalue().encode()


def _pdf() -> bytes:
    """A page of 72 x 144 points with lines, curves and a rectangle."""
    sail = "20 40 m 36 120 l 52 40 l h S 36 120 m 36 26 l S"
    hull = "10 34 m 20 14 52 14 62 34 c h S"
    sea = " ".join(f"{4 + 16 * n} 10 m {8 + 16 * n} 16 {12 + 16 * n} 4 {16 + 16 * n} 10 c S" for n in range(4))
    return pdf([f"1 w {sail} {hull} {sea} 36 110 20 8 re S"])


def _laughs() -> bytes:
    """An SVG whose entities would become ten million words."""
    names = ["a", *(f"a{number}" for number in range(7))]
    rows = [f'<!ENTITY {new} "{f"&{old};" * 10}">' for old, new in pairwise(names)]
    head = '<!DOCTYPE svg [<!ENTITY a "ha">' + "".join(rows) + "]>"
    return f'<?xml version="1.0"?>{head}<svg xmlns="http://www.w3.org/2000/svg"><text>&a6;</text></svg>'.encode()


_VECTORS = (
    _own("shapes.svg", "SVG: paths, arcs, a transform, a symbol, a dashed line, a filled star."),
    Input("flange.dxf", "DXF: circles, arcs, bulges, a spline.", _dxf),
    Input("boat.pdf", "PDF: the paths of a page.", _pdf),
)
_HALF_OUTSIDE = np.array([[180, -90], [600, -60], [580, 560], [150, 520]], float)
_BAD = (
    _png("cat_photo.png", "A photograph of a cat: no lines.", sheets.furry),
    _png("text.png", "A page of text: its letters are lines, too, and all of them are drawn.", sheets.text),
    _png("turned.png", "A sheet on a desk, turned by 45 degrees: one of its sides becomes the upper one.",
         lambda: on_desk(turned(45))),
    _png("cut_off.png", "Half of the sheet lies outside the picture: what is seen of it is drawn.",
         lambda: on_desk(_HALF_OUTSIDE)),
    _png("black.png", "A black page.", lambda: np.zeros((400, 400), np.uint8)),
    _png("strip.png", "A blank strip of 20,000 x 1 px.", lambda: np.full((1, 20000), 255, np.uint8)),
    Input("cut_short.png", "A file of which only a part was copied.",
          lambda: (DRAWINGS / "face.png").read_bytes()[:3000]),
    Input("laughs.svg", "An SVG whose entities would fill the memory.", _laughs),
    Input("broken.pdf", "A PDF that is none.", lambda: b"%PDF-1.7\nnothing of a PDF follows\n"),
)  # fmt: skip
