"""The socket beside a simulated machine's terminal: one sentence in, one sentence out."""

from __future__ import annotations

import contextlib
import os
import socket
from pathlib import Path

from daemon.errors import MachineFault, NoMachine, SettingsError

SAID = "ok"
_SENTENCE_BYTES = 1000
_WITHIN_S = 0.5
"""Whoever connects and says nothing holds the machine's clock up for no longer."""
_ANSWER_WITHIN_S = 10.0


def socket_of(link: Path) -> Path:
    """Where the machine that is served at `link` listens."""
    return link.with_name(link.name + ".ctl")


def tell(link: Path, sentence: str) -> None:
    """Let something happen to the machine that is served at `link`.

    Raises NoMachine when none is, MachineFault when it does not understand the sentence.
    """
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as connection:
        connection.settimeout(_ANSWER_WITHIN_S)
        try:
            connection.connect(str(socket_of(link)))
            connection.sendall(sentence.encode() + b"\n")
            answer = connection.recv(_SENTENCE_BYTES * 4).decode()
        except OSError as error:
            start = f"linedrawd simulate grbl --pty {link}"
            raise NoMachine(f"no simulated machine listens beside {link} ({error}): start one with {start}") from error
    if answer != SAID:
        raise MachineFault(f"{link}: {answer or 'the machine was switched off'}")


class ControlSocket:
    """The machine's end. Only the user whom the machine belongs to can connect."""

    def __init__(self, link: Path) -> None:
        """A socket that an earlier run has left is replaced. Raises SettingsError when none can be made."""
        self._path = socket_of(link)
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            if self._path.is_socket():
                self._path.unlink()
            self._socket.bind(str(self._path))
            os.chmod(self._path, 0o600)  # before anybody can connect
            self._socket.listen()
        except OSError as error:
            self._socket.close()
            raise SettingsError(f"{self._path} cannot be made ({error}): choose another path for the link") from error

    def fileno(self) -> int:
        """Readable when somebody connects."""
        return self._socket.fileno()

    def sentence(self) -> tuple[str, socket.socket]:
        """Take one sentence; empty when nothing is said in time. The connection is for `answer`."""
        connection, _ = self._socket.accept()
        connection.settimeout(_WITHIN_S)
        try:
            return connection.recv(_SENTENCE_BYTES).decode("utf-8", "replace").strip(), connection
        except OSError:
            return "", connection

    @staticmethod
    def answer(connection: socket.socket, words: str) -> None:
        """Say what became of the sentence, to whoever still listens."""
        with connection, contextlib.suppress(OSError):
            connection.sendall(words.encode())

    def close(self) -> None:
        """Listen no more."""
        self._socket.close()
        self._path.unlink(missing_ok=True)
