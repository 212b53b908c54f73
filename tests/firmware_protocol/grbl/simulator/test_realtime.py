"""The simulated controller and real-time bytes: reports, holds, overrides, resets, alarms."""

from __future__ import annotations

import pytest

from tests.firmware_protocol.grbl.bench import BRISK, talk

BANNER = ["", "Grbl 1.1h ['$' for help]"]
UNLOCK = "[MSG:'$H'|'$X' to unlock]"


def test_wco_comes_in_the_first_of_ten_reports_and_the_overrides_in_the_second() -> None:
    conversation = talk()
    reports = [conversation.ask("?")[0] for _ in range(12)]
    assert [n for n, report in enumerate(reports) if "WCO" in report] == [0, 10]
    assert [n for n, report in enumerate(reports) if "Ov" in report] == [1, 11]


def test_several_questions_before_a_report_get_one_answer() -> None:
    assert len(talk().ask("???")) < 3


def test_a_question_in_the_middle_of_a_line_leaves_the_line_whole() -> None:
    conversation = talk()
    assert conversation.ask("G1X1F9?00\n", within_s=1.0)[-1] == "ok"
    assert "F900" in conversation.ask("$G\n")[0]


def test_a_move_ends_when_the_trapezoid_says() -> None:
    conversation = talk()
    conversation.send("G1X30F1200\nG4P0\n")
    conversation.settle()
    # 28 mm at 20 mm/s and two ramps of 0.1 s; the wire and the chip take the rest.
    assert conversation.time_of("ok", 1) == pytest.approx(2.0 + 1.6, abs=0.01)


def test_a_hold_keeps_the_position_and_the_motion_goes_on_where_it_stopped() -> None:
    conversation = talk()
    conversation.ask("G1X12F1200\n", within_s=0.3)
    assert conversation.ask("!", within_s=0.03) == []
    assert conversation.ask("?", within_s=0.02)[0].startswith("<Hold:1|")
    conversation.wait(0.5)
    stopped = conversation.sim.position_mm
    assert conversation.ask("?")[0].startswith("<Hold:0|")
    assert stopped[0] == pytest.approx(6.8, abs=0.2)
    conversation.wait(5.0)
    assert conversation.sim.position_mm == stopped
    conversation.ask("~", within_s=2.0)
    assert conversation.sim.position_mm == (12.0, 0.0, 0.0)
    assert len(conversation.sim.ink) == 1


def test_a_hold_runs_over_the_ends_of_short_moves() -> None:
    conversation = talk()
    conversation.stream([f"G1X{n / 10}F600" for n in range(1, 120)])
    conversation.ask("!", within_s=1.0)
    held = conversation.sim.position_mm[0]
    assert held < 12.0
    conversation.ask("~", within_s=0.05)
    # From rest again, at 200 mm/s2: not at the speeds that were planned before the hold.
    assert conversation.sim.position_mm[0] - held <= 0.5 * 200 * 0.05**2
    conversation.wait(5.0)
    assert conversation.sim.position_mm == pytest.approx((11.9, 0.0, 0.0))


def test_a_line_that_finds_a_place_in_the_planner_while_the_machine_slows_down_does_not_set_it_going() -> None:
    conversation = talk()
    conversation.ask("G1X.2F600\n" + "".join(f"X{n / 5:g}\n" for n in range(2, 24)), within_s=0.12)
    answered = len(conversation.heard)
    conversation.ask("!", within_s=0.5)
    assert len(conversation.heard) > answered
    assert conversation.ask("?")[-1].startswith("<Hold:0|")
    assert conversation.sim.position_mm[0] < 2.0
    conversation.ask("~", within_s=2.0)
    assert conversation.sim.position_mm == pytest.approx((4.6, 0.0, 0.0))


def test_lines_wait_while_the_machine_holds() -> None:
    conversation = talk()
    conversation.ask("!")
    assert conversation.ask("$G\n") == []
    assert len(conversation.ask("~")) == 2


def test_a_reset_in_hold_gives_no_alarm_and_keeps_the_position() -> None:
    conversation = talk()
    conversation.ask("G1X30F1200\n", within_s=0.4)
    conversation.ask("!", within_s=0.5)
    stopped = conversation.sim.position_mm
    assert conversation.ask("\x18") == BANNER
    assert conversation.ask("?")[0].startswith(f"<Idle|MPos:{stopped[0]:.3f},0.000,0.000|")


def test_a_reset_in_motion_is_an_alarm_half_a_second_before_the_banner() -> None:
    conversation = talk()
    conversation.ask("G1X50F1200\n", within_s=0.5)
    assert conversation.ask("\x18", within_s=1.0) == ["ALARM:3", *BANNER, UNLOCK]
    assert conversation.time_of("Grbl") - conversation.time_of("ALARM") == pytest.approx(0.5, abs=0.01)
    assert conversation.sim.ink[-1][-1] == pytest.approx(conversation.sim.position_mm[:2], abs=0.005)


def test_a_line_that_waits_for_a_place_is_answered_at_the_reset() -> None:
    conversation = talk()
    assert conversation.ask("".join(f"G1X{20 + n}F1200\n" for n in range(18)), within_s=0.4) == ["ok"] * 15
    assert conversation.ask("\x18", within_s=2.0) == ["ALARM:3", "ok", *BANNER, UNLOCK]


def test_the_state_is_idle_in_a_dwell_and_a_reset_cuts_it() -> None:
    conversation = talk()
    conversation.send("G4P3\n")
    conversation.wait(0.3)
    assert conversation.ask("?")[0].startswith("<Idle|")
    assert conversation.ask("\x18") == ["ok", *BANNER]


def test_m0_holds_without_an_answer_until_it_is_told_to_go_on() -> None:
    conversation = talk()
    assert conversation.ask("M0\n") == []
    assert conversation.ask("?")[0].startswith("<Hold:0|")
    assert conversation.ask("~") == ["ok"]


def test_a_target_beyond_the_travel_stops_the_machine_and_locks_it_until_a_reset() -> None:
    conversation = talk(settings={**BRISK, 20: 1, 22: 1})
    conversation.ask("$X\nG1X-20F900\n", within_s=0.3)
    assert conversation.ask("G1X-20Y1\n", within_s=1.5) == ["ALARM:2", "[MSG:Reset to continue]"]
    assert conversation.ask("?$X\n") == []
    assert conversation.ask("\x18", within_s=0.5) == ["ok", *BANNER, UNLOCK]
    assert -20.0 < conversation.sim.position_mm[0] < -4.0


def test_overrides_are_flags_that_merge() -> None:
    conversation = talk()
    conversation.ask("?" + "\x91" * 3)
    percent = int(conversation.ask("?")[0].split("Ov:")[1].split(",")[0])
    assert percent in {110, 120, 130}
    conversation.ask(b"\x94" * 20)
    assert percent - 20 < int(conversation.ask("?")[0].split("Ov:")[1].split(",")[0]) < percent


def test_the_feed_override_changes_the_speed_of_the_move_that_runs() -> None:
    conversation = talk()
    conversation.ask("G1X30F600\n", within_s=0.2)
    conversation.ask(b"\x91", within_s=0.3)
    assert "|FS:660,0|" in conversation.ask("?")[0]
    conversation.ask(b"\x90", within_s=0.3)
    assert "|FS:600,0|" in conversation.ask("?")[0]
    conversation.settle()
    assert conversation.sim.position_mm == (30.0, 0.0, 0.0)


def test_the_safety_door_stops_the_motion_until_it_is_told_to_go_on() -> None:
    conversation = talk()
    conversation.ask("G1X20F900\n", within_s=0.4)
    assert conversation.ask(b"\x84", within_s=0.8) == ["[MSG:Check Door]"]
    assert conversation.ask("?")[0].startswith("<Door:0|")
    conversation.ask("~")
    conversation.settle()
    assert conversation.sim.position_mm == (20.0, 0.0, 0.0)


def test_a_jog_is_cancelled_with_all_jogs_behind_it() -> None:
    conversation = talk()
    conversation.ask("$J=G91X30F1200\n$J=G91Y30F1200\n", within_s=0.4)
    assert conversation.ask("G0X1\n") == ["error:9"]
    conversation.ask(b"\x85", within_s=0.5)
    assert conversation.ask("?")[0].startswith("<Idle|")
    x, y, _ = conversation.sim.position_mm
    assert (0 < x < 30, y) == (True, 0.0)


def test_sleep_ends_only_with_a_reset_and_then_in_alarm() -> None:
    conversation = talk()
    assert conversation.ask("$SLP\n") == ["ok", "[MSG:Sleeping]"]
    assert conversation.ask("G0X1\n~") == []
    assert conversation.ask("?")[0].startswith("<Sleep|")
    assert conversation.ask("\x18", within_s=0.5) == [*BANNER, UNLOCK]


def test_nothing_happens_for_ever_after_the_last_answer() -> None:
    conversation = talk()
    conversation.ask("G0X1\n", within_s=1.0)
    assert conversation.sim.next_time() is None
