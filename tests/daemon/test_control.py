"""The control socket answers whoever speaks properly, whatever the others do."""

from __future__ import annotations

import os
import resource
import socket
import tempfile
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from threading import Thread

import pytest

from daemon.control import LINE_BYTES, ControlServer, NotAllowed, Order, give_order
from daemon.errors import DiskTrouble, LinedrawError

NOBODY = 65534


def obey(order: Order) -> str:
    if order.order == "cancel":
        raise LinedrawError(f"there is no job {order.job}: list them")
    return f"done: {order.order}"


@pytest.fixture
def path(tmp_path: Path) -> Iterator[Path]:
    server = ControlServer(tmp_path / "c.sock", obey)
    thread = Thread(target=server.run)
    thread.start()
    yield tmp_path / "c.sock"
    server.stop()
    thread.join(10)
    assert not (tmp_path / "c.sock").exists()


def say(path: Path, data: bytes) -> bytes:
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as connection:
        connection.settimeout(10)
        connection.connect(str(path))
        try:
            connection.sendall(data)
            return connection.makefile("rb").readline()
        except ConnectionError:
            return b"closed"


def test_an_order_is_obeyed_and_answered(path: Path) -> None:
    assert give_order(path, Order(order="next")) == "done: next"


def test_a_refusal_comes_back_as_its_sentence(path: Path) -> None:
    with pytest.raises(LinedrawError, match="there is no job 7: list them"):
        give_order(path, Order(order="cancel", job="7"))


@pytest.mark.parametrize(
    "garbage", [b"\n", b"nonsense\n", b'{"order": "explode"}\n', b'{"order": "next", "x": 1}\n', b"\xff\xfe\n", b"[]\n"]
)
def test_garbage_is_refused_and_the_next_order_is_obeyed(path: Path, garbage: bytes) -> None:
    assert b'"ok":false' in say(path, garbage)
    assert give_order(path, Order(order="ping")) == "done: ping"


def test_a_line_that_is_too_long_is_cut_off(path: Path) -> None:
    said = say(path, b"x" * (LINE_BYTES * 200))
    assert said == b"closed" or b"4096 bytes at most" in said
    assert give_order(path, Order(order="ping")) == "done: ping"


def test_of_a_line_of_a_gigabyte_only_the_beginning_is_taken(path: Path) -> None:
    sent, much = 0, b"x" * 2**16
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as connection, suppress(ConnectionError):
        connection.settimeout(10)
        connection.connect(str(path))
        while sent < 10**9:
            sent += connection.send(much)
    assert sent < 10**7
    assert give_order(path, Order(order="ping")) == "done: ping"


@pytest.fixture
def many_files() -> Iterator[None]:
    """More files may be open than is usual."""
    before, most = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))
    yield
    resource.setrlimit(resource.RLIMIT_NOFILE, (before, most))


@pytest.mark.usefixtures("many_files")
def test_a_thousand_who_say_nothing_keep_nobody_out(path: Path) -> None:
    idle = []
    for _ in range(1000):
        connection = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        connection.connect(str(path))
        idle.append(connection)
    assert give_order(path, Order(order="ping")) == "done: ping"
    idle[0].settimeout(10)
    assert idle[0].recv(1) == b""
    for connection in idle:
        connection.close()


def test_an_order_waits_where_there_is_no_room_to_be_let_in(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    server, idle = ControlServer(tmp_path / "c.sock", obey), list[socket.socket]()
    thread = Thread(target=server.run)
    room = True
    while room:
        idle.append(socket.socket(socket.AF_UNIX, socket.SOCK_STREAM))
        idle[-1].setblocking(False)
        room = idle[-1].connect_ex(str(tmp_path / "c.sock")) == 0
    monkeypatch.setattr("daemon.control.time.sleep", lambda seconds: thread.ident or thread.start())
    assert give_order(tmp_path / "c.sock", Order(order="ping")) == "done: ping"
    for connection in idle:
        connection.close()
    server.stop()
    thread.join(10)


def test_an_order_in_pieces_is_obeyed(path: Path) -> None:
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as connection:
        connection.settimeout(10)
        connection.connect(str(path))
        for byte in b'{"order": "ping"}\n':
            connection.sendall(bytes([byte]))
        assert b"done: ping" in connection.makefile("rb").readline()


def test_only_the_owner_and_the_group_may_give_orders(path: Path) -> None:
    assert path.stat().st_mode & 0o777 == 0o660


@pytest.fixture
def as_nobody() -> Iterator[Path]:
    """A folder that everybody may look into; this process is then another user, in no group, where it was root."""
    before, root = (os.geteuid(), os.getegid(), os.getgroups()), os.geteuid() == 0
    with tempfile.TemporaryDirectory() as name:
        os.chmod(name, 0o755)
        server = ControlServer(Path(name) / "c.sock", obey)
        thread = Thread(target=server.run)
        thread.start()
        if root:
            os.setgroups([])
            os.setegid(NOBODY)
            os.seteuid(NOBODY)
        else:
            (Path(name) / "c.sock").chmod(0)
        yield Path(name)
        if root:
            os.seteuid(before[0])
            os.setegid(before[1])
            os.setgroups(before[2])
        server.stop()
        thread.join(10)


def test_a_user_outside_the_group_gives_no_order_and_is_told_how_to_come_in(as_nobody: Path) -> None:
    path = as_nobody / "c.sock"
    with pytest.raises(NotAllowed, match=rf"may not give orders at {path}: `sudo adduser USER {path.group()}`"):
        give_order(path, Order(order="stop"))


def test_without_a_daemon_the_order_fails_with_a_sentence(tmp_path: Path) -> None:
    with pytest.raises(LinedrawError, match=r"no daemon answers at .*--state-dir"):
        give_order(tmp_path / "none.sock", Order(order="stop"))


def test_a_folder_whose_name_is_too_long_for_a_socket_is_refused(tmp_path: Path) -> None:
    with pytest.raises(DiskTrouble, match="shorten the state folder"):
        ControlServer(tmp_path / ("x" * 120), obey)
