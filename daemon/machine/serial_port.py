"""The way to a machine on a serial port or a TCP socket; the only door to pyserial."""

from __future__ import annotations

import errno
import os
import select
import socket
import threading
import time
from contextlib import suppress
from dataclasses import dataclass
from typing import Protocol
from urllib.parse import urlsplit

import serial
from serial.tools import list_ports

from daemon.errors import MachineFault, NoMachine, Unplugged
from daemon.machine.transport import Transport

CHUNK_BYTES = 4096
WRITE_WITHIN_S = 5.0
"""A port that takes no byte for this long is stuck: a controller that reads takes 11 bytes a millisecond."""
CONNECT_WITHIN_S = 5.0


@dataclass(frozen=True, slots=True)
class Adapter:
    """A serial port on the USB: `place` is where it is plugged in, for people."""

    path: str
    vid: int
    pid: int
    place: str


@dataclass(frozen=True, slots=True)
class Framing:
    """How a serial port is set up. dtr: False keeps DTR and RTS low from before the port is opened: no reset."""

    baud: int = 115200
    data_bits: int = 8
    parity: str = "N"
    stop_bits: int = 1
    dtr: bool = True


class _Wire(Protocol):
    """What a serial port and a socket have in common."""

    def fileno(self) -> int: ...

    def close(self) -> None: ...


def open_serial(url: str, *, framing: Framing = Framing(), write_within_s: float = WRITE_WITHIN_S) -> Transport:
    """Open a port for this process alone. url: serial:///dev/ttyUSB0, a bare path, or tcp://host:port.

    Opening a serial port resets most boards, unless `framing` says no to DTR. write_within_s: a port that takes no
    byte for so long is a fault.
    Raises NoMachine when it is missing, in use or not allowed.
    """
    parts = urlsplit(url)
    if parts.scheme == "tcp":
        return _Port(url, _connect(url), write_within_s)
    if parts.scheme in {"serial", ""} and parts.path:
        return _Port(parts.path, _open(parts.path, framing), write_within_s)
    raise NoMachine(f"{url} is no port: give serial:///dev/ttyUSB0, a path, or tcp://host:port")


def adapters() -> tuple[Adapter, ...]:
    """The serial ports on the USB, by path; read from sysfs, nothing is opened."""
    found = (port for port in list_ports.comports() if port.vid is not None and port.pid is not None)
    listed = (Adapter(port.device, port.vid, port.pid, port.location or port.device) for port in found)
    return tuple(sorted(listed, key=lambda adapter: adapter.path))


def _open(path: str, framing: Framing) -> _Wire:
    try:
        port = serial.Serial(
            baudrate=framing.baud,
            bytesize=framing.data_bits,
            parity=framing.parity,
            stopbits=framing.stop_bits,
            timeout=0,
            exclusive=True,
        )
        if not framing.dtr:
            port.dtr = port.rts = False
        port.port = path
        port.open()
    except serial.SerialException as fault:
        raise NoMachine(why_not_opened(path, fault.errno)) from fault
    except ValueError as fault:
        raise NoMachine(f"{path} does not do {framing.baud} baud: set another baud rate") from fault
    wire: _Wire = port
    return wire


def why_not_opened(path: str, number: int | None) -> str:
    """What an error number of the system means for a person who wants to open `path`."""
    if number == errno.ENOENT:
        return f"there is no port {path}: plug the machine in, or name another port"
    if number in {errno.EACCES, errno.EPERM}:
        return f"{path} may not be opened by this user: add the user to the group dialout"
    if number in {errno.EAGAIN, errno.EBUSY}:
        return f"{path} is in use by another program: close that program"
    return (
        f"{path} is no serial port that works ({os.strerror(number) if number else 'not a terminal'}): check its name"
    )


def _connect(url: str) -> _Wire:
    try:
        parts = urlsplit(url)
        address = (parts.hostname or "", parts.port or 0)
        wire = socket.create_connection(address, timeout=CONNECT_WITHIN_S)
    except (OSError, ValueError) as fault:
        raise NoMachine(f"{url} does not answer ({fault}): check the address, and that the machine is on") from fault
    wire.setblocking(False)
    wire.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return wire


class _Port:
    """A `Transport` on a file descriptor; its clock is the monotonic one."""

    def __init__(self, name: str, wire: _Wire, write_within_s: float) -> None:
        self._name, self._write_within_s = name, write_within_s
        self._wire: _Wire | None = wire
        self._fd = wire.fileno()
        self._woken, self._waker = os.pipe()
        os.set_blocking(self._woken, False)
        os.set_blocking(self._waker, False)
        self._closing = threading.Lock()

    @property
    def name(self) -> str:
        return self._name

    def now(self) -> float:
        return time.monotonic()

    def read(self, until: float | None) -> bytes:
        self._require_open()
        wait_s = None if until is None else max(0.0, until - self.now())
        readable, _, _ = select.select([self._fd, self._woken], [], [], wait_s)
        if self._woken in readable:
            os.read(self._woken, CHUNK_BYTES)
        return self._receive() if self._fd in readable else b""

    def write(self, data: bytes) -> None:
        self._require_open()
        rest = memoryview(data)
        while rest:
            rest = rest[self._send(rest) :]

    def wake(self) -> None:
        with self._closing:
            if self._wire is not None:
                # A full pipe will wake the reader just as well.
                with suppress(BlockingIOError):
                    os.write(self._waker, b"!")

    def close(self) -> None:
        with self._closing:
            wire, self._wire = self._wire, None
            if wire is None:
                return
            os.close(self._woken)
            os.close(self._waker)
            # The driver may refuse to restore a port that is gone.
            with suppress(OSError):
                wire.close()

    def _receive(self) -> bytes:
        try:
            data = os.read(self._fd, CHUNK_BYTES)
        except BlockingIOError:
            return b""
        except OSError as fault:
            raise self._gone() from fault
        if not data:
            # Readable but empty: the other end has hung up.
            raise self._gone()
        return data

    def _send(self, data: memoryview) -> int:
        try:
            return os.write(self._fd, data)
        except BlockingIOError:
            _, writable, _ = select.select([], [self._fd], [], self._write_within_s)
            if writable:
                return 0
            raise MachineFault(f"{self._name} takes no more bytes: switch the machine off and on") from None
        except OSError as fault:
            raise self._gone() from fault

    def _gone(self) -> Unplugged:
        return Unplugged(f"{self._name} has been unplugged: plug the machine in again")

    def _require_open(self) -> None:
        if self._wire is None:
            raise MachineFault(f"{self._name} has been closed: open it again")
