"""DXF files: units, curves, blocks, layers, and what is left out or refused."""

from __future__ import annotations

import io
import sys
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest

from daemon.errors import BadPicture
from daemon.intake.picture import open_picture
from daemon.intake.vector import dxf
from daemon.intake.vector.common import Vectors
from daemon.intake.vector.dxf import read_dxf
from daemon.intake.vector.sheet import VectorPage
from daemon.shapes import Points
from tests.daemon.intake.vector.refused import assert_refused

MM, INCH, NONE = 4, 1, 0


def document(units: int = MM) -> Any:
    return ezdxf.new("R2010", setup=False, units=units)


def encoded(doc: Any) -> bytes:
    stream = io.StringIO()
    doc.write(stream)
    return stream.getvalue().encode("utf-8")


def read(doc: Any) -> Vectors:
    return read_dxf(encoded(doc))


def only(doc: Any) -> Points:
    (line,) = read(doc).lines
    return line


@pytest.mark.parametrize(("units", "width_mm"), [(MM, 30.0), (INCH, 762.0), (5, 300.0), (NONE, 30.0)])
def test_a_line_is_as_long_as_its_unit_says(units: int, width_mm: float) -> None:
    doc = document(units)
    doc.modelspace().add_line((100, 50, 7), (130, 50, 9))
    line = only(doc)
    assert line[1, 0] - line[0, 0] == pytest.approx(width_mm)
    assert read(doc).width_mm == pytest.approx(width_mm + 2)
    assert ("the file says no unit: mm are taken" in read(doc).warnings) is (units == NONE)


def test_y_runs_upwards_in_the_file_and_downwards_on_the_page() -> None:
    doc = document()
    doc.modelspace().add_lwpolyline([(0, 0), (10, 0), (10, 20)])
    assert only(doc).tolist() == [[1, 21], [11, 21], [11, 1]]


@pytest.mark.parametrize("kind", ["circle", "arc", "bulge", "ellipse", "block"])
def test_curves_lie_within_two_hundredths_of_a_mm(kind: str) -> None:
    doc = document()
    space = doc.modelspace()
    match kind:
        case "circle":
            space.add_circle((5, 5), 40)
        case "arc":
            space.add_arc((5, 5), 40, 0, 360 - 1e-9)
        case "bulge":
            space.add_lwpolyline([(-35, 5, 0, 0, 1), (45, 5, 0, 0, 1)], close=True)
        case "ellipse":
            space.add_ellipse((5, 5), (0, 40), 1.0)
        case "block":
            doc.blocks.new("round").add_circle((1, 0), 4)
            space.add_blockref("round", (5, 15), {"xscale": 10, "yscale": 10, "rotation": -90})
    found = read(doc)
    line = np.concatenate([found.lines[0], (found.lines[0][1:] + found.lines[0][:-1]) / 2])
    assert np.abs(np.hypot(*(line - (41, 41)).T) - 40).max() < 0.02


def test_a_spline_passes_its_ends() -> None:
    doc = document()
    doc.modelspace().add_spline([(0, 0), (10, 5), (20, 0), (30, 9)])
    line = only(doc)
    assert line[-1] - line[0] == pytest.approx((30, -9))
    assert len(line) > 20


def test_blocks_within_blocks_and_rows_of_blocks_are_drawn_where_they_are_inserted() -> None:
    doc = document()
    doc.blocks.new("inner").add_line((0, 0), (1, 0))
    doc.blocks.new("outer").add_blockref("inner", (2, 0))
    doc.modelspace().add_blockref("outer", (10, 0), {"column_count": 3, "column_spacing": 5})
    assert sorted(line[0, 0] for line in read(doc).lines) == [1, 6, 11]


def test_layers_that_are_off_or_frozen_are_left_out_with_the_blocks_on_them() -> None:
    doc = document()
    doc.layers.add("off").off()
    doc.layers.add("frozen").freeze()
    doc.blocks.new("b").add_line((0, 0), (9, 9))
    space = doc.modelspace()
    space.add_line((0, 0), (1, 0))
    space.add_line((0, 0), (2, 2), {"layer": "off"})
    space.add_blockref("b", (0, 0), {"layer": "frozen"})
    space.add_line((0, 0), (2, 2), {"invisible": 1})
    assert len(read(doc).lines) == 1


def test_text_and_what_has_no_lines_is_told_of() -> None:
    doc = document()
    space = doc.modelspace()
    space.add_line((0, 0), (1, 0))
    space.add_text("hello")
    space.add_mtext("there")
    space.add_ray((0, 0), (1, 1))
    assert read(doc).warnings == (
        "2 texts are left out: turn what shall be drawn into lines",
        "1 of the kind RAY is left out",
    )


def test_a_reference_to_another_file_is_left_out_and_told() -> None:
    doc = document()
    doc.modelspace().add_line((0, 0), (1, 0))
    doc.add_xref_def("/etc/passwd", "outside")
    doc.modelspace().add_blockref("outside", (0, 0))
    assert read(doc).warnings == ("1 of the kind reference to another file is left out",)


def test_points_and_hatches_are_drawn() -> None:
    doc = document()
    doc.modelspace().add_point((5, 5))
    hatch = doc.modelspace().add_hatch()
    hatch.paths.add_polyline_path([(0, 0), (10, 0), (10, 10)], is_closed=True)
    dot, outline = read(doc).lines
    assert len(dot) == 1
    assert (outline[0] == outline[-1]).all()


def test_binary_dxf_is_read_too(tmp_path: Path) -> None:
    doc = document()
    doc.modelspace().add_line((0, 0), (10, 0))
    doc.saveas(tmp_path / "b.dxf", fmt="bin")
    found = open_picture(tmp_path / "b.dxf")
    assert isinstance(found, VectorPage)
    assert len(found.drawing.strokes) == 1


def test_an_empty_dxf_is_an_empty_page() -> None:
    assert read(document()).lines == ()


def bomb() -> bytes:
    doc = document()
    doc.blocks.new("b0")
    for level in range(1, 9):
        block = doc.blocks.new(f"b{level}")
        for _ in range(10):
            block.add_blockref(f"b{level - 1}", (0, 0))
    doc.modelspace().add_blockref("b8", (0, 0))
    return encoded(doc)


def itself() -> bytes:
    doc = document()
    doc.blocks.new("b").add_blockref("b", (0, 0))
    doc.modelspace().add_blockref("b", (0, 0))
    return encoded(doc)


def far() -> bytes:
    doc = document()
    doc.modelspace().add_line((0, 0), (1e6, 0))
    return encoded(doc)


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (bomb(), "more than 2000 lines"),
        (itself(), "more than 2000 lines|is damaged"),
        (far(), "20000 mm are drawn: scale it"),
        (b"0\nSECTION\n2\nENTITIES\n0\nLINE\n10\nfish\n", "is damaged"),
        (b"0\nSECTION\n", "is damaged"),
        (b"AutoCAD Binary DXF\r\n\x1a\x00\xff\xff\xff", "is damaged"),
    ],
)
def test_what_cannot_be_read_is_refused_with_a_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, data: bytes, words: str
) -> None:
    monkeypatch.setattr(dxf, "MOST_ENTITIES", 2000)
    assert_refused(tmp_path / "bad.dxf", data, "a DXF", words)


def test_without_the_library_the_command_that_installs_it_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "a.dxf").write_bytes(encoded(document()))
    monkeypatch.setitem(sys.modules, "ezdxf", None)
    with pytest.raises(BadPicture, match=r"ezdxf is not installed: save it as SVG or PDF; .*pip install '"):
        open_picture(tmp_path / "a.dxf")


def test_a_line_has_its_own_colour_or_that_of_its_layer() -> None:
    doc = document()
    doc.layers.add("walls", color=5)
    space = doc.modelspace()
    space.add_line((0, 0), (9, 0), dxfattribs={"color": 1})
    space.add_line((0, 1), (9, 1), dxfattribs={"layer": "walls"})
    space.add_line((0, 2), (9, 2), dxfattribs={"true_color": 0x20A040})
    space.add_line((0, 3), (9, 3))
    assert read(doc).colours == ((255, 0, 0), (0, 0, 255), (0x20, 0xA0, 0x40), (0, 0, 0))
