"""The simulated machine on a pseudo terminal, with a client that opens and closes it."""

from __future__ import annotations

import os
import select
import socket
import stat
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from daemon.errors import MachineFault, NoMachine, SettingsError
from daemon.machine.pseudo_terminal import serve
from daemon.machine.simulator_control import socket_of, tell
from firmware_protocol.grbl.simulator.simulator import GrblSimulator
from firmware_protocol.simulator import Simulator


@contextmanager
def served(simulator: Simulator, link: Path) -> Iterator[None]:
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


def test_a_sentence_beside_the_link_happens_to_the_machine(tmp_path: Path) -> None:
    link = tmp_path / "grbl"
    with served(GrblSimulator(settings={21: 1}), link), client(link) as fd:
        read_until(fd, BANNER_END)
        tell(link, "limit x closed")
        assert read_until(fd, b"ALARM:1\r\n") == b"ALARM:1\r\n"


def test_a_sentence_that_is_not_understood_is_answered_with_all_that_are(tmp_path: Path) -> None:
    link = tmp_path / "grbl"
    with (
        served(GrblSimulator(), link),
        pytest.raises(MachineFault, match="no event 'explode': write one of all inputs"),
    ):
        tell(link, "explode")


def test_only_its_own_user_reaches_the_machine_and_nothing_stays_behind(tmp_path: Path) -> None:
    link = tmp_path / "grbl"
    with served(GrblSimulator(), link):
        assert stat.S_IMODE(socket_of(link).stat().st_mode) == 0o600
    assert not socket_of(link).exists()
    with pytest.raises(NoMachine, match="linedrawd simulate grbl"):
        tell(link, "hang")


def test_whoever_connects_and_says_nothing_stops_no_machine(tmp_path: Path) -> None:
    link = tmp_path / "grbl"
    with served(GrblSimulator(), link), client(link) as fd, socket.socket(socket.AF_UNIX) as silent:
        silent.connect(str(socket_of(link)))
        assert read_until(fd, BANNER_END).endswith(BANNER_END)
        tell(link, "all inputs open")


def test_an_unplugged_machine_is_the_end_of_the_file_and_comes_back_reset(tmp_path: Path) -> None:
    link = tmp_path / "grbl"
    with served(GrblSimulator(), link):
        with client(link) as fd:
            read_until(fd, BANNER_END)
            tell(link, "unplug")
            assert select.select([fd], [], [], 5)[0] == [fd]
            assert ended(fd)
        assert not link.is_symlink()
        tell(link, "plug in")
        pause = threading.Event()
        while not link.is_symlink():
            pause.wait(0.005)
        with client(link) as fd:
            assert read_until(fd, BANNER_END).endswith(BANNER_END)


def ended(fd: int) -> bool:
    try:
        return os.read(fd, 100) == b""
    except OSError:
        return True


class Plain:
    """A simulated machine that nothing can happen to."""

    now, ink, unplugged = 0.0, (), False

    def open(self, now: float) -> None: ...

    def receive(self, data: bytes, now: float) -> None: ...

    def advance(self, now: float) -> bytes:
        return b""

    def next_time(self) -> float | None:
        return None


def test_a_machine_without_events_says_so(tmp_path: Path) -> None:
    link = tmp_path / "plain"
    with served(Plain(), link), pytest.raises(MachineFault, match="nothing can happen"):
        tell(link, "hang")
