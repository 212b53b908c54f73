"""What a controller has said of itself."""

from __future__ import annotations

import pytest

from firmware_protocol.grbl.controller import Controller
from firmware_protocol.grbl.replies import StatusReport, parse


def told(*lines: str) -> Controller:
    controller = Controller()
    for line in lines:
        controller.learn(parse(line))
    return controller


def position_mm(controller: Controller, line: str) -> tuple[float, float, float] | None:
    report = parse(line)
    assert isinstance(report, StatusReport)
    controller.learn(report)
    return controller.position_mm(report)


def test_version_and_buffers_are_those_of_the_build() -> None:
    controller = told("Grbl 1.1h ['$' for help]", "[VER:1.1h.20190825:]", "[OPT:V,35,1024]", "$110=500.000")
    assert (controller.firmware, controller.planner_blocks, controller.buffer_bytes, controller.settings) == (
        "Grbl 1.1h.20190825",
        35,
        1024,
        {110: 500.0},
    )


@pytest.mark.parametrize(("banner", "outdated"), [("Grbl 0.9j ['$' for help]", True), ("Grbl 1.1f", False)])
def test_grbl_0_is_outdated(banner: str, outdated: bool) -> None:
    assert told(banner).outdated is outdated


def test_a_banner_unlocks_until_the_message_behind_it() -> None:
    assert told("[MSG:'$H'|'$X' to unlock]").locked
    assert not told("[MSG:'$H'|'$X' to unlock]", "Grbl 1.1h").locked
    assert not told("<Alarm>", "<Idle>").locked


def test_the_last_offset_counts_until_the_next() -> None:
    controller = Controller()
    assert position_mm(controller, "<Run|MPos:5.000,6.000,7.000|WCO:1.000,2.000,3.000>") == (4.0, 4.0, 4.0)
    assert position_mm(controller, "<Run|MPos:6.000,6.000,7.000>") == (5.0, 4.0, 4.0)
    assert position_mm(controller, "<Run|WPos:9.000,6.000,7.000>") == (9.0, 6.0, 7.0)
    assert position_mm(controller, "<Run>") is None


def test_reports_in_inches_become_mm() -> None:
    assert position_mm(told("$13=1"), "<Run|WPos:1.0000,0.5000,0.0000>") == pytest.approx((25.4, 12.7, 0.0))
