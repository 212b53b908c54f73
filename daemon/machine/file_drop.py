"""A folder that the control's PC reads as the way to a machine: a program is handed over whole, or not at all."""

from __future__ import annotations

import contextlib
import os
import threading
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from daemon.durable import sync_folder, whole_file
from daemon.errors import MachineFault, NoMachine
from daemon.shapes import Program
from firmware_protocol.emco.conversation import SETTLE_S
from firmware_protocol.emco.dialects import program_name
from firmware_protocol.emco.simulator.motion import line_times_s
from firmware_protocol.errors import ProtocolError
from firmware_protocol.ink import Polyline
from firmware_protocol.session import Ended, Event, Ready, Sent, Verdict

LINE_END = "\r\n"
"""The control's PC runs Windows; both controls take CR LF for the end of a block."""


class FileDrop:
    """A machine behind a folder: what is dropped there is drawn when the operator starts it, and nobody reports it.

    So `draw` tells `Sent` when the file is there and returns when the time model says that it would be drawn had the
    operator started it at once; its end is an estimate. replace: overwrite a program of the same name that differs.
    heard: is told every event, in the drawing thread. Only `stop` may be called from another thread.
    now, until_stopped: the clock, and how to wait so many seconds or until the event is set (True).
    """

    def __init__(
        self,
        folder: Path,
        *,
        heard: Callable[[Event], None],
        replace: bool = False,
        now: Callable[[], float] = time.monotonic,
        until_stopped: Callable[[threading.Event, float], bool] = threading.Event.wait,
    ) -> None:
        self._folder, self._heard, self._replace = folder, heard, replace
        self._now, self._until_stopped = now, until_stopped
        self._stop_asked = threading.Event()

    @property
    def name(self) -> str:
        """For people."""
        return f"file://{self._folder}"

    def now(self) -> float:
        """Seconds on the clock."""
        return self._now()

    def connect(self) -> Ready:
        """Look whether the folder can be written. Raises NoMachine when it cannot."""
        if fault := self._fault():
            raise NoMachine(fault)
        ready = Ready("a folder that a control reads", 0)
        self._heard(ready)
        return ready

    def draw(self, program: Program) -> Ended:
        """Drop the program and wait as long as it takes to draw. Raises MachineFault when it is none for a control."""
        texts = tuple(line.text for line in program.lines)
        try:
            dialect, name = program_name(texts)
            seconds = line_times_s(texts)[-1] + SETTLE_S
        except ProtocolError as fault:
            raise MachineFault(f"{self.name}: {fault}") from fault
        file = self._folder / dialect.file_name(name)
        data = "".join(text + LINE_END for text in texts).encode("ascii")
        try:
            end = self._draw(file, data, program.strokes, seconds)
        finally:
            self._stop_asked.clear()
        self._heard(end)
        return end

    def listen(self) -> None:
        """Look whether the folder is still there. Raises MachineFault when it is not."""
        if fault := self._fault():
            raise MachineFault(fault)

    def line_times_s(self, program: Program) -> Sequence[float]:
        """When each line will have been drawn, in s from the start; empty for a program that is none for a control."""
        try:
            return line_times_s([line.text for line in program.lines])
        except ProtocolError:
            return []

    def take_ink(self) -> list[Polyline] | None:
        """Nobody sees the sheet."""
        return None

    def stop(self) -> None:
        """Take the file back; what the control has begun it draws all the same. Returns at once."""
        self._stop_asked.set()

    def close(self) -> None:
        """Nothing is open."""

    def _draw(self, file: Path, data: bytes, strokes: int, seconds: float) -> Ended:
        if self._stop_asked.is_set():
            return _untouched(Verdict.STOPPED, "stopped on request before the program was handed over")
        if not self._replace and _holds_another(file, data):
            why = f"{file} is another program of the same name: move it away, or set another name"
            return _untouched(Verdict.REJECTED, why)
        try:
            _write_whole(file, data)
        except OSError as error:
            why = f"{file} cannot be written ({error.strerror}): mend the folder or its share"
            return _untouched(Verdict.UNPLUGGED, why)
        self._heard(Sent(seconds))
        if self._until_stopped(self._stop_asked, seconds):
            return _taken_back(file, data, strokes)
        why = f"{file} was handed over and, by the time model, drawn if it was started at once: look at the sheet"
        return Ended(Verdict.FINISHED, 0, strokes, True, True, why, estimated=True)

    def _fault(self) -> str:
        if not self._folder.is_dir():
            return f"{self._folder} is no folder: mount the share that the control reads, or correct the setting"
        if not os.access(self._folder, os.W_OK | os.X_OK):
            return f"{self._folder} cannot be written: correct its rights"
        return ""


def _untouched(verdict: Verdict, why: str) -> Ended:
    return Ended(verdict, 0, 0, position_known=True, pen_lifted=False, why=why)


def _taken_back(file: Path, data: bytes, strokes: int) -> Ended:
    """The control may have read the file already, and nobody knows whether it has."""
    with contextlib.suppress(OSError):
        if not _holds_another(file, data):
            file.unlink()
    why = f"stopped on request, {file} was taken back: if the control draws it already, press feed hold and RESET there"
    return Ended(Verdict.STOPPED, 0, strokes, position_known=False, pen_lifted=False, why=why)


def _holds_another(file: Path, data: bytes) -> bool:
    try:
        return file.read_bytes() != data
    except FileNotFoundError:
        return False
    except OSError:
        return True


def _write_whole(file: Path, data: bytes) -> None:
    """Replace the file by `data`: a control never sees a part of it. Raises OSError."""
    with whole_file(file) as stream:
        stream.write(data)
    with contextlib.suppress(OSError):  # Not every network share can do this.
        sync_folder(file.parent)
