"""The control socket of the running daemon: one JSON line in, one JSON line out."""

from __future__ import annotations

import json
import os
import selectors
import socket
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Literal, TypeAlias, get_args

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from daemon.errors import DiskTrouble, LinedrawError

LINE_BYTES = 4096
CONNECTIONS = 32
"""Beyond these the oldest is closed: whoever connects and says nothing keeps nobody else out."""
ANSWER_WITHIN_S = 15.0
MOVING_AT_ONCE = 8
MOVED_WITHIN_S = 900.0
"""Homing and a long frame take their time."""
_AGAIN_S = 0.02
_PATH_BYTES = 107
"""sun_path, without its closing zero."""


MachineOrderName: TypeAlias = Literal["check", "home", "origin", "park", "frame", "pen up", "pen down", "jog"]
MACHINE_ORDERS: tuple[MachineOrderName, ...] = get_args(MachineOrderName)
"""These are obeyed by the machine itself, between two drawings."""


PersonOrderName: TypeAlias = Literal[
    "ping",
    "scan",
    "next",
    "stop",
    "go",
    "drain",
    "cancel",
    "retry",
    "again",
    "approve",
    "pause",
    "resume",
    "feed",
]


class Order(BaseModel):
    """What a person wants.

    job: of cancel, retry, again, approve and frame, and of a resume `from_stroke`. at_once: of pause. x_mm, y_mm: of
    jog. seconds: of pen down. percent: of feed. machine: the one that is meant, where there are several.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    order: PersonOrderName | MachineOrderName
    job: str = Field(default="", max_length=200)
    machine: str = Field(default="", max_length=32)
    from_stroke: int | None = Field(default=None, ge=0, le=10**7)
    at_once: bool = False
    percent: int = Field(default=100, ge=10, le=200)
    x_mm: float = Field(default=0.0, ge=-10000, le=10000)
    y_mm: float = Field(default=0.0, ge=-10000, le=10000)
    seconds: float = Field(default=10.0, gt=0, le=600)

    @property
    def moves(self) -> bool:
        """It takes as long as the machine, or the scanner, does."""
        return self.order in MACHINE_ORDERS or self.order == "scan"


class NoDaemon(LinedrawError):
    """Nobody answers at the control socket."""


class NotAllowed(LinedrawError):
    """There is a control socket, for others than this user."""


class Answer(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)

    ok: bool
    words: str


class ControlServer:
    """Answers on a Unix socket until `stop`; `obey` says what was done or raises LinedrawError.

    One thread listens. An order that moves the machine has a thread of its own, so that `stop` is heard meanwhile.
    """

    def __init__(self, path: Path, obey: Callable[[Order], str]) -> None:
        """Only for the one daemon of a state folder: an old socket in the way is removed. Raises DiskTrouble."""
        self._path, self._obey = path, obey
        self._socket = _bound(path)
        self._wake_read, self._wake_write = os.pipe()
        self._selector = selectors.DefaultSelector()
        self._selector.register(self._socket, selectors.EVENT_READ)
        self._selector.register(self._wake_read, selectors.EVENT_READ)
        self._said: dict[socket.socket, bytes] = {}
        self._moving: list[threading.Thread] = []

    def run(self) -> None:
        while True:
            for key, _ in self._selector.select():
                if key.fileobj == self._wake_read:
                    return self._close()
                if key.fileobj is self._socket:
                    self._accept()
                elif isinstance(key.fileobj, socket.socket) and key.fileobj in self._said:
                    self._hear(key.fileobj)

    def stop(self) -> None:
        os.write(self._wake_write, b"x")

    def _accept(self) -> None:
        connection, _ = self._socket.accept()
        connection.setblocking(False)
        self._said[connection] = b""
        self._selector.register(connection, selectors.EVENT_READ)
        if len(self._said) > CONNECTIONS:
            self._drop(next(iter(self._said)))

    def _hear(self, connection: socket.socket) -> None:
        try:
            data = connection.recv(LINE_BYTES)
        except OSError:
            data = b""
        self._said[connection] += data
        line, newline, _ = self._said[connection].partition(b"\n")
        if newline or len(line) >= LINE_BYTES:
            self._answer(connection, line, whole=bool(newline))
        elif not data:
            self._drop(connection)

    def _answer(self, connection: socket.socket, line: bytes, *, whole: bool) -> None:
        order = _order(line) if whole else Answer(ok=False, words=f"an order has {LINE_BYTES} bytes at most")
        del self._said[connection]
        self._selector.unregister(connection)
        if isinstance(order, Order) and order.moves:
            self._answer_later(connection, order)
        else:
            _say(connection, order if isinstance(order, Answer) else _obeyed(order, self._obey))

    def _answer_later(self, connection: socket.socket, order: Order) -> None:
        self._moving = [thread for thread in self._moving if thread.is_alive()]
        if len(self._moving) >= MOVING_AT_ONCE:
            return _say(connection, Answer(ok=False, words="the machine is busy with other orders: wait for them"))
        act = threading.Thread(target=lambda: _say(connection, _obeyed(order, self._obey)), daemon=True, name="order")
        self._moving.append(act)
        act.start()

    def _drop(self, connection: socket.socket) -> None:
        del self._said[connection]
        self._selector.unregister(connection)
        connection.close()

    def _close(self) -> None:
        for connection in list(self._said):
            self._drop(connection)
        self._selector.close()
        self._socket.close()
        self._path.unlink(missing_ok=True)
        os.close(self._wake_read)
        os.close(self._wake_write)
        for thread in self._moving:
            thread.join(ANSWER_WITHIN_S)


def _order(line: bytes) -> Order | Answer:
    try:
        return Order.model_validate_json(line)
    except ValidationError as error:
        return Answer(ok=False, words=f"no order that is known here ({error.errors()[0]['msg']})")


def _obeyed(order: Order, obey: Callable[[Order], str]) -> Answer:
    try:
        return Answer(ok=True, words=obey(order))
    except LinedrawError as error:
        return Answer(ok=False, words=str(error))


def _say(connection: socket.socket, answer: Answer) -> None:
    with connection, suppress(OSError):
        connection.settimeout(ANSWER_WITHIN_S)
        connection.sendall(answer.model_dump_json().encode() + b"\n")


def _bound(path: Path) -> socket.socket:
    _check_length(path)
    server = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    try:
        path.unlink(missing_ok=True)
        server.bind(str(path))
        # Whoever may drop pictures (the group) may also say that the sheet is in; nobody else.
        path.chmod(0o660)
        server.listen(CONNECTIONS)
        server.setblocking(False)
    except OSError as error:
        server.close()
        raise DiskTrouble(f"the control socket {path} cannot be made ({error.strerror}): correct its folder") from None
    return server


def _check_length(path: Path) -> None:
    if len(os.fsencode(path)) > _PATH_BYTES:
        raise DiskTrouble(
            f"the control socket {path} has a name of more than {_PATH_BYTES} bytes: shorten the state folder"
        )


def give_order(path: Path, order: Order) -> str:
    """Ask the running daemon. Returns what it says.

    Raises LinedrawError when it refuses, NoDaemon when none runs, NotAllowed when this user may not ask it.
    """
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as connection:
        connection.settimeout(MOVED_WITHIN_S if order.moves else ANSWER_WITHIN_S)
        try:
            _connect(connection, path)
            connection.sendall(order.model_dump_json().encode() + b"\n")
            said = connection.makefile("rb").readline()
            answer = Answer.model_validate(json.loads(said))
        except PermissionError:
            raise NotAllowed(
                f"you may not give orders at {path}: `sudo adduser USER {_group(path)}` and log in again"
            ) from None
        except (OSError, ValueError) as error:
            raise NoDaemon(f"no daemon answers at {path} ({error}): start it, or give its --state-dir") from None
    if not answer.ok:
        raise LinedrawError(answer.words)
    return answer.words


def _group(path: Path) -> str:
    """Of those who may give orders; where that cannot be seen, the one that the package makes."""
    try:
        return path.group()
    except (OSError, KeyError):
        return "linedrawd"


def _connect(connection: socket.socket, path: Path) -> None:
    """Where so many wait to be let in that there is no room to wait, it is tried again. Raises OSError."""
    until = time.monotonic() + ANSWER_WITHIN_S
    while True:
        try:
            return connection.connect(str(path))
        except BlockingIOError:
            if time.monotonic() > until:
                raise
            time.sleep(_AGAIN_S)
