"""A simulated machine on a pseudo terminal, in real time, for any sender that opens a serial port."""

from __future__ import annotations

import contextlib
import json
import os
import pty
import select
import time
import tty
from pathlib import Path

from daemon.errors import DiskTrouble, SettingsError
from daemon.machine.simulator_control import SAID, ControlSocket
from firmware_protocol.simulator import Eventful, Simulator

_LOOK_S = 0.01
"""How often to look for a client: the kernel wakes nobody when the other end is opened."""
_INK_TO = "ink to "


def serve(simulator: Simulator, link: Path, *, stop_fd: int) -> None:
    """Serve `simulator` at the symbolic link `link` until `stop_fd` becomes readable; then the link is removed.

    Each opening of the link is a DTR reset. The machine goes on when its client leaves. Beside the link it listens
    to `simulator_control.tell`. While it is unplugged there is no link, and its client reads the end of the file.
    Raises SettingsError when the link cannot be made.
    """
    control = ControlSocket(link)
    try:
        terminal = _Terminal(link)
        try:
            _Bench(simulator, terminal, control, stop_fd).run()
        finally:
            terminal.unplug()
    finally:
        control.close()


def write_ink(path: Path, simulator: Simulator) -> None:
    """What is on the sheet, and where the pen is (null where the simulator does not say), as JSON in mm, whole at once.

    Raises DiskTrouble when it cannot be written.
    """
    pen_mm = getattr(simulator, "position_mm", None)
    part = path.with_name(path.name + ".part")
    try:
        part.write_text(json.dumps({"polylines_mm": list(simulator.ink), "pen_mm": pen_mm}) + "\n", encoding="ascii")
        part.replace(path)
    except OSError as error:
        raise DiskTrouble(f"{path} cannot be written ({error.strerror}): choose another place for the ink") from error


class _Terminal:
    """The pseudo terminal and the link to it, plugged in from the start."""

    def __init__(self, link: Path) -> None:
        self._link = link
        self.master: int | None = None
        self.plug_in()

    def plug_in(self) -> None:
        self.master, slave = pty.openpty()
        try:
            tty.setraw(slave)
            _make_link(self._link, os.ttyname(slave))
        except SettingsError:
            os.close(self.master)
            raise
        finally:
            os.close(slave)  # held open, it would hide from us that a client comes or goes
        os.set_blocking(self.master, False)

    def unplug(self) -> None:
        if self.master is not None:
            self._link.unlink(missing_ok=True)
            os.close(self.master)
            self.master = None

    def has_client(self) -> bool:
        if self.master is None:
            return False
        poll = select.poll()
        poll.register(self.master, select.POLLIN)
        return not any(event & select.POLLHUP for _, event in poll.poll(0))

    def read(self) -> bytes:
        if self.master is not None:
            with contextlib.suppress(OSError):  # nothing to read, or the client has just left
                return os.read(self.master, 4096)
        return b""

    def write(self, data: bytes) -> None:
        if self.master is not None:
            with contextlib.suppress(BlockingIOError):  # a client that does not read loses what the machine says
                os.write(self.master, data)


def _make_link(link: Path, target: str) -> None:
    try:
        if link.is_symlink():
            link.unlink()
        link.symlink_to(target)
    except OSError as error:
        raise SettingsError(f"{link} cannot be made ({error.strerror}): choose a path that is free") from error


class _Bench:
    def __init__(self, simulator: Simulator, terminal: _Terminal, control: ControlSocket, stop_fd: int) -> None:
        self._simulator, self._terminal, self._control, self._stop_fd = simulator, terminal, control, stop_fd
        self._started_s = time.monotonic()
        self._client = False

    def run(self) -> None:
        while not self._stop_asked():
            if self._terminal.has_client():
                self._exchange()
            else:
                self._client = False
                self._simulator.advance(self._now())
            self._follow_plug()

    def _now(self) -> float:
        return time.monotonic() - self._started_s

    def _stop_asked(self) -> bool:
        """Wait until there may be something to do, and say whether that is the end."""
        waiting: list[int] = [self._stop_fd, self._control.fileno()]
        timeout = _LOOK_S
        if self._client and self._terminal.master is not None:
            waiting.append(self._terminal.master)
            soonest = self._simulator.next_time()
            timeout = 1.0 if soonest is None else min(1.0, max(0.0, soonest - self._now()))
        readable = select.select(waiting, [], [], timeout)[0]
        if self._control.fileno() in readable:
            self._listen()
        return self._stop_fd in readable

    def _listen(self) -> None:
        sentence, connection = self._control.sentence()
        self._control.answer(connection, self._happened(sentence))

    def _happened(self, sentence: str) -> str:
        if sentence.startswith(_INK_TO):
            return self._ink_to(Path(sentence.removeprefix(_INK_TO)))
        if not isinstance(self._simulator, Eventful):
            return "nothing can happen to this simulated machine at run time: ask for it when it is started"
        try:
            self._simulator.happen(sentence, self._now())
        except ValueError as error:
            return str(error)
        return SAID

    def _ink_to(self, path: Path) -> str:
        try:
            write_ink(path, self._simulator)
        except DiskTrouble as error:
            return str(error)
        return SAID

    def _exchange(self) -> None:
        if not self._client:
            self._client = True
            self._simulator.open(self._now())
        self._simulator.receive(self._terminal.read(), self._now())
        data = self._simulator.advance(self._now())
        if not self._simulator.unplugged:
            self._terminal.write(data)

    def _follow_plug(self) -> None:
        if self._simulator.unplugged:
            self._terminal.unplug()
            self._client = False
        elif self._terminal.master is None:
            self._terminal.plug_in()
