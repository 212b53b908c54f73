"""The arm's geometry: joints, places, reach."""

from __future__ import annotations

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from firmware_protocol.dobot.kinematics import (
    FARTHEST_MM,
    GUIDE,
    MARGIN_MM,
    NARROW,
    SHEET_ORIGIN_MM,
    Reach,
    forward,
    inverse,
    radii_mm,
    reaches,
)
from tests.firmware_protocol.dobot.vectors import GOLDEN

LOW, HIGH = -10.0, 10.0
HEIGHTS = st.floats(-60.0, 60.0)


@pytest.mark.parametrize("point", GOLDEN["reach"], ids=lambda point: str(point[:3]))
def test_reach_and_joints_are_those_of_an_independent_model(point: list[float]) -> None:
    x, y, z, joints = point
    assert reaches((x, y, z), GUIDE) == (joints is not None)
    if joints is not None:
        assert inverse((x, y, z)) == pytest.approx(joints, abs=1e-3)


@given(st.floats(-90, 90), st.floats(0, 85), st.floats(-10, 90))
def test_joints_lead_to_a_place_and_back(j1: float, j2: float, j3: float) -> None:
    assume(j2 - j3 < 89.9)  # beyond it the elbow is bent the other way
    place = forward((j1, j2, j3))
    assume(math.hypot(*place[:2]) > 1.0)
    back = inverse(place)
    assert back is not None
    assert forward(back) == pytest.approx(place, abs=1e-6)
    assert back == pytest.approx((j1, j2, j3), abs=1e-3)


def test_the_farthest_point_is_the_stated_one() -> None:
    assert math.hypot(*forward((0.0, 85.0, 0.0))[:2]) == pytest.approx(FARTHEST_MM)
    assert not reaches((FARTHEST_MM + 1, 0.0, 0.0), GUIDE)


@given(HEIGHTS, st.floats(0, 340))
def test_radii_tell_what_the_joints_reach(height_mm: float, radius_mm: float) -> None:
    radii = radii_mm(height_mm)
    assert radii is not None
    assume(min(abs(radius_mm - end) for end in radii) > 1e-6)
    assert reaches((radius_mm, 0.0, height_mm)) == (radii[0] < radius_mm < radii[1])


def test_heights_out_of_reach_have_no_radii() -> None:
    assert [radii_mm(height) for height in (-400.0, 400.0)] == [None, None]
    assert Reach.between(0.0, 400.0) is None


def area() -> Reach:
    reach = Reach.between(LOW, HIGH)
    assert reach is not None
    return reach


def _flat(radius_mm: float, turn_deg: float) -> tuple[float, float]:
    return radius_mm * math.cos(math.radians(turn_deg)), radius_mm * math.sin(math.radians(turn_deg))


FLAT = st.builds(_flat, st.floats(130, 315), st.floats(-90, 90))


@given(FLAT, FLAT, st.floats(0, 1), st.floats(LOW, HIGH))
def test_every_point_of_a_line_in_reach_is_in_reach_with_the_margin(
    start: tuple[float, float], end: tuple[float, float], part: float, height_mm: float
) -> None:
    assume(area().holds(start, end))
    x, y = (a + (b - a) * part for a, b in zip(start, end, strict=True))
    assert reaches((x, y, height_mm))
    outwards = 1 + (MARGIN_MM - 0.1) / math.hypot(x, y)
    inwards = 1 - (MARGIN_MM - 0.1) / math.hypot(x, y)
    assert reaches((x * outwards, y * outwards, height_mm))
    assert reaches((x * inwards, y * inwards, height_mm))


def test_a_line_through_the_hole_in_the_middle_is_out_of_reach() -> None:
    assert not area().holds((150.0, -150.0), (20.0, 190.0))
    assert area().holds((200.0, -100.0), (200.0, 100.0))


def test_nothing_lies_behind_the_arm() -> None:
    assert not area().holds((-50.0, 200.0), (0.0, 200.0))


@given(st.floats(0.3, 3.0))
def test_the_largest_box_is_in_reach_and_a_larger_one_is_not(proportion: float) -> None:
    width_mm, height_mm = area().largest_box_mm(SHEET_ORIGIN_MM, proportion)
    assert width_mm / height_mm == pytest.approx(proportion)
    assert area().holds_box(SHEET_ORIGIN_MM, width_mm, height_mm)
    assert not area().holds_box(SHEET_ORIGIN_MM, width_mm + 0.1, height_mm + 0.1)


def test_the_usual_place_of_the_sheet_takes_a_hundred_millimetres_square_and_the_base_none() -> None:
    assert area().holds_box(SHEET_ORIGIN_MM, 100.0, 100.0)
    assert area().largest_box_mm((25.0, 25.0), 1.0) == (0.0, 0.0)


def test_the_narrow_limits_are_within_the_guides() -> None:
    for narrow, guide in zip((NARROW.j1, NARROW.j2, NARROW.j3), (GUIDE.j1, GUIDE.j2, GUIDE.j3), strict=True):
        assert guide[0] <= narrow[0] < narrow[1] <= guide[1]
