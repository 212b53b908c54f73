"""Kills at random moments lose nothing, draw nothing twice, and leave nothing untold."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.torture.torture import Torture


@pytest.mark.system
@pytest.mark.parametrize(("machines", "kills"), [(1, 50), (2, 20)])
def test_kills_lose_and_double_nothing(tmp_path: Path, machines: int, kills: int) -> None:
    said: list[str] = []
    with Torture(tmp_path, 7, say=said.append, machines=machines) as torture:
        torture.run(kills)
    found = torture.checks.found
    wrong = [*found.lost.values(), *found.doubled.values(), *found.wrong_prefix.values(), *found.other.values()]
    assert wrong == [], "\n".join(said)
    assert found.last_line(kills) == f"kills {kills}, lost 0, doubled 0, wrong prefix 0"
