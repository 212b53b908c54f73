"""SVG files: where their lines lie in mm, what is seen of them, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from daemon.errors import BadPicture
from daemon.intake.picture import open_picture
from daemon.intake.vector import svg, svg_path
from daemon.intake.vector.common import Vectors
from daemon.intake.vector.sheet import VectorPage
from daemon.intake.vector.svg import read_svg
from daemon.shapes import Points
from tests.daemon.intake.vector.refused import assert_refused

HEAD = '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" '
LINES = 'width="100mm" height="80mm" viewBox="0 0 100 80" fill="none" stroke="black">'


def read(body: str, head: str = LINES) -> Vectors:
    return read_svg(f"{HEAD}{head}{body}</svg>".encode())


def only(body: str, head: str = LINES) -> Points:
    (line,) = read(body, head).lines
    return line


def beside_a_circle(line: Points, centre: tuple[float, float], radius: float) -> float:
    """How far the chords of a line lie from a circle at most."""
    middles = (line[1:] + line[:-1]) / 2
    return float(np.abs(np.hypot(*(np.concatenate([line, middles]) - centre).T) - radius).max())


@pytest.mark.parametrize(
    ("head", "size_mm", "end_mm", "sized"),
    [
        ('width="50mm" height="40mm" viewBox="0 0 100 80"', (50, 40), (5, 10), True),
        ('width="96" height="96px"', (25.4, 25.4), (2.6458, 5.2917), True),
        ('width="2in" viewBox="0 0 20 10"', (50.8, 25.4), (25.4, 50.8), True),
        ('width="40mm" height="20mm" viewBox="0 0 20 20"', (40, 20), (20, 20), True),
        ('width="40mm" height="20mm" viewBox="0 0 20 20" preserveAspectRatio="none"', (40, 20), (20, 20), True),
        ('width="40mm" height="20mm" viewBox="0 0 20 20" preserveAspectRatio="xMinYMin"', (40, 20), (10, 20), True),
        ('viewBox="0 0 100 50"', (200, 100), (20, 40), False),
        ('width="100%" height="100%" viewBox="-10 0 100 50"', (200, 100), (40, 40), False),
    ],
)
def test_units_and_view_say_where_a_line_lies(
    head: str, size_mm: tuple[float, float], end_mm: tuple[float, float], sized: bool
) -> None:
    found = read('<path stroke="black" d="M0 0L10 20"/>', head + ">")
    assert (found.width_mm, found.height_mm) == pytest.approx(size_mm, abs=1e-3)
    # Clipped to the page where the line runs beyond it.
    assert found.lines[0][-1] == pytest.approx(np.minimum(end_mm, size_mm), abs=1e-3) or size_mm[1] < end_mm[1]
    assert found.sized is sized


@pytest.mark.parametrize(
    ("d", "points"),
    [
        ("M1 2 3 4 5 2", [(1, 2), (3, 4), (5, 2)]),
        ("m1 2 3 4 5 2", [(1, 2), (4, 6), (9, 8)]),
        ("M1,2h3v-1H2V4z", [(1, 2), (4, 2), (4, 1), (2, 1), (2, 4), (1, 2)]),
        ("M.5.5 1e1-0", [(0.5, 0.5), (10, 0)]),
        ("M1 1L2 2 what", [(1, 1), (2, 2)]),
    ],
)
def test_straight_pieces_of_a_path(d: str, points: list[tuple[float, float]]) -> None:
    assert only(f'<path d="{d}"/>') == pytest.approx(np.array(points, float))


def test_a_path_goes_on_from_where_it_was_closed() -> None:
    first, second = read('<path d="M10 10h5v5zl-2-2"/>').lines
    assert (first[0] == first[-1]).all()
    assert second == pytest.approx(np.array([(10, 10), (8, 8)]))


@pytest.mark.parametrize(
    "body",
    [
        '<circle cx="50" cy="40" r="30"/>',
        '<ellipse cx="50" cy="40" rx="30" ry="30"/>',
        '<path d="M20 40a30 30 0 1160 0a30 30 0 0 1-60 0"/>',
        '<rect x="20" y="10" width="60" height="60" rx="30"/>',
        '<circle r="3" transform="translate(50 40) scale(10) rotate(30)"/>',
    ],
)
def test_circles_lie_within_two_hundredths_of_a_mm(body: str) -> None:
    assert beside_a_circle(only(body), (50, 40), 30) < 0.02


def test_an_arc_whose_radii_are_too_small_grows_to_reach() -> None:
    assert beside_a_circle(only('<path d="M20 40A1 1 0 0 0 80 40"/>'), (50, 40), 30) < 0.02


def test_the_four_arcs_between_two_points_are_told_apart() -> None:
    tops = {}
    for flags in ("00", "01", "10", "11"):
        line = only(f'<path d="M40 40A12 12 0 {flags[0]} {flags[1]} 60 40"/>')
        tops[flags] = (round(line[:, 1].min() - 40, 1), round(line[:, 1].max() - 40, 1))
    assert tops == {"00": (0.0, 5.4), "01": (-5.4, 0.0), "10": (0.0, 18.6), "11": (-18.6, 0.0)}


def test_smooth_curves_reflect_the_last_control_point() -> None:
    whole = only('<path d="M0 0C10 20 20 20 30 0C40 -20 50 -20 60 0"/>', LINES.replace("0 0 100 80", "0 -40 100 80"))
    smooth = only('<path d="M0 0C10 20 20 20 30 0S50 -20 60 0"/>', LINES.replace("0 0 100 80", "0 -40 100 80"))
    assert smooth == pytest.approx(whole)
    assert only('<path d="M0 19Q10 39 20 19T40 19"/>') == pytest.approx(
        only('<path d="M0 19Q10 39 20 19Q30-1 40 19"/>')
    )


def test_transforms_follow_each_other_from_the_outside_in() -> None:
    body = '<g transform="translate(10 20)"><line x2="5" transform="rotate(90) scale(2)"/></g>'
    assert only(body) == pytest.approx(np.array([(10, 20), (10, 30)]))
    skewed = '<line y2="10" transform="skewX(45) matrix(1 0 0 1 3 0)"/>'
    assert only(skewed) == pytest.approx(np.array([(3, 0), (13, 10)]))


def test_what_is_used_is_drawn_where_it_is_used() -> None:
    body = """<defs><path id="p" d="M0 0h5"/><symbol id="s" viewBox="0 0 10 10"><path d="M0 0L10 10"/></symbol></defs>
    <use href="#p" x="10" y="20"/><use xlink:href="#s" x="40" y="40" width="20" height="20"/><use href="#missing"/>"""
    first, second = read(body).lines
    assert first == pytest.approx(np.array([(10, 20), (15, 20)]))
    assert second == pytest.approx(np.array([(40, 40), (60, 60)]))


@pytest.mark.parametrize(
    "hidden",
    [
        '<g display="none">{}</g>',
        '<g visibility="hidden">{}</g>',
        '<g style="opacity:0">{}</g>',
        '<g stroke="none">{}</g>',
        '<g stroke="#FFF">{}</g>',
        '<g class="a">{}</g><style>.a{{stroke:rgb(255,255,255)}}</style>',
        "<defs>{}</defs>",
        "<clipPath>{}</clipPath>",
    ],
)
def test_what_is_not_seen_on_white_paper_is_not_drawn(hidden: str) -> None:
    assert read(hidden.format('<path d="M1 1h5"/>') + '<path d="M20 20h5"/>').lines[0][0] == pytest.approx([20, 20])
    assert len(read(hidden.format('<path d="M1 1h5"/>') + '<path d="M20 20h5"/>').lines) == 1


def test_what_is_filled_alone_is_drawn_by_its_closed_outline() -> None:
    line = only('<path stroke="none" fill="red" d="M10 10h10v10"/>')
    assert line == pytest.approx(np.array([(10, 10), (20, 10), (20, 20), (10, 10)]))


def test_style_goes_before_sheet_before_attribute() -> None:
    sheet = "<style>path{stroke:none} .b{stroke:red} #c{stroke:none}</style>"
    shapes = (
        '<path stroke="red" d="M1 1h1"/><path class="b" d="M2 2h1"/><path class="b" id="c" d="M3 3h1"/>'
        '<path id="c" style="stroke:red" d="M4 4h1"/>'
    )
    assert [round(line[0, 0], 6) for line in read(sheet + shapes).lines] == [2, 4]


def test_dashes_stay_dashes() -> None:
    found = read('<path d="M10 10h10v10" stroke-dasharray="4 2"/>').lines
    assert [round(float(np.hypot(*np.diff(line, axis=0).T).sum()), 6) for line in found] == [4, 4, 4, 2]
    assert found[1] == pytest.approx(np.array([(16, 10), (20, 10)]))


def test_lines_are_cut_off_at_the_edge_of_the_page() -> None:
    found = read('<path d="M-10 40H110M50 -5V20L300 20"/>').lines
    assert [line.round(6).tolist() for line in found] == [[[0, 40], [100, 40]], [[50, 0], [50, 20], [100, 20]]]


def test_white_shapes_and_clips_are_told_of() -> None:
    found = read(
        '<rect width="100" height="80" fill="white" stroke="none"/><g clip-path="url(#a)"><path d="M1 1h1"/></g>'
    )
    assert found.warnings == ("1 white shape is left out", "clip-path is not followed: what it hides or adds is not")


BOMB = "".join(f'<!ENTITY l{k} "{f"&l{k - 1};" * 10}">' for k in range(1, 10))
USES = "".join(f'<g id="u{k}">{f"""<use href="#u{k - 1}"/>""" * 10}</g>' for k in range(1, 9))


@pytest.mark.parametrize(
    ("body", "words"),
    [
        (f'<!DOCTYPE svg [<!ENTITY l0 "lol">{BOMB}]>{HEAD}{LINES}<desc>&l9;</desc></svg>', "declares XML entities"),
        (f'<!DOCTYPE svg [<!ENTITY x SYSTEM "file:///etc/passwd">]>{HEAD}{LINES}&x;</svg>', "declares XML entities"),
        (
            f"{HEAD}{LINES}<defs><path id='u0' d='M0 0h1'/>{USES}</defs><use href='#u8'/></svg>",
            "more than 2000 elements",
        ),
        (f'{HEAD}{LINES}<g id="a"><use href="#a"/></g></svg>', "uses within each other"),
        (f"{HEAD}{LINES}<script>alert(1)</script></svg>", "holds a script"),
        (f'{HEAD}{LINES}<path d="M0 0h1" onclick="x()"/></svg>', "holds a script"),
        (f'{HEAD}{LINES}<image href="http://localhost/x.png"/></svg>', "holds a picture"),
        (f'{HEAD}{LINES}<use href="other.svg#a"/></svg>', "refers to another file"),
        (f"{HEAD}{LINES}<style>@import 'x.css';</style></svg>", "refers to another file"),
        (f'{HEAD}{LINES}<path fill="url(http://localhost/x)" d="M0 0h1"/></svg>', "refers to another file"),
        (f"{HEAD}{LINES}<text>hello</text></svg>", "holds text"),
        (f"{HEAD}{LINES}<foreignObject/></svg>", "holds a page of HTML"),
        (f"{HEAD}{LINES}<path d='M0 0h1'/>", "is no whole SVG file"),
        (f"{HEAD}{LINES}{'<g>' * 200}{'</g>' * 200}</svg>", "100 of them in each other"),
        (f"{HEAD}>" + "</svg>", "says neither its width"),
        (f'{HEAD}width="1e9mm" height="1mm"></svg>', "mm are drawn"),
        (f'{HEAD}width="-5mm" height="1mm"></svg>', "give it a size"),
        (f'{HEAD}width="fish" height="1mm"></svg>', "holds the length 'fish'"),
        (f'{HEAD}{LINES}<path d="M0 0L1e400 1"/></svg>', "beyond every sheet"),
        (f'{HEAD}{LINES}<path d="M0 0{"l1 1" * 5_001}"/></svg>', "more than 5000 pieces"),
        ("<svg", "is no whole SVG file"),
    ],
)
def test_what_cannot_or_must_not_be_read_is_refused_with_a_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, body: str, words: str
) -> None:
    monkeypatch.setattr(svg, "MOST_ELEMENTS", 2000)
    monkeypatch.setattr(svg_path, "MOST_POINTS", 5000)
    assert_refused(tmp_path / "bad.svg", body.encode(), "an SVG", words)


def test_an_svg_of_200_megabytes_is_refused_before_it_is_read(tmp_path: Path) -> None:
    with (tmp_path / "large.svg").open("wb") as file:
        file.write(b"<svg xmlns='http://www.w3.org/2000/svg'>")
        file.truncate(200_000_000)
    with pytest.raises(BadPicture, match=r"has 200000000 bytes, at most 16000000 are read: make it smaller"):
        open_picture(tmp_path / "large.svg")


def test_an_empty_svg_is_an_empty_page(tmp_path: Path) -> None:
    (tmp_path / "empty.svg").write_text(f"{HEAD}{LINES}</svg>")
    found = open_picture(tmp_path / "empty.svg")
    assert isinstance(found, VectorPage)
    assert found.drawing.strokes == ()
    assert found.page.grey.min() == 255


def test_a_line_has_its_colour_from_wherever_it_comes() -> None:
    said = (
        'stroke="#d03030"',
        'style="stroke:navy"',
        'stroke="currentColor" color="teal"',
        "",
        'stroke="none" fill="red"',
    )
    found = read("".join(f'<path {how} d="M0 {y}h9v1"/>' for y, how in enumerate(said)))
    assert found.colours == ((208, 48, 48), (0, 0, 128), (0, 128, 128), (0, 0, 0), (255, 0, 0))
