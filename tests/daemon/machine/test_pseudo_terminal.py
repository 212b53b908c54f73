"""The simulated machine on a pseudo terminal, with a client that opens and closes it."""

from __future__ import annotations

import os
import select
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from daemon.errors import SettingsError
from daemon.machine.pseudo_terminal import serve
from firmware_protocol.grbl.simulator.simulator import GrblSimulator


@contextmanager
def served(simulator: GrblSimulator, link: Path) -> Iterator[None]:
    """Serve in a thread until the block ends."""
    stop_fd, stop = os.pipe()
    thread = threading.Thread(target=serve, args=(simulator, link), kwargs={"stop_fd": stop_fd})
    thread.start()
    try:
        ready = threading.Event()
        while thread.is_alive() and not link.exists():
            ready.wait(0.005)
        yield
    finally:
        os.write(stop, b"!")
        thread.join(5)
        os.close(stop)
        os.close(stop_fd)


@contextmanager
def client(link: Path) -> Iterator[int]:
    fd = os.open(link, os.O_RDWR | os.O_NOCTTY)
    try:
        yield fd
    finally:
        os.close(fd)


def read_until(fd: int, end: bytes) -> bytes:
    data = b""
    while not data.endswith(end) and select.select([fd], [], [], 5)[0]:
        data += os.read(fd, 100)
    return data


BANNER_END = b"for help]\r\n"


def test_each_opening_is_a_reset_to_position_zero(tmp_path: Path) -> None:
    link = tmp_path / "grbl"
    simulator = GrblSimulator(settings={120: 5000, 110: 30000})
    with served(simulator, link):
        with client(link) as fd:
            assert read_until(fd, BANNER_END) == b"\r\nGrbl 1.1h ['$' for help]\r\n"
            os.write(fd, b"G0X0.5\nG4P0\n")
            assert read_until(fd, b"ok\r\nok\r\n") == b"ok\r\nok\r\n"
            assert simulator.position_mm == pytest.approx((0.5, 0.0, 0.0), abs=0.004)
        pause = threading.Event()
        pause.wait(0.1)  # the other end is looked at every 10 ms
        with client(link) as fd:
            assert read_until(fd, BANNER_END) == b"\r\nGrbl 1.1h ['$' for help]\r\n"
            os.write(fd, b"?")
            assert b"<Idle|MPos:0.000" in read_until(fd, b">\r\n")


def test_what_the_machine_says_is_not_sent_back_to_it(tmp_path: Path) -> None:
    simulator = GrblSimulator()
    with served(simulator, tmp_path / "grbl"), client(tmp_path / "grbl") as fd:
        read_until(fd, BANNER_END)
        os.write(fd, b"\n")
        assert read_until(fd, b"ok\r\n") == b"ok\r\n"
        assert simulator.oks == 1


def test_the_link_is_gone_at_the_end(tmp_path: Path) -> None:
    link = tmp_path / "grbl"
    with served(GrblSimulator(), link):
        assert link.is_symlink()
    assert not link.is_symlink()


def test_a_link_of_an_earlier_run_is_replaced_and_a_file_is_not(tmp_path: Path) -> None:
    link, file = tmp_path / "grbl", tmp_path / "file"
    link.symlink_to("/nowhere")
    file.write_text("mine")
    with served(GrblSimulator(), link):
        assert os.readlink(link) != "/nowhere"
    with pytest.raises(SettingsError, match="choose a path that is free"):
        serve(GrblSimulator(), file, stop_fd=0)
    assert file.read_text() == "mine"
