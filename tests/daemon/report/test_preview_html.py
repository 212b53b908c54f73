"""preview.html: what it shows, and that it neither asks anybody for anything nor lets a name speak."""

from __future__ import annotations

import base64
import hashlib
import re

import cv2
import numpy as np
import pytest

from daemon.report.preview_html import PenLook, Told, preview_html
from daemon.shapes import Stroke, Toolpath

FROM_PX = np.array([[0.5, 0.0, 10.0], [0.0, -0.5, 60.0]])
STROKES = (
    Stroke(np.array([[10.0, 20.0], [40.0, 20.0], [40.0, 50.0]])),
    Stroke(np.array([[25.0, 35.0]])),
    Stroke(np.array([[12.0, 50.0], [20.0, 30.0]]), pen=1),
)
UNDERSTOOD = [np.array([[0.0, 80.0], [60.0, 80.0]]), np.array([[30.0, 50.0]]), np.array([[4.0, 20.0], [20.0, 60.0]])]
PENS = (PenLook("black", "#101010"), PenLook("red", "#d01010"))


def page(*, told: Told | None = None, strokes: tuple[Stroke, ...] = STROKES) -> str:
    toolpath = Toolpath(strokes, FROM_PX, (0.0, 0.0), (5.0, 5.0))
    given = np.full((100, 80), 255, np.uint8)
    given[40:60, 20:60] = 0
    told = told or Told("house.png", "plotter", 12.0, [(1.0, 4.0), (5.0, 5.5), (7.0, 10.0)], pens=PENS)
    return preview_html(given, UNDERSTOOD, toolpath, box_mm=(40.0, 40.0), box_origin_mm=(10.0, 15.0), told=told)


def group(html: str, name: str) -> list[str]:
    """The `d` of the paths in the group of this id."""
    (found,) = re.findall(rf'<g id="{name}".*?</g>', html, re.DOTALL)
    return re.findall(r' d="([^"]*)"', found)


def test_every_stroke_is_shown_on_the_picture_and_on_the_sheet_and_every_way_to_it() -> None:
    html = page()
    assert group(html, "understood") == [
        "M0.00 80.00L60.00 80.00",
        "M30.00 50.00L30.00 50.00",
        "M4.00 20.00L20.00 60.00",
    ]
    # The sheet begins 4 mm left of the start and 4 mm above the box.
    assert group(html, "strokes")[0] == "M14.00 39.00L44.00 39.00 44.00 9.00"
    assert len(group(html, "ways")) == 4


def test_the_way_to_another_pen_leads_by_the_park_place() -> None:
    assert group(page(), "ways")[2] == "M29.00 24.00L9.00 54.00 16.00 9.00"


def test_moments_are_those_of_the_time_model() -> None:
    html = page()
    assert 'data-times="1.000 4.000 5.000 5.500 7.000 10.000"' in html
    assert 'data-end="12.000"' in html


def test_lengths_stand_for_moments_where_nobody_knows_them() -> None:
    html = page(told=Told("house.png", "plotter", pens=PENS))
    times = [float(t) for t in re.findall(r'data-times="([^"]*)"', html)[0].split()]
    assert times == sorted(times)
    assert len(times) == 2 * len(STROKES)
    assert "<dd>not known</dd>" in html


def test_size_lifts_and_lengths_are_written() -> None:
    facts = dict(re.findall(r"<dt>([^<]*)</dt><dd>([^<]*)</dd>", page()))
    assert facts == {
        "time": "12 s",
        "size on the sheet": "30.0 × 30.0 mm",
        "lower left at": "10.0, 20.0 mm",
        "pen lifts": "3",
        "drawn": "82 mm",
        "travelled": "154 mm",
    }


def test_a_picture_is_shown_as_it_was_given() -> None:
    data = re.findall(r'href="data:image/jpeg;base64,([^"]*)"', page())[0]
    shown = cv2.imdecode(np.frombuffer(base64.b64decode(data), np.uint8), cv2.IMREAD_GRAYSCALE)
    assert shown.shape == (100, 80)
    assert shown[50, 40] < 20
    assert shown[10, 10] > 235


def test_a_page_asks_nobody_for_anything() -> None:
    html = page()
    (policy,) = re.findall(r'Content-Security-Policy" content="([^"]*)"', html)
    assert policy.startswith("default-src 'none'; img-src data:; ")
    for tag, kind in (("style", "style-src"), ("script", "script-src")):
        (text,) = re.findall(rf"<{tag}>(.*?)</{tag}>", html, re.DOTALL)
        digest = base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
        assert f"{kind} 'sha256-{digest}'" in policy
    assert not re.findall(r'(?:src|href|action)="(?!data:)', html)
    assert "http:" not in html
    assert "https:" not in html


@pytest.mark.parametrize("evil", ["<script>alert(1)</script>.png", '"><img src=x onerror=alert(1)>.png'])
def test_names_and_warnings_are_words_and_never_markup(evil: str) -> None:
    html = page(told=Told(evil, evil, 1.0, warnings=[evil], steps=[evil], approve=evil, pens=PENS))
    assert evil not in html
    assert html.count("<script>") == 1
    assert "<img" not in html


def test_warnings_steps_the_order_to_approve_and_the_pens_are_told() -> None:
    told = Told("a.png", "left", 1.0, (), ["too small"], ["light evened out"], "linedrawd approve 12", PENS)
    html = page(told=told)
    for words in ("too small", "light evened out", "linedrawd approve 12", "as left will draw it"):
        assert words in html
    assert html.index("black</td><td>2 strokes") < html.index("red</td><td>1 stroke<")
    assert "Look twice" not in page()
