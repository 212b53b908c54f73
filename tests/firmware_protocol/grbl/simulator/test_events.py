"""What happens to the simulated controller from outside while it runs: switches, probe, pins, resets, faults."""

from __future__ import annotations

import pytest

from firmware_protocol.grbl.simulator.events import SENTENCES, read_event
from firmware_protocol.grbl.simulator.faults import SlowUsb
from tests.firmware_protocol.grbl.bench import BRISK, Talk, talk

BANNER = ["", "Grbl 1.1h ['$' for help]"]
HOMING = {**BRISK, 22: 1, 24: 300, 25: 2000}


def happens(conversation: Talk, sentence: str, *, then_s: float = 0.2) -> list[str]:
    conversation.sim.happen(sentence, conversation.now)
    return conversation.wait(then_s)


def state(conversation: Talk) -> str:
    return conversation.ask("?")[-1]


@pytest.mark.parametrize("sentence", ["", "limit w closed", "limit x", "lose byte -1", "slow usb 5000 ms", "explode"])
def test_what_cannot_happen_is_refused(sentence: str) -> None:
    with pytest.raises(ValueError, match="take 0 to 1" if "usb" in sentence else "all inputs open"):
        talk().sim.happen(sentence, 2.0)


def test_every_sentence_that_is_offered_is_understood() -> None:
    for sentence in SENTENCES:
        plain = sentence.replace(" [bits B]", "").replace("[N]", "3").replace(" T ", " 16 ")
        read_event(" ".join(word.split("|")[0] for word in plain.split()))


def test_without_hard_limits_a_closed_switch_is_only_reported() -> None:
    conversation = talk()
    assert happens(conversation, "limit z closed") + happens(conversation, "limit x closed") == []
    assert "<Idle|" in state(conversation)
    assert "|Pn:XZ|" in state(conversation)
    happens(conversation, "all inputs open")
    assert "Pn:" not in state(conversation)


def test_with_inverted_limit_pins_open_switches_count_as_closed() -> None:
    conversation = talk(settings={**BRISK, 5: 1})
    happens(conversation, "limit y closed")
    assert "|Pn:XZ|" in state(conversation)


def test_a_hard_limit_stops_and_says_nothing_more_until_a_reset() -> None:
    conversation = talk(settings={**BRISK, 21: 1})
    conversation.ask("G1X50F900\n", within_s=0.5)
    assert happens(conversation, "limit x closed", then_s=1.0) == ["ALARM:1", "[MSG:Reset to continue]"]
    assert 5 < conversation.sim.position_mm[0] < 8
    assert conversation.ask("?$X\n") == []
    said = conversation.ask("\x18")
    assert said == [*BANNER, "[MSG:Check Limits]", "[MSG:'$H'|'$X' to unlock]"]


@pytest.mark.parametrize("byte", ["\x18", ""])
def test_an_alarm_may_go_unsaid(byte: str) -> None:
    conversation = talk(settings={**BRISK, 21: 1})
    conversation.ask("G1X50F900\n", within_s=0.3)
    happens(conversation, "unsaid alarm")
    said = conversation.ask(byte, within_s=0.4) if byte else happens(conversation, "limit x closed", then_s=0.4)
    assert said == BANNER + ([] if byte else ["[MSG:Check Limits]", "[MSG:'$H'|'$X' to unlock]"])
    assert ("<Idle|" if byte else "<Alarm|") in state(conversation)
    assert conversation.ask("$X\nG1X50F900\n", within_s=0.3)[-1] == "ok"
    assert conversation.ask("\x18", within_s=0.4) == ["ALARM:3"]


def test_letting_a_switch_go_is_an_edge_too() -> None:
    conversation = talk()
    happens(conversation, "limit x closed")
    conversation.ask("$21=1\n")
    assert happens(conversation, "limit x open") == ["ALARM:1"]


def test_a_switch_is_pushed_where_it_stands_on_the_machine() -> None:
    conversation = talk(settings={**BRISK, 21: 1})
    happens(conversation, "all inputs open")
    happens(conversation, "switch x closes at +4.000 mm")
    happens(conversation, "switch y closes at -2.000 mm")
    assert conversation.ask("G1X-9F1500\n", within_s=1.0) == ["ok"]
    assert conversation.ask("G1X9F1500\n", within_s=2.0) == ["ok", "ALARM:1", "[MSG:Reset to continue]"]
    assert conversation.sim.position_mm[0] == pytest.approx(4.0, abs=0.05)


def test_homing_goes_to_the_switches_and_pulls_off() -> None:
    conversation = talk(settings=HOMING)
    for sentence in ("all inputs open", "switch z closes at +2.000 mm", "switch x closes at +3.000 mm"):
        happens(conversation, sentence)
    happens(conversation, "switch y closes at +4.000 mm")
    assert conversation.ask("$H\n", within_s=10.0) == ["ok"]
    assert conversation.sim.position_mm == pytest.approx((2.0, 3.0, 1.0))
    assert "|MPos:-1.000,-1.000,-1.000|" in state(conversation)


def test_a_report_asked_for_while_homing_comes_at_its_end() -> None:
    conversation = talk(settings=HOMING, switches_mm=(3.0, 4.0, 2.0))
    conversation.ask("$H\n", within_s=0.5)
    said = conversation.ask("?", within_s=10.0)
    assert said[0].startswith("<Home|MPos:-1.000,-1.000,-1.000|")
    assert said[1:] == ["ok"]


def test_a_switch_pressed_by_hand_is_found_by_homing() -> None:
    conversation = talk(settings=HOMING, switches_mm=(3.0, 4.0, 90.0))
    conversation.ask("$H\n", within_s=0.5)
    happens(conversation, "limit z closed", then_s=0.1)
    at_mm = conversation.sim.position_mm[2]
    assert at_mm < 20
    assert happens(conversation, "limit z open", then_s=10.0) == ["ok"]
    assert conversation.sim.position_mm[2] == pytest.approx(at_mm - 1.0, abs=0.01)


def test_a_switch_that_stays_closed_fails_the_homing() -> None:
    conversation = talk(settings=HOMING)
    happens(conversation, "limit z closed")
    said = conversation.ask("$H\n", within_s=3.0)
    assert said == ["ALARM:8", "ok", *BANNER, "[MSG:'$H'|'$X' to unlock]"]


def test_a_probe_stops_at_the_surface_and_tells_where() -> None:
    conversation = talk()
    happens(conversation, "probe contact at and below z -0.500 mm")
    assert conversation.ask("G38.2Z-3F60\n", within_s=3.0) == ["[PRB:0.000,0.000,-0.500:1]", "ok"]
    assert -0.6 < conversation.sim.position_mm[2] < -0.5
    assert "|Pn:P|" in state(conversation)
    assert conversation.ask("G90G0Z0\n", within_s=1.0) == ["ok"]
    assert conversation.sim.position_mm[2] == 0.0


def test_a_probe_away_from_the_surface_stops_where_contact_is_lost() -> None:
    conversation = talk()
    happens(conversation, "probe contact at and below z +1.000 mm")
    (probed, ok) = conversation.ask("G38.4Z3F60\n", within_s=4.0)
    assert (probed[:21], probed[-3:], ok) == ("[PRB:0.000,0.000,1.00", ":1]", "ok")


def test_a_probe_that_touches_already_is_an_alarm() -> None:
    conversation = talk()
    happens(conversation, "probe closed")
    assert conversation.ask("G38.2Z-1F300\n", within_s=1.0) == ["ALARM:4", "ok"]


def test_the_pins_hold_start_and_reset() -> None:
    conversation = talk()
    conversation.ask("G1X15F900\n", within_s=0.4)
    happens(conversation, "pin hold low")
    assert "<Hold:0|" in state(conversation)
    assert "|Pn:H" in state(conversation)
    happens(conversation, "pin hold high")
    assert happens(conversation, "pin start low", then_s=2.0) == []
    assert "<Idle|MPos:15.000" in state(conversation)
    assert happens(conversation, "pin reset low") == BANNER


def test_a_dtr_reset_is_deaf_and_forgets_the_position() -> None:
    conversation = talk()
    conversation.ask("G1X30F900\n", within_s=0.5)
    assert happens(conversation, "dtr reset (boot loader deaf for 1.5 s)", then_s=0.5) == []
    assert conversation.ask("?", within_s=0.9) == []
    assert conversation.wait(0.2) == BANNER
    assert "<Idle|MPos:0.000" in state(conversation)
    assert 6 < conversation.sim.position_mm[0] < 9


def test_the_next_byte_is_lost_or_flipped() -> None:
    conversation = talk()
    conversation.ask("\n")
    happens(conversation, "lose byte 3")
    assert conversation.ask("G0X12\n") == ["ok"]
    happens(conversation, "flip byte bits 0x03")
    assert conversation.ask("G0X12\n") == ["error:20"]
    conversation.settle()
    assert conversation.sim.position_mm[0] == 2.0


def test_an_answer_is_lost_once() -> None:
    conversation = talk()
    conversation.ask("\n")
    happens(conversation, "lose ok 1")
    assert conversation.ask("\n\n\n") == ["ok", "ok"]
    conversation.sim.open(conversation.now)
    assert conversation.ask("\n\n\n\n")[2:] == ["ok"] * 4


def test_hang_brown_out_and_unplug_happen_at_once() -> None:
    conversation = talk()
    conversation.ask("G1X5F900\n", within_s=0.1)
    assert happens(conversation, "brown-out") == BANNER
    happens(conversation, "hang")
    assert conversation.ask("?\n") == []
    happens(conversation, "unplug")
    assert conversation.sim.unplugged
    with pytest.raises(ValueError, match="plug it in first"):
        happens(conversation, "hardware reset")
    happens(conversation, "plug in")
    assert not conversation.sim.unplugged
    conversation.sim.open(conversation.now)
    assert conversation.wait(0.1) == BANNER


def test_a_slow_usb_converter_delivers_in_packets_both_ways() -> None:
    conversation = talk(faults=[SlowUsb(0.016)])
    conversation.wait(0.005)
    sent_s = conversation.now
    conversation.send("\n")
    conversation.wait(0.1)
    assert conversation.time_of("ok") == pytest.approx(0.016 * (sent_s // 0.016 + 2), abs=1e-6)
    conversation.send("\n")
    assert [conversation.sim.advance(conversation.now + early_s) for early_s in (0.004, 0.008)] == [b"", b""]
    happens(conversation, "slow usb 0 ms")
    sent_s = conversation.now
    conversation.send("\n")
    conversation.wait(0.1)
    assert conversation.time_of("ok", 2) - sent_s < 0.002
