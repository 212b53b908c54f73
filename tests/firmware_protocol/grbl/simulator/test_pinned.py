"""Exchanges that real GRBL 1.1h has been seen to have, pinned in tests/golden/grbl, held against the simulator.

A file holds scenarios, each with a sentence behind `#` and a line a step; a fresh, brisk controller plays it:
`settings N=V` and `factory` before all else; `send TEXT` with Python's escapes; `do SENTENCE` for what happens to the
machine; `wait SECONDS`; `skip` what has been said; `hear TEXT` for the next line, where `*` stands for anything. 0.1 s
pass behind each `send` and `do`. What is said and neither heard nor skipped is a difference.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.firmware_protocol.grbl.bench import BRISK, Talk

PINNED = Path(__file__).parents[3] / "golden" / "grbl"
STEP_S = 0.1


def scenarios() -> Iterator[object]:
    for path in sorted(PINNED.glob("*.txt")):
        for block in path.read_text().split("\n\n"):
            sentence, *steps = block.strip().splitlines()
            yield pytest.param(steps, id=f"{path.stem}: {sentence.removeprefix('# ')}")


class Play:
    """One scenario under way."""

    def __init__(self, settings: dict[int, float]) -> None:
        self.talk = Talk(settings=settings)
        self.talk.wait(2.0)
        self.waiting: list[str] = []

    def step(self, step: str) -> None:
        word, _, rest = step.partition(" ")
        if word == "hear":
            assert self.waiting, f"nothing is said where {rest!r} is due"
            said = self.waiting.pop(0)
            assert re.fullmatch(".*".join(map(re.escape, rest.split("*"))), said), f"{said!r} is said, {rest!r} is due"
            return
        if word == "skip":
            self.waiting.clear()
        elif word == "send":
            self._pass_silently(rest)
            self.talk.send(rest.encode("latin-1").decode("unicode_escape"))
        elif word == "do":
            self._pass_silently(rest)
            self.talk.sim.happen(rest, self.talk.now)
        self.waiting += self.talk.wait(float(rest) if word == "wait" else STEP_S)

    def _pass_silently(self, what: str) -> None:
        assert self.waiting == [], f"said before {what!r}, and not expected"


@pytest.mark.parametrize("steps", list(scenarios()))
def test_the_simulator_says_what_the_real_one_said(steps: list[str]) -> None:
    settings: dict[int, float] = dict(BRISK)
    while steps[0].split()[0] in ("settings", "factory"):
        first, *steps = steps
        if first == "factory":
            settings = {}
        settings |= {int(n): float(v) for n, v in (pair.split("=") for pair in first.split()[1:])}
    play = Play(settings)
    for step in steps:
        play.step(step)
    assert play.waiting == []


def test_every_kind_of_answer_is_pinned() -> None:
    told = "\n".join(path.read_text() for path in PINNED.glob("*.txt"))
    assert {int(code) for code in re.findall(r"^hear error:(\d+)$", told, re.MULTILINE)} >= {
        *range(1, 7), *range(8, 12), *range(16, 17), *range(20, 39),
    }  # fmt: skip
    assert {int(code) for code in re.findall(r"^hear ALARM:(\d+)$", told, re.MULTILINE)} == {1, 2, 3, 4, 5, 6, 8, 9}
    assert {"Idle", "Run", "Hold", "Jog", "Alarm", "Door", "Check", "Home", "Sleep"} == set(
        re.findall(r"^hear <(\w+)", told, re.MULTILINE)
    )
