"""What the daemon tells: the log, each job's own log, and status.json, for people and programs that only read files."""

from __future__ import annotations

import contextlib
import json
import logging
import logging.handlers
import os
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from daemon.errors import DiskTrouble

LOG_NAME = "linedrawd.log"
JOB_LOG_NAME = "job.log"
AT_MOST_EVERY_S = 1.0
_SYSLOG = {logging.ERROR: 3, logging.WARNING: 4}
_BUSY = ("drawing", "paused", "waiting", "held", "idle", "starting")
"""States of machines; the first one there is is told of all of them together."""


@dataclass(frozen=True, slots=True)
class MachineStatus:
    """What is told of one machine. `state` is one word, `reason` why it is so, `words` a sentence; seconds come
    from its time model.

    ink_m: metres that the pen has drawn; pen: says that it is worn. pen_in: what the pen is called that must be in.
    """

    state: str = "starting"
    reason: str = ""
    words: str = ""
    firmware: str = ""
    port: str = ""
    job: str = ""
    picture: str = ""
    strokes_done: int = 0
    strokes_total: int = 0
    percent: float = 0.0
    seconds_left: float | None = None
    held: str = ""
    feed_percent: int = 100
    ink_m: float = 0.0
    pen: str = ""
    pen_in: str = ""


@dataclass(frozen=True, slots=True)
class Status(MachineStatus):
    """What status.json holds.

    machines: each machine, by name. With one machine the fields beside it tell the same of that one; with several
    only `state`, that of the busiest, and `words`, a few of each. recording: the file of --record.
    """

    pid: int = 0
    machine: str = ""
    stage: str = ""
    planning: str = ""
    jobs_queued: int = 0
    jobs_waiting: int = 0
    jobs_to_approve: int = 0
    last_error: str = ""
    recording: str = ""
    changed: str = ""
    machines: Mapping[str, MachineStatus] = field(default_factory=dict)


class StatusBoard:
    """The present status, written to its file when it has changed, at most once a second.

    `change` may be called from any thread; `run` is the thread that writes, `tick` one turn of it.
    """

    def __init__(self, path: Path, *, wall: Callable[[], float] = time.time) -> None:
        self._path, self._wall = path, wall
        self._lock, self._changed, self._stopped = threading.Lock(), threading.Event(), threading.Event()
        self._status, self._written, self._due_s = Status(pid=os.getpid()), Status(), float("-inf")
        self.told: Callable[[Status], None] = lambda status: None
        """Called with each status that has been written, in the thread that writes."""

    @property
    def now(self) -> Status:
        with self._lock:
            return self._status

    def change(self, **values: Any) -> None:
        """A new state has its own reason, or none."""
        if "state" in values:
            values = {"reason": ""} | values
        with self._lock:
            self._status = replace(self._status, **values)
        self._changed.set()

    def change_machine(self, machine: str, **values: Any) -> None:
        """What is told of this machine; the first call makes it known. A new state has its own reason, or none."""
        if "state" in values:
            values = {"reason": ""} | values
        with self._lock:
            known = self._status.machines
            machines = {**known, machine: replace(known.get(machine, MachineStatus()), **values)}
            above = values if len(machines) == 1 else _of_several(machines)
            self._status = replace(self._status, machine=", ".join(machines), machines=machines, **above)
        self._changed.set()

    def tick(self, now: float) -> float:
        """Write what has changed, if its time has come. Returns the seconds until the next file may be written."""
        if now < self._due_s:
            return self._due_s - now
        self._changed.clear()
        status = self.now
        if status != self._written:
            self._written, self._due_s = status, now + AT_MOST_EVERY_S
            self._write(status)
            self.told(status)
        return max(0.0, self._due_s - now)

    def _write(self, status: Status) -> None:
        text = json.dumps(asdict(status) | {"changed": clock(self._wall())}, indent=1, ensure_ascii=False)
        part = self._path.with_suffix(".json.part")
        try:
            part.write_text(text + "\n", encoding="utf-8")
            part.replace(self._path)
        except OSError as error:
            logging.getLogger("linedrawd").error(
                "%s", f"{self._path} cannot be written ({error.strerror}): free the disk"
            )

    def run(self) -> None:
        """Until `stop`; the last status is always written."""
        while not self._stopped.is_set():
            self._changed.wait()
            self._stopped.wait(self.tick(time.monotonic()))
        self._due_s = float("-inf")
        self.tick(time.monotonic())

    def stop(self) -> None:
        self._stopped.set()
        self._changed.set()


def _of_several(machines: Mapping[str, MachineStatus]) -> dict[str, Any]:
    """The fields that tell of all machines: of one that was there before the others nothing is left in them."""
    states = {each.state for each in machines.values()}
    busiest = next((state for state in _BUSY if state in states), min(states))
    words = ", ".join(f"{name}: {in_words(each)}" for name, each in machines.items())
    return asdict(MachineStatus()) | {"state": busiest, "words": words}


def in_words(machine: MachineStatus) -> str:
    """What one machine does, in a line."""
    if machine.strokes_total:
        drawn = f"{machine.strokes_done} of {machine.strokes_total} strokes, {machine.percent:.0f} %"
        said = [f"{machine.state} {machine.picture}: {drawn}", machine.words]
    else:
        said = [machine.state, machine.words]
    return ", ".join(words for words in said if words)


class Diary:
    """Says events: one line each in linedrawd.log and, where it concerns a job, in that job's own log.

    Lines read `time LEVEL job words key=value ...`; a job is `-` where there is none. Both files may be moved away by
    whoever rotates them.
    """

    def __init__(
        self, log_dir: Path, jobs_dir: Path, *, to_stderr: bool = False, log_mb: float = 10.0, log_files: int = 4
    ) -> None:
        """log_mb: a log of this size is set aside, and log_files such are kept; a job's own log ends there."""
        self._jobs_dir, self._limit_bytes = jobs_dir, int(log_mb * 1e6)
        self._log = logging.getLogger("linedrawd")
        self._log.setLevel(logging.INFO)
        self._log.propagate = False
        self._handlers: list[logging.Handler] = [_file_handler(log_dir, self._limit_bytes, log_files)]
        self._handlers[0].setFormatter(_Line())
        if to_stderr:
            self._handlers.append(logging.StreamHandler())
            self._handlers[1].setFormatter(_JournalLine() if _stderr_is_the_journal() else _Line())
        for handler in self._handlers:
            self._log.addHandler(handler)

    def say(self, words: str, *, job: str = "", level: int = logging.INFO, **values: Any) -> None:
        """May be called from any thread. A disk that takes no log stops nothing."""
        said = " ".join([words, *(f"{key}={_value(value)}" for key, value in values.items())])
        record = self._log.makeRecord("linedrawd", level, "", 0, said, (), None, extra={"job": job})
        self._log.handle(record)
        if job:
            self._say_in_folder(job, _Line().format(record))

    def _say_in_folder(self, job: str, line: str) -> None:
        try:
            with (self._jobs_dir / job / JOB_LOG_NAME).open("a", encoding="utf-8") as file:
                if file.tell() < self._limit_bytes:
                    file.write(line + "\n")
        except OSError as error:
            self._log.error(f"the log of the job cannot be written ({error.strerror})", extra={"job": job})

    def close(self) -> None:
        for handler in self._handlers:
            self._log.removeHandler(handler)
            handler.close()


class _BoundedFile(logging.handlers.WatchedFileHandler):
    """A log file that may be moved away, and that moves itself away where it is full: NAME.1, NAME.2, ..."""

    def __init__(self, path: Path, limit_bytes: int, files: int) -> None:
        super().__init__(path, encoding="utf-8", errors="backslashreplace")
        self._path, self._limit_bytes, self._files = path, limit_bytes, files

    def emit(self, record: logging.LogRecord) -> None:
        # Before the line is written: a line that has been said is never only in a file that is about to go.
        with contextlib.suppress(OSError):
            if self._path.stat().st_size >= self._limit_bytes:
                self._set_aside()
        super().emit(record)

    def _set_aside(self) -> None:
        aside = [self._path.with_name(f"{self._path.name}.{number}") for number in range(1, self._files + 1)]
        for older, newer in zip(reversed(aside), [*reversed(aside[:-1]), self._path], strict=True):
            with contextlib.suppress(FileNotFoundError):
                newer.replace(older)


def _file_handler(log_dir: Path, limit_bytes: int, files: int) -> logging.Handler:
    try:
        log_dir.mkdir(parents=True, exist_ok=True)
        return _BoundedFile(log_dir / LOG_NAME, limit_bytes, files)
    except OSError as error:
        raise DiskTrouble(
            f"{log_dir / LOG_NAME} cannot be written ({error.strerror}): give another --log-dir"
        ) from None


class _Line(logging.Formatter):
    def format(self, record: logging.LogRecord) -> str:
        text = record.getMessage()
        if record.exc_info:
            text += " " + self.formatException(record.exc_info)
        words = " ".join(text.split())
        return f"{clock(record.created)} {record.levelname} {getattr(record, 'job', '') or '-'} {words}"


class _JournalLine(_Line):
    """The same line, behind its level in syslog's numbers, which systemd takes off again (man sd-daemon)."""

    def format(self, record: logging.LogRecord) -> str:
        return f"<{_SYSLOG.get(record.levelno, 6)}>{super().format(record)}"


def _stderr_is_the_journal() -> bool:
    """As JOURNAL_STREAM says, which also the children of a service inherit whose stderr leads elsewhere."""
    with contextlib.suppress(OSError):
        stderr = os.fstat(2)
        return os.environ.get("JOURNAL_STREAM") == f"{stderr.st_dev}:{stderr.st_ino}"
    return False


def clock(at_s: float) -> str:
    """Seconds since 1970 as `2026-11-24T08:00:00Z`."""
    return time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(at_s))


def _value(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.3g}" if abs(value) < 100 else f"{value:.0f}"
    text = str(value)
    return json.dumps(text, ensure_ascii=False) if not text or set(text) & set(' "=\\') else text
