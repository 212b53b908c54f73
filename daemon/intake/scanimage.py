"""scanimage as a child: what it is asked, the lines it prints, and how it ended. It never outlives its caller."""

from __future__ import annotations

import os
import selectors
import signal
import subprocess
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass

from daemon.intake.sane import ScannerTrouble

PROGRAM = "scanimage"
STOP_WITHIN_S = 5.0
"""How long it may take to obey SIGINT, then SIGTERM; SIGKILL is not asked."""
_STOPS = (signal.SIGINT, signal.SIGTERM, signal.SIGKILL)
"""SIGINT first: only then the scanner is told to stop and parts of pages are removed."""
_LAST_WORDS_BYTES = 4096
_CHUNK_BYTES = 65536


@dataclass(frozen=True, slots=True)
class Exit:
    """How it ended. code: SANE's status, or minus the signal that ended it. words: the last it said on stderr."""

    code: int
    words: str
    overdue: bool = False
    """It printed nothing for too long, and was stopped."""
    stopped: bool = False
    """Somebody called `stop`."""


class Scanimage:
    """Runs scanimage, once at a time. `stop` may be called from any thread."""

    def __init__(self, *, program: str = PROGRAM, stop_within_s: float = STOP_WITHIN_S) -> None:
        self._program, self._stop_within_s = program, stop_within_s
        self._woken, self._waker = os.pipe()
        os.set_blocking(self._woken, False)

    def stop(self) -> None:
        """Break off what runs, or what is begun next."""
        os.write(self._waker, b"!")

    def forget_stops(self) -> None:
        """What is begun next runs, whatever was stopped before."""
        with suppress(BlockingIOError):
            os.read(self._woken, _CHUNK_BYTES)

    def close(self) -> None:
        os.close(self._woken)
        os.close(self._waker)

    def run(self, arguments: Sequence[str], *, line: Callable[[str], None], line_within_s: float) -> Exit:
        """Run it to its end, however that comes; `line` is told each line that it prints.

        line_within_s: after so long without a line it is stopped. Whatever `line` raises stops it, too.
        Raises ScannerTrouble when there is no such program.
        """
        with _closing_pipes(self._started(arguments)) as child:
            try:
                return self._heard(child, line, line_within_s)
            finally:
                self._end(child)

    def _started(self, arguments: Sequence[str]) -> subprocess.Popen[bytes]:
        try:
            return subprocess.Popen(
                [self._program, *arguments],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                env=os.environ | {"LC_ALL": "C"},
                process_group=0,
            )
        except OSError as error:
            raise ScannerTrouble(
                f"{self._program} cannot be started ({error.strerror}): install the package sane-utils"
            ) from None

    def _heard(self, child: subprocess.Popen[bytes], line: Callable[[str], None], line_within_s: float) -> Exit:
        heard, ended = _Heard(child, line), os.pidfd_open(child.pid)
        try:
            overdue, stopped = self._wait(heard, ended, line_within_s)
        finally:
            os.close(ended)
        code = self._end(child)
        heard.hear()
        return Exit(code, heard.words, overdue=overdue, stopped=stopped)

    def _wait(self, heard: _Heard, ended: int, line_within_s: float) -> tuple[bool, bool]:
        """Until it has ended; or it is overdue, or to be stopped: (overdue, stopped)."""
        due_s = time.monotonic() + line_within_s
        with selectors.DefaultSelector() as selector:
            for source in (heard.out, heard.err, self._woken, ended):
                selector.register(source, selectors.EVENT_READ)
            while True:
                ready = {key.fd for key, _ in selector.select(max(0.0, due_s - time.monotonic()))}
                if heard.hear():
                    due_s = time.monotonic() + line_within_s
                if ready & {ended, self._woken}:
                    return False, ended not in ready
                if time.monotonic() >= due_s:
                    return True, False
                # What is closed would be ready for ever.
                for source in heard.closed & set(selector.get_map()):
                    selector.unregister(source)

    def _end(self, child: subprocess.Popen[bytes]) -> int:
        """Stop it if it still runs, and everything that it has started. Returns its exit code."""
        if child.returncode is None:
            for number in _STOPS:
                if _ended_within(child, 0.0):
                    break
                os.killpg(child.pid, number)
                _ended_within(child, self._stop_within_s)
            # While it has not been waited for, its group is no other's.
            os.killpg(child.pid, signal.SIGKILL)
            child.wait()
        return child.returncode


class _Heard:
    """What comes out of the child: whole lines are told, the last words are kept."""

    def __init__(self, child: subprocess.Popen[bytes], line: Callable[[str], None]) -> None:
        assert child.stdout
        assert child.stderr
        self._line = line
        self.out, self.err = child.stdout.fileno(), child.stderr.fileno()
        self.closed: set[int] = set()
        self._rest, self._last = b"", b""
        for source in (self.out, self.err):
            os.set_blocking(source, False)

    @property
    def words(self) -> str:
        return self._last.decode("utf-8", "replace").strip()

    def hear(self) -> bool:
        """Take what is there. True when lines came."""
        self._last = (self._last + self._read(self.err))[-_LAST_WORDS_BYTES:]
        *lines, self._rest = (self._rest + self._read(self.out)).split(b"\n")
        for line in lines:
            self._line(os.fsdecode(line))
        return bool(lines)

    def _read(self, source: int) -> bytes:
        data = b""
        while source not in self.closed:
            try:
                chunk = os.read(source, _CHUNK_BYTES)
            except BlockingIOError:
                break
            if not chunk:
                self.closed.add(source)
            data += chunk
        return data


@contextmanager
def _closing_pipes(child: subprocess.Popen[bytes]) -> Iterator[subprocess.Popen[bytes]]:
    try:
        yield child
    finally:
        for pipe in (child.stdout, child.stderr):
            if pipe:
                pipe.close()


def _ended_within(child: subprocess.Popen[bytes], seconds: float) -> bool:
    """Whether it has ended after so long; it is not waited for, so that its number stays its own."""
    ended = os.pidfd_open(child.pid)
    try:
        with selectors.DefaultSelector() as selector:
            selector.register(ended, selectors.EVENT_READ)
            return bool(selector.select(seconds))
    finally:
        os.close(ended)
