"""Motion in time: against trapezoids computed by hand and times measured on the real firmware."""

from __future__ import annotations

from itertools import pairwise
from math import sqrt

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from firmware_protocol.gcode import GcodeError
from firmware_protocol.grbl.simulator.lookahead import BLOCKS, Lookahead, Move
from firmware_protocol.grbl.simulator.planner import line_ends, line_times_s
from firmware_protocol.grbl.simulator.settings import Settings

BRISK = {1: 255, 110: 3000, 111: 3000, 112: 3000, 120: 200, 121: 200, 122: 200}


def test_a_long_move_is_a_trapezoid() -> None:
    # 20 mm/s after 0.1 s and 1 mm, the same at the end, 28 mm between at 20 mm/s.
    assert line_times_s(["G1 X30 F1200"], BRISK) == pytest.approx([0.1 + 28 / 20 + 0.1])


def test_a_short_move_is_a_triangle() -> None:
    assert line_times_s(["G1 X1 F3000"], BRISK) == pytest.approx([2 * sqrt(1 / 200)])


def test_a_rapid_move_is_limited_by_the_axis_that_is_slowest() -> None:
    slow_y = {**BRISK, 111: 600, 121: 1e9, 120: 1e9}
    assert line_times_s(["G0 X30 Y40"], slow_y) == pytest.approx([4.0], abs=0.001)


def test_a_straight_line_in_two_moves_takes_as_long_as_in_one() -> None:
    assert line_times_s(["G1 X15 F1200", "X30"], BRISK)[-1] == pytest.approx(line_times_s(["G1 X30 F1200"], BRISK)[0])


def test_the_pen_turns_a_square_corner_at_the_speed_of_the_junction_deviation() -> None:
    half_sine = sqrt(0.5)
    corner_mm_s = sqrt(sqrt(2) * 200 * 0.01 * half_sine / (1 - half_sine))
    # Each of the two moves: 25 mm/s at the far end's rest, corner speed at the near end.
    ramps_s = 25 / 200 + (25 - corner_mm_s) / 200
    ramps_mm = 25**2 / 400 + (25**2 - corner_mm_s**2) / 400
    assert line_times_s(["G1 X10 F1500", "Y10"], BRISK)[-1] == pytest.approx(2 * (ramps_s + (10 - ramps_mm) / 25))


def test_turning_back_needs_a_full_stop() -> None:
    there = line_times_s(["G1 X10 F1500"], BRISK)[0]
    assert line_times_s(["G1 X10 F1500", "X0"], BRISK)[-1] == pytest.approx(2 * there)


def test_fifteen_blocks_of_look_ahead_limit_the_speed_on_short_moves() -> None:
    lines = ["G91", "G1 X0.04 F3000", *["X0.04"] * 400]
    # Never faster than what 15 blocks of 0.04 mm allow for stopping.
    assert line_times_s(lines, BRISK)[-1] > 401 * 0.04 / sqrt(2 * 200 * BLOCKS * 0.04)


@pytest.mark.parametrize(
    ("lines", "measured_s"),
    [
        (["G2X0Y0I10J0F2000", "G4P0.01"], 2.15),
        (["G91", *["G1X-0.048Y0.048F3000", "G1X0.1Y0.048F3000"] * 75, "G4P0.01"], 4.1),
        (["G1X12F1200", "G4P0.01"], 0.75),
        (["G93 G1 X5 F120", "X10 F60", "G94 X11 F900", "G4P0.01"], 1.7),
    ],
)
def test_the_times_are_those_of_the_real_firmware(lines: list[str], measured_s: float) -> None:
    assert line_times_s(lines, BRISK)[-1] == pytest.approx(measured_s, rel=0.04)


def test_a_dwell_takes_whole_steps_of_50_ms_after_the_motion() -> None:
    ends = line_times_s(["G1 X30 F1200", "G4 P0.01", "G4 P0.12"], BRISK)
    assert [ends[1] - ends[0], ends[2] - ends[1]] == pytest.approx([0.05, 0.15])


def test_lines_without_motion_end_with_the_line_before_them() -> None:
    ends = line_ends(["G1 X3 F1200", "F600", "(nothing)", "Y1"], BRISK)
    assert ends[0] == ends[1] == ends[2]
    assert ends[3].position_mm == (3.0, 1.0, 0.0)


def test_the_position_is_a_whole_number_of_steps() -> None:
    assert line_ends(["G0 X0.0061"], BRISK)[0].position_mm == (0.008, 0.0, 0.0)


def test_an_arc_ends_where_it_says_and_is_as_long_as_its_chords() -> None:
    (end,) = line_ends(["G2 X0 Y0 I10 J0 F600"], BRISK)
    assert end.position_mm == (0.0, 0.0, 0.0)
    assert end.time_s == pytest.approx(62.8 / 10, rel=0.01)


def test_a_line_that_grbl_refuses_is_refused() -> None:
    with pytest.raises(GcodeError, match="error:22"):
        line_times_s(["G1 X1"])


def test_an_unknown_setting_is_named() -> None:
    with pytest.raises(ValueError, match=r"no setting \$99"):
        line_times_s([], {99: 1})


PLACES = st.tuples(st.integers(0, 60), st.integers(0, 60))


@settings(max_examples=50, deadline=None)
@given(st.lists(PLACES, min_size=1, max_size=40))
def test_no_plan_asks_for_more_than_the_acceleration_between_two_corners(places: list[tuple[int, int]]) -> None:
    lookahead = Lookahead(Settings(BRISK))
    for x, y in places:
        if not lookahead.full:
            lookahead.add(Move((x, y, 0.0), 3000))
    blocks = list(lookahead.blocks)
    for block, following in pairwise(blocks):
        change = 2 * block.acceleration_mm_s2 * block.length_mm
        assert abs(following.entry_sqr - block.entry_sqr) <= change + 1e-6
        assert following.entry_sqr <= following.max_entry_sqr + 1e-9


@settings(max_examples=50, deadline=None)
@given(st.lists(PLACES, min_size=1, max_size=60))
def test_time_never_goes_back_and_is_never_shorter_than_the_feed_allows(places: list[tuple[int, int]]) -> None:
    ends = line_ends([f"G1 X{x} Y{y} F1500" for x, y in places], BRISK)
    here, earliest_s, before_s = (0.0, 0.0), 0.0, 0.0
    for (x, y), end in zip(places, ends, strict=True):
        earliest_s += sqrt((x - here[0]) ** 2 + (y - here[1]) ** 2) / 25
        here = (x, y)
        assert end.time_s >= max(before_s, earliest_s) - 1e-6
        assert end.position_mm[:2] == here
        before_s = end.time_s
