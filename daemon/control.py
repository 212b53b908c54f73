"""The control socket of the running daemon: one JSON line in, one JSON line out."""

from __future__ import annotations

import json
import os
import selectors
import socket
from collections.abc import Callable
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from daemon.errors import DiskTrouble, LinedrawError

LINE_BYTES = 4096
CONNECTIONS = 32
"""Beyond these the oldest is closed: whoever connects and says nothing keeps nobody else out."""
ANSWER_WITHIN_S = 15.0
_PATH_BYTES = 107
"""sun_path, without its closing zero."""


class Order(BaseModel):
    """What a person wants. `job` is for cancel only."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    order: Literal["ping", "next", "stop", "go", "cancel"]
    job: str = Field(default="", max_length=200)


class Answer(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)

    ok: bool
    words: str


class ControlServer:
    """Answers on a Unix socket until `stop`, in one thread; `obey` says what was done or raises LinedrawError."""

    def __init__(self, path: Path, obey: Callable[[Order], str]) -> None:
        """Only for the one daemon of a state folder: an old socket in the way is removed. Raises DiskTrouble."""
        self._path, self._obey = path, obey
        self._socket = _bound(path)
        self._wake_read, self._wake_write = os.pipe()
        self._selector = selectors.DefaultSelector()
        self._selector.register(self._socket, selectors.EVENT_READ)
        self._selector.register(self._wake_read, selectors.EVENT_READ)
        self._said: dict[socket.socket, bytes] = {}

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
        answer = (
            _obeyed(line, self._obey) if whole else Answer(ok=False, words=f"an order has {LINE_BYTES} bytes at most")
        )
        try:
            connection.send(answer.model_dump_json().encode() + b"\n")
        except OSError:
            pass
        finally:
            self._drop(connection)

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


def _obeyed(line: bytes, obey: Callable[[Order], str]) -> Answer:
    try:
        return Answer(ok=True, words=obey(Order.model_validate_json(line)))
    except ValidationError as error:
        return Answer(ok=False, words=f"no order that is known here ({error.errors()[0]['msg']})")
    except LinedrawError as error:
        return Answer(ok=False, words=str(error))


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
    """Ask the running daemon. Returns what it says; raises LinedrawError when it refuses or does not run."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as connection:
        connection.settimeout(ANSWER_WITHIN_S)
        try:
            connection.connect(str(path))
            connection.sendall(order.model_dump_json().encode() + b"\n")
            said = connection.makefile("rb").readline()
            answer = Answer.model_validate(json.loads(said))
        except (OSError, ValueError) as error:
            raise LinedrawError(f"no daemon answers at {path} ({error}): start it, or give its --state-dir") from None
    if not answer.ok:
        raise LinedrawError(answer.words)
    return answer.words
