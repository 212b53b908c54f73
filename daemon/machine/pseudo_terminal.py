"""A simulated machine on a pseudo terminal, in real time, for any sender that opens a serial port."""

from __future__ import annotations

import contextlib
import os
import pty
import select
import time
import tty
from pathlib import Path

from daemon.errors import SettingsError
from firmware_protocol.grbl.simulator.simulator import GrblSimulator

_LOOK_S = 0.01
"""How often to look for a client: the kernel wakes nobody when the other end is opened."""


def serve(simulator: GrblSimulator, link: Path, *, stop_fd: int) -> None:
    """Serve `simulator` at the symbolic link `link` until `stop_fd` becomes readable; then the link is removed.

    Each opening of the link is a DTR reset. The machine goes on when its client leaves.
    Raises SettingsError when the link cannot be made.
    """
    master, slave = pty.openpty()
    try:
        tty.setraw(slave)
        _make_link(link, os.ttyname(slave))
        os.close(slave)  # held open, it would hide from us that a client comes or goes
        os.set_blocking(master, False)
        try:
            _Terminal(simulator, master, stop_fd).run()
        finally:
            link.unlink(missing_ok=True)
    finally:
        os.close(master)


def _make_link(link: Path, target: str) -> None:
    try:
        if link.is_symlink():
            link.unlink()
        link.symlink_to(target)
    except OSError as error:
        raise SettingsError(f"{link} cannot be made ({error.strerror}): choose a path that is free") from error


class _Terminal:
    def __init__(self, simulator: GrblSimulator, master: int, stop_fd: int) -> None:
        self._simulator, self._master, self._stop_fd = simulator, master, stop_fd
        self._started_s = time.monotonic()
        self._client = False

    def run(self) -> None:
        while not self._stop_asked():
            if self._has_client():
                self._exchange()
            else:
                self._client = False
                self._simulator.advance(self._now())

    def _now(self) -> float:
        return time.monotonic() - self._started_s

    def _stop_asked(self) -> bool:
        """Wait until there may be something to do, and say whether that is the end."""
        waiting: list[int] = [self._stop_fd]
        timeout = _LOOK_S
        if self._client:
            waiting.append(self._master)
            soonest = self._simulator.next_time()
            timeout = 1.0 if soonest is None else min(1.0, max(0.0, soonest - self._now()))
        return self._stop_fd in select.select(waiting, [], [], timeout)[0]

    def _has_client(self) -> bool:
        poll = select.poll()
        poll.register(self._master, select.POLLIN)
        return not any(event & select.POLLHUP for _, event in poll.poll(0))

    def _exchange(self) -> None:
        if not self._client:
            self._client = True
            self._simulator.open(self._now())
        with contextlib.suppress(OSError):  # nothing to read, or the client has just left
            self._simulator.receive(os.read(self._master, 4096), self._now())
        data = self._simulator.advance(self._now())
        if self._simulator.unplugged:
            return
        with contextlib.suppress(BlockingIOError):  # a client that does not read loses what the machine says
            os.write(self._master, data)
