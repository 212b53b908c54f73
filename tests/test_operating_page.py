"""docs/operating.md says what the tables in the code say."""

from __future__ import annotations

import pytest

from daemon.jobs.states import MEANINGS, OUTCOMES, STEPS, Reason, State
from firmware_protocol.session import Verdict
from tests.operating_page import PAGE, made, page


def test_the_page_is_up_to_date() -> None:
    text = PAGE.read_text(encoding="utf-8")
    assert text == page(text), "make it anew: python -m tests.operating_page"


def test_every_state_and_every_verdict_has_its_row() -> None:
    assert {state for state, _ in MEANINGS} == set(State)
    assert {reason for _, reason in MEANINGS} == set(Reason)
    assert set(OUTCOMES) == set(Verdict)


def test_another_step_makes_another_diagram(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(STEPS, (State.DONE, State.QUEUED), "a whim")
    assert "    done --> queued: a whim\n" in made()
