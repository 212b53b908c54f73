"""Lines a second that the simulated controller takes from a sender that loses no time, in simulated seconds."""

from __future__ import annotations

from math import cos, sin

import pytest

from firmware_protocol.grbl.simulator.lookahead import BLOCKS
from firmware_protocol.grbl.simulator.stepper import PREPARED_BLOCKS
from tests.firmware_protocol.grbl.bench import BRISK, Talk

QUICK = BRISK | dict.fromkeys((100, 101, 102), 40) | dict.fromkeys((110, 111, 112), 30000)
QUICK |= dict.fromkeys((120, 121, 122), 5000)
LINES = [f"G1X{15 + 8 * cos(step / 160):.3f}Y{15 + 8 * sin(step / 160):.3f}" for step in range(500)]


class Poller(Talk):
    """A sender that asks for the state so often, besides sending lines."""

    every_s = float("inf")
    next_s = float("inf")

    def _hear(self, now: float) -> None:
        if now >= self.next_s:
            self.send("?")
            self.next_s = now + self.every_s
        super()._hear(now)


def rate(*, check: bool, window: int = 128, polls_hz: float = 0.0) -> float:
    conversation = Poller(settings=QUICK)
    conversation.wait(2.0)
    conversation.ask("$C\n" if check else "G90\n")
    conversation.ask(f"F30000{LINES[0]}\n", within_s=1.0)
    began_s = conversation.now
    if polls_hz:
        conversation.every_s, conversation.next_s = 1 / polls_hz, began_s
    said = conversation.stream(LINES, window)
    assert {line for line in said if not line.startswith("<")} == {"ok"}
    assert conversation.sim.overflows == 0
    return len(LINES) / (conversation.now - began_s)


def test_with_motion_the_planner_is_the_limit_as_on_a_real_328p() -> None:
    assert 390 <= rate(check=False) <= 415


def test_in_check_mode_its_parser_is_the_limit_a_little_below_the_wire() -> None:
    assert 612 <= rate(check=True) <= 640


def test_waiting_for_each_answer_costs_about_half_of_the_rate() -> None:
    window = 1 + max(map(len, LINES))
    assert 203 <= rate(check=False, window=window) <= 244
    assert 243 <= rate(check=True, window=window) <= 300


@pytest.mark.parametrize(("polls_hz", "least", "most"), [(10, 0.96, 1.0), (100, 0.85, 0.93)])
def test_asking_for_the_state_costs_as_many_lines_as_on_a_real_one(polls_hz: float, least: float, most: float) -> None:
    assert least <= rate(check=False, polls_hz=polls_hz) / rate(check=False) <= most


def test_the_pen_is_never_more_blocks_behind_than_the_planner_and_the_segments_hold() -> None:
    """Reports and answers come in one order, so of lines of 3 ms no more may lie between them."""
    conversation = Poller(settings=QUICK)
    conversation.wait(2.0)
    conversation.ask("$10=0\n")  # work coordinates
    lines = [f"G1 X{0.1 * number:.3f}" for number in range(1, 600)]
    conversation.ask("F3000 G1 X0\n", within_s=1.0)
    conversation.every_s = conversation.next_s = 0.02
    conversation.next_s += conversation.now
    answered, behind = 0, []
    for line in conversation.stream(lines, 128):
        answered += line == "ok"
        if line.startswith("<Run"):
            behind.append(answered - round(float(line.split("WPos:")[1].split(",")[0]) / 0.1 - 0.5))
    assert len(behind) > 20
    assert BLOCKS < max(behind) <= BLOCKS + PREPARED_BLOCKS
