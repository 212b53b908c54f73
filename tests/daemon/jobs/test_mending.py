"""A mute adapter is reset once, where the settings allow it, and only where it is sure which one is meant."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

import pytest

from daemon.config import GrblMachine
from daemon.errors import NoMachine
from daemon.jobs.mending import Mending
from daemon.jobs.open_machine import OpenMachine
from daemon.machine.serial_port import Adapter
from firmware_protocol.session import Event, NotReady, Ready, Status

CH340 = Adapter("/dev/ttyUSB0", 0x1A86, 0x7523, "1-1.2")
CP210X = Adapter("/dev/ttyUSB1", 0x10C4, 0xEA60, "1-1.3")
UNO = Adapter("/dev/ttyACM0", 0x2341, 0x0043, "1-1.1:1.0")
MUTE = NotReady("nothing answers")


class Bench:
    """`try_out(events)` opens the machine once, which then says so much."""

    def __init__(self, url: str, *ports: Adapter, may: bool = True, stuck: bool = False) -> None:
        self.reset, self.said, self.stuck = list[str](), list[str](), stuck
        machine = GrblMachine(url=url, may_reset_usb=may)
        self.mending = Mending(machine, self._opened, say=self._say, ports=lambda: ports, reset=self._reset)
        self.events: tuple[Event, ...] = ()

    def try_out(self, *events: Event) -> list[Event]:
        heard = list[Event]()
        self.events = events
        self.mending.opened(heard.append, False)
        return heard

    def _opened(self, hear: Callable[[Event], None], still: bool) -> OpenMachine:
        for event in self.events:
            hear(event)
        return cast(OpenMachine, None)

    def _say(self, words: str, **_: Any) -> None:
        self.said.append(words)

    def _reset(self, place: str) -> None:
        if self.stuck:
            raise NoMachine("it cannot be reset: unplug it")
        self.reset.append(place)


def test_a_mute_adapter_is_reset_before_it_is_opened_again_and_only_once() -> None:
    bench = Bench("auto", CH340)
    assert bench.try_out(MUTE) == [MUTE]
    assert bench.reset == []
    for _ in range(3):
        bench.try_out(MUTE)
    assert bench.reset == ["1-1.2"]
    assert bench.said == ["the machine was mute, so its USB adapter has been reset"]


def test_after_an_answer_it_may_be_reset_again() -> None:
    bench = Bench("auto", CH340)
    for events in [[MUTE], [Ready("1.1h", 128)], [MUTE], [MUTE]]:
        bench.try_out(*events)
    assert bench.reset == ["1-1.2", "1-1.2"]


def test_a_machine_that_has_said_anything_is_not_mute() -> None:
    bench = Bench("auto", CH340)
    bench.try_out(Status("Alarm", (0.0, 0.0, 0.0)), MUTE)
    bench.try_out(MUTE)
    assert bench.reset == []


def test_nothing_is_reset_where_the_settings_do_not_allow_it() -> None:
    assert GrblMachine().may_reset_usb is False
    bench = Bench("auto", CH340, may=False)
    bench.try_out(MUTE)
    bench.try_out(MUTE)
    assert bench.reset == []


@pytest.mark.parametrize(
    ("url", "reset"),
    [
        ("auto", []),
        ("usb://1-1.3", ["1-1.3"]),
        ("/dev/ttyUSB0", ["1-1.2"]),
        ("/dev/ttyACM0", []),
        ("usb://9-9", []),
        ("tcp://127.0.0.1:23", []),
        ("sim://grbl", []),
    ],
)
def test_only_the_adapter_that_is_meant_is_reset(url: str, reset: list[str]) -> None:
    bench = Bench(url, CH340, CP210X, UNO)
    bench.try_out(MUTE)
    bench.try_out(MUTE)
    assert bench.reset == reset


def test_a_reset_that_fails_is_said_and_not_repeated() -> None:
    bench = Bench("auto", CH340, stuck=True)
    for _ in range(3):
        bench.try_out(MUTE)
    assert bench.said == ["it cannot be reset: unplug it"]
