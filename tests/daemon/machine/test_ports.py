"""Which port the GRBL controller is on."""

from __future__ import annotations

import pytest

from daemon.errors import NoMachine
from daemon.machine.ports import candidates, find_grbl, is_grbl, named
from daemon.machine.serial_port import Adapter
from daemon.machine.simulated import SimulatedTransport
from daemon.machine.transport import Transport
from firmware_protocol.grbl.simulator.faults import Hang
from firmware_protocol.grbl.simulator.simulator import GrblSimulator

UNO = Adapter("/dev/ttyACM0", 0x2341, 0x0043, "1-1.1")
CH340 = Adapter("/dev/ttyUSB0", 0x1A86, 0x7523, "1-1.2")
MODEM = Adapter("/dev/ttyUSB1", 0x12D1, 0x1001, "1-1.3")


def never(path: str) -> Transport:
    raise AssertionError(f"{path} was opened")


def grbl() -> Transport:
    return SimulatedTransport(GrblSimulator())


def locked_grbl() -> Transport:
    return SimulatedTransport(GrblSimulator(settings={22: 1}))


def mute() -> Transport:
    return SimulatedTransport(GrblSimulator(faults=[Hang(at_s=0.0)]))


def in_use() -> Transport:
    raise NoMachine("in use")


def test_only_adapters_of_known_boards_are_candidates() -> None:
    assert candidates([UNO, MODEM, CH340]) == (UNO, CH340)


def test_a_single_candidate_is_taken_without_opening_anything() -> None:
    assert find_grbl([MODEM, CH340], open_port=never) == "/dev/ttyUSB0"


def test_no_candidate_is_no_machine() -> None:
    with pytest.raises(NoMachine, match="plug it in, or name its port"):
        find_grbl([MODEM], open_port=never)


def test_an_adapter_on_the_usb_without_a_port_is_explained() -> None:
    with pytest.raises(NoMachine, match=r"1A86:7523, but no serial port .*brltty"):
        find_grbl([], on_usb={(0x1A86, 0x7523), (0x1D6B, 0x0002)}, open_port=never)


@pytest.mark.parametrize("other", [mute, in_use])
def test_of_several_candidates_the_one_that_answers_is_taken(other: object) -> None:
    doors = {UNO.path: other, CH340.path: locked_grbl}
    assert find_grbl([UNO, MODEM, CH340], open_port=lambda path: doors[path]()) == CH340.path  # type: ignore[operator]


def test_two_that_answer_are_refused_and_listed() -> None:
    with pytest.raises(NoMachine, match=r"2 GRBL .* /dev/ttyACM0 \(USB 1-1.1, 2341:0043\), /dev/ttyUSB0 .*name"):
        find_grbl([UNO, CH340], open_port=lambda path: grbl())


def test_none_that_answers_lists_the_candidates() -> None:
    with pytest.raises(NoMachine, match=r"no GRBL controller answers on /dev/ttyACM0 .*, /dev/ttyUSB0"):
        find_grbl([UNO, CH340], open_port=lambda path: mute())


@pytest.mark.parametrize(("machine", "answer"), [(grbl, True), (locked_grbl, True), (mute, False)])
def test_grbl_is_known_by_its_banner_locked_or_not(machine: object, answer: bool) -> None:
    assert is_grbl(machine()) is answer  # type: ignore[operator]


def test_a_port_is_named_by_the_place_where_it_is_plugged_in() -> None:
    uno_by_interface = Adapter("/dev/ttyACM7", 0x2341, 0x0043, "1-1.1:1.0")
    assert named("usb://1-1.2", lambda: [MODEM, CH340]) == "/dev/ttyUSB0"
    assert named("usb://1-1.1", lambda: [uno_by_interface]) == "/dev/ttyACM7"
    assert named("serial:///dev/ttyS0", lambda: []) == "serial:///dev/ttyS0"


def test_a_place_where_nothing_is_plugged_in_is_named() -> None:
    with pytest.raises(NoMachine, match=r"no serial adapter is plugged in at USB 1-1\.9: plug it in there"):
        named("usb://1-1.9", lambda: [CH340, MODEM])
