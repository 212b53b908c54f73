"""A socket of ours that hears what systemd would hear."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from contextlib import contextmanager

HEARD_WITHIN_S = 20.0


class Manager:
    def __init__(self, way: socket.socket, address: str) -> None:
        self._way, self.address = way, address
        way.settimeout(HEARD_WITHIN_S)

    def next(self) -> str:
        """The next message, which must come."""
        return self._way.recv(4096).decode()

    def until(self, wanted: str) -> list[str]:
        """Every message up to the first with this line."""
        heard = [self.next()]
        while wanted not in heard[-1].splitlines():
            heard.append(self.next())
        return heard

    def nothing(self) -> bool:
        """Nothing is there that has not been heard."""
        self._way.setblocking(False)
        try:
            return not self._way.recv(4096)
        except BlockingIOError:
            return True
        finally:
            self._way.settimeout(HEARD_WITHIN_S)


@contextmanager
def manager(address: str) -> Iterator[Manager]:
    """address: a path, or "@" and an abstract name."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as way:
        way.bind("\0" + address[1:] if address.startswith("@") else address)
        yield Manager(way, address)
