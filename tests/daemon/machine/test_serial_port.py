"""The way to a machine on a port; the ports are pseudo terminals and local sockets."""

from __future__ import annotations

import errno
import os
import socket
import threading
import tty
from collections.abc import Iterator
from pathlib import Path

import pytest
import serial

from daemon.errors import MachineFault, NoMachine
from daemon.machine.serial_port import Framing, adapters, open_serial, why_not_opened
from daemon.machine.transport import Transport


class Terminal:
    """A pseudo terminal: `path` for us, `master` for the machine."""

    def __init__(self) -> None:
        self.master, slave = os.openpty()
        tty.setraw(slave)
        self.path = os.ttyname(slave)
        self._slave = slave

    def unplug(self) -> None:
        for end in (self.master, self._slave):
            if end >= 0:
                os.close(end)
        self.master = self._slave = -1


@pytest.fixture
def terminal() -> Iterator[Terminal]:
    terminal = Terminal()
    yield terminal
    terminal.unplug()


@pytest.fixture
def port(terminal: Terminal) -> Iterator[Transport]:
    port = open_serial(terminal.path)
    yield port
    port.close()


@pytest.fixture
def server() -> Iterator[socket.socket]:
    with socket.create_server(("127.0.0.1", 0)) as server:
        yield server


def url_of(server: socket.socket) -> str:
    return f"tcp://127.0.0.1:{server.getsockname()[1]}"


def soon(port: Transport) -> float:
    return port.now() + 5.0


def test_bytes_go_both_ways_unchanged(terminal: Terminal, port: Transport) -> None:
    every = bytes(range(256))
    port.write(every)
    assert os.read(terminal.master, 1000) == every
    os.write(terminal.master, every)
    assert port.read(soon(port)) == every


def test_framing_and_dtr_are_set_before_a_port_is_opened(monkeypatch: pytest.MonkeyPatch) -> None:
    """A pseudo terminal knows neither, so the port is looked at just before the system would open it."""
    seen: list[tuple[object, ...]] = []

    def look(port: serial.Serial) -> None:
        seen.append((port.baudrate, port.bytesize, port.parity, port.stopbits, port.exclusive, port.dtr, port.rts))
        raise serial.SerialException(errno.ENOENT, "not there")

    monkeypatch.setattr(serial.Serial, "open", look)
    for framing in (Framing(9600, data_bits=7, parity="E", stop_bits=2, dtr=False), Framing()):
        with pytest.raises(NoMachine, match="there is no port"):
            open_serial("/dev/ttyS99", framing=framing)
    assert seen == [(9600, 7, "E", 2, True, False, False), (115200, 8, "N", 1, True, True, True)]


def test_a_read_without_bytes_ends_when_its_time_has_come(port: Transport) -> None:
    until = port.now() + 0.01
    assert port.read(until) == b""
    assert port.now() >= until
    assert port.read(port.now() - 1.0) == b""


def test_another_thread_wakes_a_read_that_waits_for_ever(port: Transport) -> None:
    waker = threading.Thread(target=port.wake)
    waker.start()
    assert port.read(None) == b""
    waker.join()


def test_more_wakes_than_the_pipe_holds_block_nobody(port: Transport) -> None:
    for _ in range(70000):
        port.wake()
    assert port.read(None) == b""


def test_a_url_and_a_bare_path_are_one_port(terminal: Terminal) -> None:
    port = open_serial(f"serial://{terminal.path}")
    assert port.name == terminal.path
    port.close()


def test_a_port_is_opened_for_one_only(terminal: Terminal, port: Transport) -> None:
    with pytest.raises(NoMachine, match=rf"{terminal.path} is in use by another program: close"):
        open_serial(terminal.path)


def test_a_closed_port_may_be_opened_again(terminal: Terminal) -> None:
    open_serial(terminal.path).close()
    open_serial(terminal.path).close()


def test_a_missing_port_is_named() -> None:
    with pytest.raises(NoMachine, match="there is no port /dev/ttyUSB99: plug"):
        open_serial("serial:///dev/ttyUSB99")


def test_a_file_is_no_port(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_bytes(b"")
    with pytest.raises(NoMachine, match="is no serial port"):
        open_serial(str(file))


def test_a_missing_permission_names_the_group() -> None:
    assert "group dialout" in why_not_opened("/dev/ttyUSB0", errno.EACCES)


@pytest.mark.parametrize("url", ["http://host", "serial://", "ttyUSB0:", ""])
def test_what_is_no_url_of_a_port_is_refused(url: str) -> None:
    with pytest.raises(NoMachine):
        open_serial(url)


def test_an_unplugged_port_is_a_fault_for_reading_and_writing(terminal: Terminal, port: Transport) -> None:
    terminal.unplug()
    with pytest.raises(MachineFault, match=r"unplugged: plug"):
        port.read(soon(port))
    with pytest.raises(MachineFault, match=r"unplugged: plug"):
        port.write(b"?")


def test_a_port_that_takes_nothing_is_a_fault(terminal: Terminal) -> None:
    port = open_serial(terminal.path, write_within_s=0.01)
    with pytest.raises(MachineFault, match="takes no more bytes"):
        port.write(bytes(1_000_000))
    port.close()


def test_closing_twice_is_safe_and_a_closed_port_says_so(port: Transport) -> None:
    port.close()
    port.close()
    port.wake()
    with pytest.raises(MachineFault, match="has been closed"):
        port.read(None)
    with pytest.raises(MachineFault, match="has been closed"):
        port.write(b"?")


def test_tcp_goes_both_ways(server: socket.socket) -> None:
    port = open_serial(url_of(server))
    peer, _ = server.accept()
    with peer:
        port.write(b"?")
        assert peer.recv(10) == b"?"
        peer.sendall(b"ok\r\n")
        assert port.read(soon(port)) == b"ok\r\n"
    port.close()


def test_a_tcp_peer_that_hangs_up_is_unplugged(server: socket.socket) -> None:
    port = open_serial(url_of(server))
    server.accept()[0].close()
    with pytest.raises(MachineFault, match="unplugged"):
        port.read(soon(port))
    port.close()


def test_nobody_at_a_tcp_address_is_no_machine(server: socket.socket) -> None:
    url = url_of(server)
    server.close()
    with pytest.raises(NoMachine, match=f"{url} does not answer"):
        open_serial(url)
    with pytest.raises(NoMachine, match="does not answer"):
        open_serial("tcp://127.0.0.1:port")


def test_the_inventory_lists_usb_adapters_only() -> None:
    assert all(adapter.vid > 0 and adapter.path.startswith("/dev/") for adapter in adapters())
