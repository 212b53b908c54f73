"""A toolpath as SVG."""

from __future__ import annotations

from collections.abc import Callable
from xml.etree import ElementTree

from daemon.program.svg import write_svg
from tests.daemon.program.examples import TOOLPATH

_PATH = "{http://www.w3.org/2000/svg}path"


def test_the_picture_is_the_golden_one(golden: Callable[[str, str], None]) -> None:
    golden("drawing.svg", write_svg(TOOLPATH, size_mm=(64, 64), corner_mm=(10, 0)))


def test_there_is_one_path_a_stroke_and_y_points_down() -> None:
    root = ElementTree.fromstring(write_svg(TOOLPATH, size_mm=(100, 90)))
    paths = [path.get("d") for path in root.iter(_PATH)]
    assert len(paths) == 3
    assert paths[0] == "M 30.000 50.000 L 30.000 39.500 L 41.250 39.500"


def test_the_size_is_in_mm_and_one_unit_is_one_mm() -> None:
    root = ElementTree.fromstring(write_svg(TOOLPATH, size_mm=(210, 148.5)))
    assert (root.get("width"), root.get("height"), root.get("viewBox")) == ("210mm", "148.5mm", "0 0 210 148.5")


def test_a_dot_is_a_path_that_is_seen() -> None:
    svg = write_svg(TOOLPATH, size_mm=(64, 64))
    assert '<path d="M 12.346 64.000 L 12.346 64.000"/>' in svg
    assert 'stroke-linecap="round"' in svg
