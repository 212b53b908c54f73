"""Every error and alarm number has a meaning and a remedy."""

from __future__ import annotations

import pytest

from firmware_protocol.grbl import codes


@pytest.mark.parametrize("code", [*range(1, 18), *range(20, 39)])
def test_every_error_of_grbl_1_1_says_what_to_do(code: int) -> None:
    assert codes.error(code) is codes.ERRORS[code]
    assert codes.error(code).meaning
    assert codes.error(code).remedy


@pytest.mark.parametrize("code", range(1, 11))
def test_every_alarm_of_grbl_1_1_says_what_to_do(code: int) -> None:
    assert codes.alarm(code) is codes.ALARMS[code]
    assert codes.alarm(code).remedy


def test_a_number_of_another_firmware_has_a_sentence_too() -> None:
    assert "manual" in str(codes.error(163))
    assert "manual" in str(codes.alarm(17))
