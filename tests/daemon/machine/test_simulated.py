"""The transport to a simulated machine: its clock, its URL, and a cable that can be pulled."""

from __future__ import annotations

import threading
import time

import pytest

from daemon.errors import MachineFault, SettingsError
from daemon.machine.simulated import SimulatedTransport, open_simulated
from firmware_protocol.grbl.simulator.faults import Unplug
from firmware_protocol.grbl.simulator.simulator import GrblSimulator, PenRule


def heard(transport: SimulatedTransport, until: float) -> bytes:
    """All that comes up to `until` on the transport's clock."""
    data = b""
    while transport.now() < until:
        data += transport.read(until)
    return data


def test_the_banner_is_read_first() -> None:
    transport = open_simulated("sim://grbl")
    assert b"Grbl 1.1h" in heard(transport, 0.1)
    assert transport.name == "sim://grbl"


def test_a_minute_of_drawing_passes_in_no_time_and_leaves_its_ink() -> None:
    transport = open_simulated("sim://grbl?110=3000&120=200")
    heard(transport, 0.1)
    started_s = time.monotonic()
    transport.write(b"G1X100F100\n")
    assert heard(transport, 65.0) == b"ok\r\n"
    assert time.monotonic() - started_s < 5
    assert transport.ink == [[(0.0, 0.0), (100.0, 0.0)]]


def test_nothing_comes_before_its_time() -> None:
    transport = open_simulated("sim://grbl")
    heard(transport, 0.1)
    transport.write(b"G4P2\n")
    assert heard(transport, 2.0) == b""
    assert transport.now() == 2.0
    assert heard(transport, 2.2) == b"ok\r\n"


def test_a_read_without_a_limit_returns_when_bytes_come() -> None:
    transport = open_simulated("sim://grbl?boot_s=1.5")
    assert transport.read(None) == b"\r\nGrbl 1.1h ['$' for help]\r\n"
    assert transport.now() == pytest.approx(1.5, abs=0.1)


def test_wake_ends_a_read_that_waits_for_ever() -> None:
    transport = open_simulated("sim://grbl")
    heard(transport, 0.1)
    woken: list[bytes] = []
    reader = threading.Thread(target=lambda: woken.append(transport.read(None)))
    reader.start()
    transport.wake()
    reader.join(5)
    assert woken == [b""]


def test_real_time_takes_its_time() -> None:
    transport = open_simulated("sim://grbl?speed=20")
    started_s = time.monotonic()
    heard(transport, 2.0)
    assert 0.08 < time.monotonic() - started_s < 2.0


def test_an_unplugged_machine_is_a_fault_for_reading_and_writing() -> None:
    transport = open_simulated("sim://grbl?unplug=1")
    with pytest.raises(MachineFault, match="unplugged"):
        heard(transport, 2.0)
    with pytest.raises(MachineFault, match="plug the machine in"):
        transport.write(b"?")


def test_what_is_closed_stays_closed() -> None:
    transport = open_simulated("sim://grbl")
    transport.close()
    transport.close()
    with pytest.raises(MachineFault, match="closed"):
        transport.read(1.0)


def test_settings_pen_and_faults_come_from_the_url_or_the_arguments() -> None:
    url = "sim://grbl?10=3&pen_s=800:200&hang=@4&drop=7&flip=4&lose_ok=0"
    transport = open_simulated(url, faults=[Unplug(at_s=9.0)], settings={13: 1}, pen=PenRule(down_at_mm=-1))
    heard(transport, 0.1)
    transport.write(b"\nM3S800\nG0X1\n")
    assert heard(transport, 3.0) == b"ok\r\n"  # the first is lost, the next two lines have become one
    assert transport.ink == [[(0.0, 0.0), (1.0, 0.0)]]


def test_homing_finds_the_switches_of_the_url() -> None:
    transport = open_simulated("sim://grbl?22=1&switches=-200:3:0&23=1")
    heard(transport, 0.1)
    transport.write(b"$H\n")
    assert heard(transport, 120.0).endswith(b"ok\r\n")
    assert transport.simulator.position_mm == pytest.approx((-199.0, 2.0, -1.0))
    transport.write(b"?")
    assert b"MPos:-199.000,-1.000,-1.000" in heard(transport, 121.0)


@pytest.mark.parametrize(
    "query",
    [
        "",
        "grbl/x",
        "emco",
        "grbl?sped=1",
        "grbl?999=1",
        "grbl?hang=x",
        "grbl?hang=@x",
        "grbl?speed=x",
        "grbl?pen_s=x",
        "grbl?switches=1:2",
    ],
)
def test_a_url_that_says_nothing_is_refused_with_an_example(query: str) -> None:
    with pytest.raises(SettingsError, match="write"):
        open_simulated("sim://" + query)


def test_the_same_simulator_may_be_opened_again() -> None:
    simulator = GrblSimulator()
    first = SimulatedTransport(simulator)
    first.write(b"G0Z-1\n")
    heard(first, 3.0)
    first.close()
    second = SimulatedTransport(simulator)
    assert b"Grbl 1.1h" in heard(second, second.now() + 0.1)


def test_ink_is_taken_once() -> None:
    transport = open_simulated("sim://grbl?110=3000&120=200")
    heard(transport, 0.1)
    transport.write(b"G1X1F100\n")
    heard(transport, 5.0)
    assert transport.take_ink() == [[(0.0, 0.0), (1.0, 0.0)]]
    assert transport.take_ink() == []
    transport.write(b"G1X2F100\n")
    heard(transport, 10.0)
    assert transport.take_ink() == [[(1.0, 0.0), (2.0, 0.0)]]
