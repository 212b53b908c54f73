"""The lines that bring a controller back to where a program was cut."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from firmware_protocol.grbl.path import Modal, Path, Spot
from firmware_protocol.grbl.rest import Part, from_line, from_spot

STEPS = (250.0, 250.0, 250.0)
HEAD = ("G21 G90", "G0 Z5")
STROKE = ("G0 X0.000 Y0.000", "G1 Z0 F600", "G1 X10.000 Y0.000 F1500", "X10.000 Y10.000", "G0 Z5")
NEXT = ("G0 X20 Y0", "G1 Z0 F600", "G1 X30 F1500", "G0 Z5")
LIFTED = Modal(place=(7.0, 7.0, 5.0))


def program(*strokes: Sequence[str], head: Sequence[str] = HEAD) -> tuple[list[Part], Path]:
    parts = [Part(text) for text in head]
    parts += [Part(text, stroke) for stroke, texts in enumerate(strokes) for text in texts]
    parts = [part._replace(number=number) for number, part in enumerate(parts)]
    return parts, Path([part.text for part in parts], Modal(place=(0.0, 0.0, 0.0)), steps_mm=STEPS)


def left(line: int, part: float, *strokes: Sequence[str]) -> list[str]:
    return [each.text for each in from_spot(*program(*strokes), Spot(line, part), lifted=LIFTED)]


def test_ink_begins_a_little_before_the_cut_and_the_pen_is_lowered_as_the_stroke_did_it() -> None:
    assert left(4, 0.5, STROKE) == [
        "G21 G90",
        "G0 X4.7 Y0",
        "G1 Z0 F600",
        "G21 G90",
        "G1 X10 Y0 F1500",
        "G1X10.000Y10.000",
        "G0 Z5",
    ]


def test_just_behind_a_corner_it_begins_before_the_corner() -> None:
    assert left(5, 0.01, STROKE)[1] == "G0 X9.8 Y0"


def test_it_begins_no_earlier_than_the_stroke() -> None:
    assert left(4, 0.01, STROKE)[1] == "G0 X0 Y0"


def test_a_cut_before_the_ink_begins_with_the_stroke_and_one_behind_it_with_the_next() -> None:
    assert left(3, 0.5, STROKE)[-5:] == list(STROKE)
    assert left(6, 0.5, STROKE, NEXT)[-4:] == list(NEXT)
    assert left(6, 0.5, STROKE) == []


def test_a_stroke_that_goes_down_along_its_way_begins_anew() -> None:
    assert left(3, 0.5, ("G0 X5 Y5", "G1 X10 Z0 F600", "X20", "G0 Z5"))[-4:] == [
        "G0 X5 Y5",
        "G1 X10 Z0 F600",
        "X20",
        "G0 Z5",
    ]


def test_the_rest_of_an_arc_keeps_its_centre() -> None:
    arc = ("G0 X0 Y0", "G1 Z0 F600", "G2 X10 Y0 I5 J0 F900", "G0 Z5")
    lines = left(4, 0.52, arc)
    travel, rest = ({word[0]: float(word[1:]) for word in lines[index].split()} for index in (1, -2))
    assert (rest["G"], rest["X"], rest["Y"]) == (2, 10, 0)
    assert (travel["X"] + rest["I"], travel["Y"] + rest["J"]) == pytest.approx((5.0, 0.0), abs=0.002)


def test_what_a_line_relied_on_is_said_again() -> None:
    parts, path = program(("G0 X1", "M3 S90", "G20 G91 G1 X1 F10", "X1", "Y1"), head=("G21 G90", "M3 S30"))
    lines = [part.text for part in from_line(parts, path, 5, lifted=Modal(place=(1.0, 0.0, 5.0)))]
    assert lines == ["G21 G90", "G0 X26.4 Y0", "M3 S90", "G0 Z0", "F254", "G20 G91", "G1X1", "Y1"]


def test_lines_keep_their_numbers_and_strokes_and_added_ones_have_none() -> None:
    parts = from_spot(*program(STROKE, NEXT), Spot(4, 0.5), lifted=LIFTED)
    assert [part.number for part in parts] == [None, None, None, None, 4, 5, 6, 7, 8, 9, 10]
    assert [part.stroke for part in parts] == [0] * 7 + [1] * 4
