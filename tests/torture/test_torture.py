"""Fifty kills at random moments lose nothing, draw nothing twice, and leave nothing untold."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.torture.torture import Torture

KILLS = 50


@pytest.mark.system
def test_kills_lose_and_double_nothing(tmp_path: Path) -> None:
    said: list[str] = []
    with Torture(tmp_path, 7, say=said.append) as torture:
        torture.run(KILLS)
    found = torture.checks.found
    wrong = [*found.lost.values(), *found.doubled.values(), *found.wrong_prefix.values(), *found.other.values()]
    assert wrong == [], "\n".join(said)
    assert found.last_line(KILLS) == f"kills {KILLS}, lost 0, doubled 0, wrong prefix 0"
