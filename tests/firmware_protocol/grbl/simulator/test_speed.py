"""Lines a second that the simulated controller takes from a sender that loses no time, in simulated seconds."""

from __future__ import annotations

from math import cos, sin

from tests.firmware_protocol.grbl.bench import BRISK, talk

QUICK = BRISK | dict.fromkeys((100, 101, 102), 40) | dict.fromkeys((110, 111, 112), 30000)
QUICK |= dict.fromkeys((120, 121, 122), 5000)
LINES = [f"G1X{12 + 8 * cos(step / 160):.3f}Y{12 + 8 * sin(step / 160):.3f}" for step in range(500)]


def rate(*, check: bool, window: int = 128) -> float:
    conversation = talk(settings=QUICK)
    conversation.ask("$C\n" if check else "G90\n")
    conversation.ask(f"F30000{LINES[0]}\n", within_s=1.0)
    began_s = conversation.now
    assert set(conversation.stream(LINES, window)) == {"ok"}
    assert conversation.sim.overflows == 0
    return len(LINES) / (conversation.now - began_s)


def test_with_motion_the_planner_is_the_limit_as_on_a_real_328p() -> None:
    assert 390 <= rate(check=False) <= 415


def test_in_check_mode_the_wire_is_the_limit() -> None:
    wire = 11520 / (sum(len(line) + 1 for line in LINES) / len(LINES))
    assert 0.98 * wire <= rate(check=True) <= wire


def test_waiting_for_each_answer_halves_the_rate() -> None:
    assert 180 <= rate(check=False, window=1 + max(map(len, LINES))) <= 260
