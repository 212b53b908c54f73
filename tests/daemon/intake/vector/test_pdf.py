"""Pages of PDF files: where their lines lie in mm, when a page is seen as a picture, and what is refused."""

from __future__ import annotations

import sys
from contextlib import closing
from pathlib import Path

import cv2
import numpy as np
import pypdfium2
import pytest
from numpy.typing import NDArray

from daemon.errors import BadPicture
from daemon.intake.picture import open_picture
from daemon.intake.vector import common, pdf_paths
from daemon.intake.vector.common import Rendered, Vectors
from daemon.intake.vector.pdf import pages_of_pdf, read_pdf
from daemon.intake.vector.sheet import as_page
from daemon.shapes import Grey
from tests.daemon.intake.vector.pdfs import ENCRYPTED, FONT, object_stream, pdf, stream
from tests.daemon.intake.vector.refused import assert_refused

PT = 25.4 / 72
TEXT = "BT /F 12 Tf 10 20 Td (hello) Tj ET 0 0 m 9 9 l S"
FONTS = f"/Font << /F {FONT} >>"


def read(data: bytes, page: int = 1) -> Vectors:
    found = read_pdf(data, page=page, max_megapixels=10)
    assert isinstance(found, Vectors)
    return found


def lines_pt(data: bytes) -> list[list[list[float]]]:
    """In points of the page, y downwards."""
    return [(line / PT).round(3).tolist() for line in read(data).lines]


def test_lines_lie_where_the_file_says() -> None:
    found = read(pdf(["10 20 m 30 40 l 50 40 l S"]))
    assert (found.width_mm, found.height_mm) == pytest.approx((25.4, 50.8))
    assert lines_pt(pdf(["10 20 m 30 40 l 50 40 l S"])) == [[[10, 124], [30, 104], [50, 104]]]


@pytest.mark.parametrize(
    ("page", "expected"),
    [
        ("/Rotate 90", [[20, 10], [20, 30]]),
        ("/Rotate 180", [[62, 20], [42, 20]]),
        ("/Rotate 270", [[124, 62], [124, 42]]),
        ("/CropBox [5 10 65 110]", [[5, 90], [25, 90]]),
        ("/Rotate 90 /CropBox [5 10 65 110]", [[10, 5], [10, 25]]),
    ],
)
def test_turned_and_cropped_pages_are_drawn_as_they_are_shown(page: str, expected: list[list[float]]) -> None:
    assert lines_pt(pdf(["10 20 m 30 20 l S"], page=page)) == [expected]


def test_transforms_and_forms_within_forms_move_lines() -> None:
    inner = stream("0 0 m 2 0 l S", "/Type /XObject /Subtype /Form /BBox [0 0 99 99] /Matrix [1 0 0 1 3 0]")
    outer = stream(
        "q 2 0 0 2 10 20 cm /I Do Q",
        "/Type /XObject /Subtype /Form /BBox [0 0 99 99] /Resources << /XObject << /I 3 0 R >> >>",
    )
    data = pdf(["1 0 0 1 5 5 cm /O Do"], resources="/XObject << /O 4 0 R >>", more=[inner, outer])
    assert lines_pt(data) == [[[21, 119], [25, 119]]]


def test_curves_lie_within_two_hundredths_of_a_mm() -> None:
    # A quarter of a circle of 36 points about the origin, as Bezier curves make it: within 0.03 % of its radius.
    data = pdf(["36 0 m 36 19.8823 19.8823 36 0 36 c S"])
    (line,) = read(data).lines
    radii = np.hypot(*((line[1:] + line[:-1]) / 2 - (0, 144 * PT)).T)
    assert np.abs(radii - 36 * PT).max() < 0.02


def test_rectangles_are_closed_and_fills_drawn_by_their_outline() -> None:
    first, second = lines_pt(pdf(["10 10 20 30 re S 40 10 m 60 10 l 60 40 l f"]))
    assert first[0] == first[-1]
    assert len(first) == 5
    assert second == [[40, 134], [60, 134], [60, 104], [40, 134]]


def test_a_path_that_goes_nowhere_is_a_dot() -> None:
    assert lines_pt(pdf(["1 J 10 10 m 10 10 l S"])) == [[[10, 134]]]


@pytest.mark.parametrize("packed", [False, True], ids=["in the open", "in an object stream"])
def test_a_unit_of_the_page_may_be_larger_than_a_point(packed: bool) -> None:
    data = pdf(["10 20 m 30 20 l S"], page="/UserUnit 2.5")
    found = read(object_stream(data) if packed else data)
    assert (found.width_mm, found.height_mm) == pytest.approx((2.5 * 25.4, 2.5 * 50.8))
    assert (found.lines[0] / PT / 2.5).round(3).tolist() == [[10, 124], [30, 124]]


def test_a_picture_of_larger_units_has_its_true_resolution() -> None:
    found = read_pdf(pdf([TEXT], resources=FONTS, page="/UserUnit 2"), page=1, max_megapixels=10)
    assert isinstance(found, Rendered)
    assert found.grey.shape == (1200, 600)
    assert found.px_per_mm == pytest.approx(300 / 25.4)


@pytest.mark.parametrize("packed", [False, True], ids=["in the open", "in an object stream"])
def test_where_a_layer_is_hidden_the_page_is_read_as_it_looks(packed: bool) -> None:
    layer = "<< /Type /OCG /Name (hidden) >>"
    shown = "/OCProperties << /OCGs [3 0 R] /D << /OFF [ 3 0 R ] >> >>"
    content = "/OC /L BDC 0 10 m 72 10 l S EMC"
    data = pdf([content], resources="/Properties << /L 3 0 R >>", more=[layer], catalog=shown)
    found = read_pdf(object_stream(data) if packed else data, page=1, max_megapixels=10)
    assert isinstance(found, Rendered)
    assert found.grey.min() == 255


def test_a_form_shows_no_more_than_the_clip_that_it_is_drawn_in() -> None:
    form = stream("0 5 m 72 5 l S", "/Type /XObject /Subtype /Form /BBox [0 0 40 20]")
    data = pdf(["q 2 0 0 1 0 0 cm 5 0 10 20 re W n /F Do Q"], resources="/XObject << /F 3 0 R >>", more=[form])
    (line,) = lines_pt(data)
    assert [x for x, _ in line] == pytest.approx([10, 30], abs=0.1)


@pytest.mark.parametrize(
    "content",
    [
        "0 0 m 60 0 l 0 60 l h W n 0 10 m 72 50 l S",
        "0 10 m 72 10 l S 1 g 20 0 40 20 re f",
        "0 g 9 9 50 50 re f 9 9 m 59 59 l S",
    ],
    ids=["clip that is no box", "white over it", "black in black"],
)
def test_where_lines_are_hidden_the_page_is_read_as_it_looks(content: str) -> None:
    assert isinstance(read_pdf(pdf([content]), page=1, max_megapixels=10), Rendered)


def test_a_picture_keeps_its_colours_where_they_are_asked_for() -> None:
    found = read_pdf(pdf([f"1 0 0 rg 1 0 0 RG {TEXT}"], resources=FONTS), page=1, max_megapixels=10, in_colour=True)
    assert isinstance(found, Rendered)
    assert found.colour is not None
    assert found.colour.shape == (600, 300, 3)
    assert found.colour.reshape(-1, 3).min(axis=0).tolist() == [0, 0, 255]


@pytest.mark.parametrize("page", ["", "/Rotate 90 /CropBox [8 4 60 120]", "/Rotate 180", "/Rotate 270"])
def test_lines_lie_where_they_are_seen(page: str) -> None:
    """Each inked pixel of the page as PDFium paints it has a line beside it, each line ink below it."""
    inner = stream(
        "0 0 20 12 re S 3 3 m 12 25 24 -9 30 12 c S",
        "/Type /XObject /Subtype /Form /BBox [-5 -5 40 40] /Matrix [0.8 0.3 -0.3 0.8 2 1]",
    )
    content = "q 15 25 36 40 re W n 1.5 0.2 -0.2 1.2 12 30 cm 1 0 0 1 4 2 cm /I Do Q 10 90 m 60 110 l 40 130 l S"
    data = pdf([content], resources="/XObject << /I 3 0 R >>", more=[inner], page=page)
    seen = painted(data)
    drawn = as_page(read(data), sha256="").page.grey
    drawn = cv2.resize(drawn, seen.shape[::-1], interpolation=cv2.INTER_AREA)
    assert beside(seen < 128, drawn < 128) > 0.995
    assert beside(drawn < 100, seen < 128) > 0.995


def painted(data: bytes) -> Grey:
    with closing(pypdfium2.PdfDocument(data)) as document:
        return np.array(document[0].render(scale=5, grayscale=True).to_numpy(), np.uint8)


def beside(some: NDArray[np.bool_], others: NDArray[np.bool_]) -> float:
    """The share of some pixels that have one of the others within 5."""
    near = cv2.dilate(others.astype(np.uint8), np.ones((11, 11), np.uint8)) > 0
    return float((some & near).sum() / some.sum())


def test_the_points_of_a_path_count_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(common, "MOST_POINTS", 30)
    zigzag = [f"{k} {k % 2} l" for k in range(1, 31)]
    assert len(read(pdf([f"0 0 m {' '.join(zigzag[:29])} S"])).lines) == 1
    with pytest.raises(ValueError, match="holds more than 30 points"):
        read(pdf([f"0 0 m {' '.join(zigzag)} S"]))


def test_what_is_white_or_only_a_clip_is_left_out() -> None:
    found = read(pdf(["1 g 0 0 72 144 re f 0 0 30 30 re W n 0 10 m 72 10 l S"]))
    assert found.warnings == ("1 white shape is left out",)
    (line,) = found.lines
    assert line[-1, 0] / PT == pytest.approx(30, abs=0.05)


def test_dashes_stay_dashes() -> None:
    assert lines_pt(pdf(["[4 6] 0 d 0 10 m 20 10 l S"])) == [[[0, 134], [4, 134]], [[10, 134], [14, 134]]]


@pytest.mark.parametrize(
    ("content", "resources"),
    [
        (TEXT, FONTS),
        ("q 50 0 0 50 0 0 cm BI /W 1 /H 1 /BPC 8 /CS /G ID \0 EI Q", ""),
    ],
)
def test_a_page_with_text_or_pictures_is_a_picture_of_its_true_size(content: str, resources: str) -> None:
    found = read_pdf(pdf([content], resources=resources), page=1, max_megapixels=10)
    assert isinstance(found, Rendered)
    assert found.grey.shape == (600, 300)
    assert found.px_per_mm == pytest.approx(300 / 25.4)
    assert found.grey.min() < 50
    assert found.warnings == ("the page holds more than plain lines: it was read as a picture of 300 dpi",)


@pytest.mark.parametrize(("max_megapixels", "expected"), [(4, 4e6), (100, 35e6)])
def test_a_large_page_is_seen_with_fewer_pixels(max_megapixels: float, expected: float) -> None:
    data = pdf(["BT /F 12 Tf (x) Tj ET"], resources=FONTS, page="/MediaBox [0 0 7200 7200]")
    found = read_pdf(data, page=1, max_megapixels=max_megapixels)
    assert isinstance(found, Rendered)
    assert 0.95 * expected < found.grey.size <= expected


def test_each_page_is_its_own() -> None:
    data = pdf(["10 20 m 30 20 l S", "10 50 m 30 50 l S", ""])
    assert pages_of_pdf(data) == 3
    assert [len(read(data, page).lines) for page in (1, 2, 3)] == [1, 1, 0]
    assert (read(data, 2).lines[0] / PT)[0].tolist() == pytest.approx([10, 94])


def many(count: int) -> bytes:
    """Thousands of times the same page."""
    kids = "4 0 R " * count
    data = pdf(["0 0 m 9 9 l S"], more=["null"])
    return data.replace(b"/Kids [4 0 R] /Count 1", f"/Kids [{kids}] /Count {count}".encode())


def form_in_itself() -> bytes:
    form = stream(
        "/F Do /F Do", "/Type /XObject /Subtype /Form /BBox [0 0 9 9] /Resources << /XObject << /F 3 0 R >> >>"
    )
    return pdf(["/F Do"], resources="/XObject << /F 3 0 R >>", more=[form])


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (ENCRYPTED, "is encrypted: save it anew without a password"),
        (b"%PDF-1.7\nnothing of the kind", "is damaged"),
        (pdf(["0 0 m 9 9 l S"])[:150], "is damaged"),
        (many(10_000), "has 10000 pages, at most 100 are drawn: split it"),
        (pdf(["0 0 m 9 9 l S"], page="/MediaBox [0 0 99999 99999]"), "mm are drawn|damaged"),
        (pdf(["0 0 m 9 9 l S " * 1001]), "more than 1000 objects"),
    ],
    ids=["encrypted", "corrupt", "cut short", "10000 pages", "huge page", "many objects"],
)
def test_what_cannot_be_read_is_refused_with_a_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, data: bytes, words: str
) -> None:
    monkeypatch.setattr(pdf_paths, "_MOST_OBJECTS", 1000)
    assert_refused(tmp_path / "bad.pdf", data, "a PDF", words)


def test_a_page_that_is_not_there_is_refused() -> None:
    with pytest.raises(ValueError, match="has 1 page, there is no page 2"):
        read(pdf([""]), 2)


def test_without_the_library_the_command_that_installs_it_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "a.pdf").write_bytes(pdf([""]))
    monkeypatch.setitem(sys.modules, "pypdfium2", None)
    with pytest.raises(
        BadPicture, match=r"pypdfium2 is not installed: save it as SVG or PNG; .*pip install 'linedrawd\[pdf\]'"
    ):
        open_picture(tmp_path / "a.pdf")
