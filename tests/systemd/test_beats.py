"""Each loop says when it will be heard of again, also where one turn of it lasts as long as a drawing."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from daemon.config import GrblMachine
from daemon.jobs.beats import LINK_WITHIN_S, Beats
from daemon.jobs.devices import opened
from daemon.jobs.runner import DRAWING_WITHIN_S
from daemon.machine.link import TURN_S, Link
from daemon.pulse import Pulse
from firmware_protocol.session import Event, Sent
from tests.daemon.jobs.bench import Bench


class Clock:
    def __init__(self) -> None:
        self.now_s = 0.0
        self.pulse = Pulse(lambda: self.now_s)

    def lasts_s(self) -> float:
        """How long after the last beat the drawing loop is late."""
        self.now_s += 1e6
        return 1e6 - self.pulse.drawing("plotter").late_s


def test_a_turn_of_the_link_is_a_beat() -> None:
    clock = Clock()
    Beats(clock.pulse.drawing("plotter")).turned()
    assert clock.lasts_s() == pytest.approx(LINK_WITHIN_S)


def test_a_machine_that_says_nothing_while_it_draws_is_waited_for() -> None:
    clock, heard = Clock(), list[Event]()
    Beats(clock.pulse.drawing("plotter")).hearing(heard.append)(Sent(3600.0))
    assert heard == [Sent(3600.0)]
    assert clock.lasts_s() == pytest.approx(LINK_WITHIN_S + 3600.0)


class Quiet:
    """A way to a machine, and a conversation with it, on which nothing ever happens."""

    name, strokes_touched, strokes_certain = "quiet", 0, 0

    def __init__(self) -> None:
        self.now_s, self.waits_s = 0.0, list[float | None]()

    def now(self) -> float:
        return self.now_s

    def read(self, until: float | None) -> bytes:
        self.waits_s.append(None if until is None else until - self.now_s)
        self.now_s = self.now_s + 1e9 if until is None else until
        return b""

    def write(self, data: bytes) -> None:
        assert data == b""

    def receive(self, data: bytes, now: float) -> list[Event]:
        return []

    def expire(self, now: float) -> list[Event]:
        return []

    def data_to_send(self, now: float) -> bytes:
        return b""

    def deadline(self) -> float | None:
        return None


def test_a_link_on_which_nothing_happens_beats_every_few_seconds() -> None:
    beats, way = list[float](), Quiet()
    talk: Any = way
    Link(talk, talk, heard=lambda event: None, turned=lambda: beats.append(way.now_s)).listen(3 * TURN_S)
    assert beats == [0.0, TURN_S, 2 * TURN_S, 3 * TURN_S]
    assert way.waits_s[1:] == [TURN_S] * 3


def test_a_link_that_nobody_watches_waits_as_long_as_it_likes() -> None:
    talk: Any = Quiet()
    Link(talk, talk, heard=lambda event: None).listen(3 * TURN_S)
    assert talk.waits_s[1:] == [3 * TURN_S]


def test_the_beats_reach_the_link_of_a_machine() -> None:
    beats = list[bool]()
    machine = opened(GrblMachine(url="sim://grbl"), lambda event: None, False, None, lambda: beats.append(True))
    machine.connect()
    machine.close()
    assert beats


def test_the_drawing_loop_beats_before_each_turn(tmp_path: Path) -> None:
    clock, bench = Clock(), Bench(tmp_path)

    def turn() -> float:
        assert clock.lasts_s() == pytest.approx(DRAWING_WITHIN_S)
        bench.desk.end()
        return 0.0

    bench.runner._turn_on(turn, clock.pulse.drawing("plotter"), DRAWING_WITHIN_S, [bench.drawing])
    assert bench.desk.ending
