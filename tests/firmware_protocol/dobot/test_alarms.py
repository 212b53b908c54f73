"""Alarms by name, group and remedy."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_protocol.dobot import alarms, commands
from firmware_protocol.dobot.packet import PacketReader
from tests.firmware_protocol.dobot.vectors import GOLDEN


@pytest.mark.parametrize("example", GOLDEN["alarms"], ids=lambda example: str(example["codes"]))
def test_bits_of_a_reply_are_codes_and_back(example: dict[str, Any]) -> None:
    (packet,) = PacketReader().feed(bytes.fromhex(example["reply"]))
    (mask,) = commands.answer(packet)
    assert isinstance(mask, bytes)
    assert list(alarms.codes(mask)) == example["codes"]
    assert alarms.mask(set(example["codes"])) == mask


def test_an_alarm_says_its_name_group_and_remedy() -> None:
    assert alarms.alarm(0x12).sentence == (
        "alarm 0x12 (planning: target beyond a joint limit): "
        "move the sheet or make the drawing smaller, so that every point is in reach"
    )
    assert len(alarms.ALARMS) == 45


@given(st.binary(max_size=20))
def test_no_bit_is_unheard_of(mask: bytes) -> None:
    active = alarms.codes(mask)
    assert all(code < 128 for code in active)
    assert alarms.sentence(active).count("alarm 0x") == len(active)


def test_the_place_is_known_only_after_alarms_of_planning() -> None:
    assert alarms.recoverable((0x11, 0x22))
    assert not alarms.recoverable((0x11, 0x50))
    assert not alarms.recoverable((0x7F,))
