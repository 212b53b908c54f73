"""The simulated controller and lines: answers, the ring of 128 bytes, the 15 blocks, `$` commands, errors."""

from __future__ import annotations

import pytest

from tests.firmware_protocol.grbl.bench import BRISK, Talk, talk


def test_opening_the_port_gives_the_banner_and_position_zero() -> None:
    conversation = Talk()
    assert conversation.wait(0.1) == ["", "Grbl 1.1h ['$' for help]"]
    conversation.ask("G0X5\n", within_s=1.0)
    conversation.sim.open(conversation.now)
    assert conversation.wait(0.1) == ["", "Grbl 1.1h ['$' for help]"]
    assert conversation.ask("?") == ["<Idle|MPos:0.000,0.000,0.000|FS:0,0|WCO:0.000,0.000,0.000>"]
    assert conversation.sim.position_mm == (5.0, 0.0, 0.0)


def test_a_deaf_boot_loader_loses_what_is_sent_to_it() -> None:
    conversation = Talk(boot_s=1.5)
    conversation.send("G0X1\n")
    assert conversation.wait(1.4) == []
    assert conversation.wait(0.2) == ["", "Grbl 1.1h ['$' for help]"]
    assert conversation.sim.lost_bytes == 5


def test_carriage_return_and_line_feed_are_two_lines() -> None:
    assert talk().ask("G0\r\n") == ["ok", "ok"]


def test_the_wire_carries_11520_bytes_a_second_in_both_directions() -> None:
    conversation = talk()
    conversation.send("$I=" + "a" * 112 + "\n")
    conversation.settle()
    # 116 bytes there, 4 back, and the chip's work between.
    assert conversation.time_of("error:11") >= 2.0 + (116 + 10) / 11520


def test_fifteen_lines_are_answered_at_once_and_the_sixteenth_when_a_block_is_free() -> None:
    conversation = talk()
    lines = "".join(f"G1X{10 + n}F1500\n" for n in range(17))
    assert conversation.ask(lines, within_s=0.3) == ["ok"] * 15
    conversation.settle()
    assert conversation.time_of("ok", 15) == pytest.approx(2.45, abs=0.05)
    assert len(conversation.heard) == 17


def test_the_ring_takes_128_bytes_behind_a_full_planner_and_drops_the_129th_silently() -> None:
    conversation = talk(settings={**BRISK, 10: 3})
    conversation.ask("".join(f"G1X{50 + n}F900\n" for n in range(16)), within_s=0.3)
    conversation.ask("\n" * 128)
    assert conversation.sim.overflows == 0
    assert "|Bf:0,0|" in conversation.ask("?")[0]
    conversation.ask("\n")
    assert conversation.sim.overflows == 1
    assert conversation.settle().count("ok") == 1 + 128


def test_a_stream_by_character_counting_loses_nothing() -> None:
    conversation = talk()
    lines = ["G91", *["G1X0.1Y0.05F3000", "G1X0.1Y-0.05F3000"] * 100]
    assert conversation.stream(lines) == ["ok"] * len(lines)
    conversation.settle()
    assert (conversation.sim.overflows, conversation.sim.position_mm) == (0, pytest.approx((20.0, 0.0, 0.0)))


def test_a_refused_line_is_dropped_and_the_lines_around_it_are_executed() -> None:
    conversation = talk()
    assert conversation.ask("G91\nG1X1F1500\nG1X1Q5\nG1X1\n", within_s=2.0) == ["ok", "ok", "error:20", "ok"]
    assert conversation.sim.position_mm == (2.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("line", "code"),
    [
        ("G1 X1", 22), ("G0 G1 X1", 24), ("G90 G91", 21), ("G17.1", 23), ("G59.1", 23), ("G61.1", 20), ("M6", 20),
        ("G0 X1 X2", 25), ("G10 L2 P1", 26), ("N10000001", 27), ("G4", 28), ("G10 L2 P7 X1", 29), ("G53 X1 G80", 30),
        ("G80 X1", 31), ("G2 Z1 I1 F5", 32), ("G2 X2 Y0 I2 J0 F5", 33), ("G3 X50 R5 F5", 34), ("G2 X5 F5", 35),
        ("G0 X1 P1", 36), ("G43.1 X1", 37), ("T256", 38), ("F-1", 4), ("$H", 5), ("$0=2", 6), ("$20=1", 10),
        ("$99=1", 3), ("$foo", 2), ("$J=G2X1I1F100", 33), ("$J=G91X1F100M3", 16), ("$J=G91X1", 22), ("$100=5x", 3),
    ],
)  # fmt: skip
def test_each_fault_has_its_code(line: str, code: int) -> None:
    assert talk().ask(line + "\n") == [f"error:{code}"]


def test_g_codes_wait_in_alarm_until_the_machine_is_unlocked() -> None:
    conversation = talk(settings={**BRISK, 22: 1})
    assert conversation.ask("G0X-1\n$X\nG0X-1\n") == ["error:9", "[MSG:Caution: Unlocked]", "ok", "ok"]


def test_settings_are_listed_as_they_were_written() -> None:
    conversation = talk()
    assert conversation.ask("$110=1234.5\n") == ["ok"]
    listing = conversation.ask("$$\n")
    assert len(listing) == 35
    assert "$110=1234.500" in listing


def test_a_changed_setting_loses_the_bytes_behind_it_and_an_unchanged_one_does_not() -> None:
    conversation = talk()
    assert conversation.ask("$130=200.000\n" + "F100\n" * 20) == ["ok"] * 21
    assert conversation.sim.lost_bytes == 0
    answers = conversation.ask("$130=123.456\n" + "F100\n" * 20)
    assert len(answers) < 21
    assert conversation.sim.lost_bytes > 50


def test_check_mode_answers_without_moving_and_ends_in_a_reset() -> None:
    conversation = talk()
    assert conversation.ask("$C\nG1X9F100\nG4P5\nM0\nG5\n") == ["[MSG:Enabled]", "ok", "ok", "ok", "ok", "error:20"]
    assert conversation.ask("$C\n") == ["[MSG:Disabled]", "ok", "", "Grbl 1.1h ['$' for help]"]
    assert conversation.sim.position_mm == (0.0, 0.0, 0.0)


def test_startup_lines_run_behind_each_banner() -> None:
    conversation = talk()
    conversation.ask("$N0=G91G0X1\n", within_s=1.0)
    assert conversation.ask("\x18", within_s=1.0)[-1] == ">G91G0X1:ok"
    assert conversation.sim.position_mm == (2.0, 0.0, 0.0)


def test_offsets_are_kept_through_a_reset_and_g92_is_not() -> None:
    conversation = talk()
    conversation.ask("G10L2P1X3\nG92Y5\n")
    conversation.ask("\x18")
    assert {"[G54:3.000,0.000,0.000]", "[G92:0.000,0.000,0.000]"} <= set(conversation.ask("$#\n"))


def test_a_number_beyond_the_chips_largest_is_kept_as_that() -> None:
    """Forty digits: the chip's floats end at 3.4e38, and its memory holds no more."""
    conversation = talk()
    assert conversation.ask("G10L2P1X" + "5" * 40 + "\n") == ["ok"]
    assert conversation.ask("?")[0].startswith("<")


def test_a_jog_moves_and_leaves_the_modal_state_alone() -> None:
    conversation = talk()
    assert conversation.ask("$J=G91G20X0.1F50\n", within_s=1.0) == ["ok"]
    assert conversation.sim.position_mm == pytest.approx((2.54, 0.0, 0.0), abs=0.004)
    assert conversation.ask("$G\n")[0] == "[GC:G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0]"


def test_homing_ends_a_pull_off_from_the_switches() -> None:
    homed = talk(settings={**BRISK, 22: 1, 24: 300, 25: 2000}, switches_mm=(3.0, 4.0, 2.0))
    assert homed.ask("$H\n", within_s=10.0) == ["ok"]
    assert "MPos:-1.000,-1.000,-1.000" in homed.ask("?")[0]
    assert homed.sim.position_mm == pytest.approx((2.0, 3.0, 1.0))
    lost = talk(settings={**BRISK, 22: 1, 130: 3, 131: 3, 132: 3})
    assert lost.ask("$H\n", within_s=3.0)[0] == "ALARM:9"
