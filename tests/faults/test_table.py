"""The table says what is good, what is not, and what limits the harm of what nobody can see."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests.faults import __main__ as faults
from tests.faults.row import Row

GOOD = Row("grbl", "hang", "travel", "no answer", "silent", 3.0, 1, 2, 1, "ok")
BLIND = replace(GOOD, fault="flipped byte", sign="", seconds=None, outcome="undetectable", limits="a dry run shows it")


def test_columns_stand_under_each_other() -> None:
    head, first, second = faults.table([GOOD, BLIND]).splitlines()
    assert head.index("verdict") == first.index("silent") == second.index("silent")
    assert second.split()[-1] == "undetectable"


def test_each_machine_is_counted_and_what_is_undetectable_is_never_called_good() -> None:
    lines = faults.in_words([GOOD, BLIND, replace(GOOD, machine="emco", outcome="wrong", seconds=7.0)])
    assert "grbl: 1 ok, 0 wrong, 1 undetectable on this link; slowest verdict 3.00 s after its sign (bar 5 s)" in lines
    assert "emco: 0 ok, 1 wrong, 0 undetectable on this link; slowest verdict 7.00 s after its sign (bar 5 s)" in lines
    assert lines[-1] == "  grbl, flipped byte: a dry run shows it"


@pytest.mark.parametrize(("outcome", "code"), [("ok", 0), ("undetectable", 0), ("wrong", 1)])
def test_a_wrong_row_is_an_exit_code(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], outcome: str, code: int
) -> None:
    row = replace(GOOD, outcome=outcome)  # type: ignore[arg-type]
    monkeypatch.setattr(faults, "MACHINES", {"grbl": lambda: [row], "emco": list})
    assert faults.main(["grbl"]) == code
    assert outcome in capsys.readouterr().out
