"""A simulated control by the options of a URL."""

from __future__ import annotations

import pytest

from firmware_protocol.emco.dialects import FANUC
from firmware_protocol.emco.line_format import FORMATS
from firmware_protocol.emco.simulator.faults import AlarmInBlock, Stall, Unplug
from firmware_protocol.emco.simulator.setup import setup_from
from firmware_protocol.emco.simulator.simulator import simulator_from
from firmware_protocol.ink import PenRule


def test_options_become_the_setup() -> None:
    setup, faults, pen = setup_from(
        {
            "dialect": "fanuc", "baud": "4800", "format": "7E2", "buffer": "512", "link": "blocks", "ack": "ok",
            "nak": "18", "after_xoff": "10", "origin": "10:20:30", "repeat_xon_s": "never", "alarm_block": "40",
            "stall": "2.5", "unplug": "9", "pen_z": "0.5", "speed": "10",
        }
    )  # fmt: skip
    assert (setup.dialect, setup.baud, setup.line, setup.buffer_bytes) == (FANUC, 4800, FORMATS["7E2"], 512)
    assert (setup.link, setup.ack, setup.nak, setup.after_xoff) == ("blocks", b"ok", b"\x18", 10)
    assert (setup.origin_mm, setup.repeat_xon_s) == ((10, 20, 30), None)
    assert faults == (AlarmInBlock(40), Stall(2.5), Unplug(9))
    assert pen == PenRule(down_at_mm=0.5)


@pytest.mark.parametrize(
    "options",
    [
        {"bufer": "512"},
        {"buffer": "128"},
        {"buffer": "2048"},
        {"baud": "fast"},
        {"baud": "0"},
        {"dialect": "heidenhain"},
        {"format": "8E1"},
        {"link": "tape"},
        {"origin": "1:2"},
        {"accel": "nan"},
        {"repeat_xon_s": "0"},
        {"stall": "soon"},
    ],
)
def test_an_option_that_makes_no_sense_is_refused(options: dict[str, str]) -> None:
    with pytest.raises(ValueError):  # noqa: PT011 - any sentence, some are Python's own
        simulator_from(options)


def test_the_pen_of_the_settings_is_taken_where_the_options_say_none() -> None:
    simulator = simulator_from({}, pen=PenRule(down_at_mm=2.0))
    simulator.open(0.0)
    simulator.receive(b"%\nO0001\nG90 G21\nG0 Z2.0\nG0 X5.0\nM30\n%\n", 0.0)
    simulator.advance(20.0)
    assert simulator.ink == [[(0, 0), (5, 0)]]
