"""The time model: length by speed, a stop at each bend, and nothing for what does not move."""

from __future__ import annotations

import pytest

from firmware_protocol.emco.blocks import Alarm
from firmware_protocol.emco.simulator.interpreter import Move
from firmware_protocol.emco.simulator.motion import Clock, line_times_s
from tests.firmware_protocol.emco.bench import program


def test_a_move_from_rest_to_rest_takes_its_length_and_one_ramp() -> None:
    assert Clock(acceleration_mm_s2=100).seconds(Move((0, 0, 0), (100, 0, 0), 20)) == pytest.approx(5 + 0.2)


def test_a_move_that_is_too_short_for_its_speed_is_a_triangle() -> None:
    assert Clock(acceleration_mm_s2=100).seconds(Move((0, 0, 0), (1, 0, 0), 20)) == pytest.approx(0.2)


def test_a_path_that_runs_straight_on_stops_only_once() -> None:
    clock = Clock(acceleration_mm_s2=100)
    clock.seconds(Move((0, 0, 0), (10, 0, 0), 20))
    assert clock.seconds(Move((10, 0, 0), (20, 0, 0), 20)) == pytest.approx(0.5)
    assert clock.seconds(Move((20, 0, 0), (20, 10, 0), 20)) == pytest.approx(0.7)


def test_each_line_has_its_time_and_time_never_falls() -> None:
    texts = [line.text for line in program()]
    times = line_times_s(texts)
    assert len(times) == len(texts)
    assert times == sorted(times)
    # Six strokes of 10 mm at 10 mm/s, and six plunges of 5 mm at 10 mm/s.
    assert 6 * 1.5 < times[-1] < 6 * 1.5 + 6


def test_a_program_for_another_controller_has_no_times() -> None:
    with pytest.raises(Alarm):
        line_times_s(["G21 G90", "G1 X1"])
