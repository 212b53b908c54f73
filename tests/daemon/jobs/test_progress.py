"""The time left is true to the machine's own clock, also around a pause."""

from __future__ import annotations

import math
import random
from typing import Any

import numpy as np
import pytest

from daemon.config import GrblMachine
from daemon.jobs.devices import opened, program_of
from daemon.jobs.progress import Progress
from daemon.shapes import Program, ProgramLine, Stroke, Toolpath
from firmware_protocol.session import Accepted, Event, Paused, Resumed, Status, Verdict, Waiting

STATUS = Status("Run", (0.0, 0.0, 0.0))


def wavy(strokes: int, *, seed: int = 1) -> Program:
    dice = random.Random(seed)
    lines = []
    for _ in range(strokes):
        x, y, turn = dice.uniform(20, 60), dice.uniform(20, 60), dice.uniform(0.5, 3.0)
        lines.append(
            [(x + 12 * math.cos(turn * t / 9), y + 12 * math.sin(t / 5)) for t in range(dice.randrange(2, 60))]
        )
    from_px = np.array([[1.0, 0, 0], [0, 1.0, 0]])
    toolpath = Toolpath(tuple(Stroke(np.array(line)) for line in lines), from_px, (0.0, 0.0))
    return program_of(toolpath, GrblMachine(url="sim://grbl"), "000001-wavy")


@pytest.mark.parametrize("strokes", [2, 10, 40])
def test_seconds_left_are_within_five_percent_of_the_truth_from_ten_percent_on(strokes: int) -> None:
    program, told = wavy(strokes), list[tuple[float, float, float]]()
    shown: dict[str, Any] = {}

    def hear(event: Event) -> None:
        if isinstance(event, Accepted):
            progress.hear(event)
            told.append((machine.now(), shown["percent"], shown["seconds_left"]))

    machine = opened(GrblMachine(url="sim://grbl"), hear, still=False)
    machine.connect()
    progress = Progress(lambda **values: shown.update(values), program, machine.line_times_s(program), now=machine.now)
    begun_s = machine.now()
    assert machine.draw(program).verdict is Verdict.FINISHED
    all_s = machine.now() - begun_s
    machine.close()
    late = [(at_s, left_s) for at_s, percent, left_s in told if at_s - begun_s >= 0.1 * all_s]
    assert len(late) > 3
    worst = max(abs(left_s - (begun_s + all_s - at_s)) / max(begun_s + all_s - at_s, 1e-9) for at_s, left_s in late)
    assert worst <= 0.05


@pytest.mark.parametrize("stands", [Paused(0, (4.0, 5.0)), Waiting("the door is open", "door")])
def test_a_pause_takes_nothing_from_the_time_that_is_left(stands: Event) -> None:
    lines = tuple(ProgramLine(f"G1 X{number}", 0) for number in range(100))
    shown: dict[str, Any] = {}
    now = [50.0]
    times_s = [float(line + 1) for line in range(100)]
    progress = Progress(lambda **values: shown.update(values), Program(lines, 1), times_s, now=lambda: now[0])
    for line in range(40):
        progress.hear(Accepted(line))
        now[0] = 50.0 + max(0, line - 10)
    assert shown["seconds_left"] == pytest.approx(100 - 28)
    now[0] += 1.0
    progress.hear(stands)
    now[0] += 1000.0
    progress.hear(STATUS)
    assert shown["seconds_left"] == pytest.approx(100 - 30)
    shown["state"] = "paused"
    progress.hear(Accepted(39))
    assert shown["state"] == "paused"
    progress.hear(Resumed())
    progress.hear(Accepted(40))
    assert shown["seconds_left"] == pytest.approx(100 - 30)
    now[0] += 1.0
    progress.hear(STATUS)
    assert shown["seconds_left"] == pytest.approx(100 - 31)


def test_where_the_pen_is_changed_all_strokes_before_are_done_although_the_clock_was_slower() -> None:
    texts = ["G1 X1", "G1 X2", "G0 X0 Y9", "M0"]
    lines = (*(ProgramLine(text, 0) for text in texts), ProgramLine("G1 X3", 1))
    shown: dict[str, Any] = {}
    progress = Progress(lambda **values: shown.update(values), Program(lines, 2), [1.0, 2.0, 3.0, 3.5, 4.0], now=float)
    for line in range(3):
        progress.hear(Accepted(line))
    assert shown["strokes_done"] == 0
    progress.hear(Paused(1, change=True))
    assert (shown["strokes_done"], shown["seconds_left"]) == (1, 1.0)
