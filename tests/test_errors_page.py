"""docs/errors.md says what the code says."""

from __future__ import annotations

import pytest

from firmware_protocol.dobot import alarms
from firmware_protocol.grbl import codes
from tests.errors_page import PAGE, page


def test_the_page_is_up_to_date() -> None:
    assert PAGE.read_text(encoding="utf-8") == page(), "make it anew: python -m tests.errors_page"


@pytest.mark.parametrize(
    "said",
    [
        f"| 9 | {codes.ERRORS[9].meaning} | {codes.ERRORS[9].remedy} |",
        f"| 2 | {codes.ALARMS[2].meaning} | {codes.ALARMS[2].remedy} |",
        f"| 0x11 | planning | target out of the workspace | {alarms.GROUPS[1].remedy} |",
        "| 3 | `NoMachine` |",
        "- the control has held the transfer by XOFF for ... s:",
        "- the controller has not answered for ... s:",
        "- the arm has stood still for ... s before line ... without an alarm:",
    ],
)
def test_every_table_is_there(said: str) -> None:
    assert said in page()


def test_a_code_that_gets_another_meaning_makes_another_page(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(codes.ERRORS, 9, codes.Code("another meaning", "another cure"))
    assert "| 9 | another meaning | another cure |" in page()
