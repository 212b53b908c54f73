"""Everything that a session hears, says and is asked, with its time, in a text file; and that file read again.

A recording is lines of `TIME KIND JSON`. TIME is the transport's clock in s, exact. The kinds:

    open       an object: the settings of the machine; what follows is a conversation of its own
    <          a text: bytes from the machine, a character a byte
    >          a text: bytes to the machine
    event      a text: what the session said about it; for people, replaying finds it anew
    start      a list of [line, stroke]: a job begins
    stop       null; so are resume, home and unplugged
    pause      true or false: whether at once
    feed       a number: percent
    full       null: the file has reached its limit, and nothing follows
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, TypeAlias, get_args

from daemon.errors import DiskTrouble, LinedrawError
from firmware_protocol.session import Event, JobLine

Kind: TypeAlias = Literal[
    "open", "<", ">", "event", "start", "stop", "pause", "resume", "feed", "home", "unplugged", "full"
]

LIMIT_BYTES = 64 << 20
"""About an hour of drawing at full speed."""


@dataclass(frozen=True, slots=True)
class Entry:
    """One line of a recording."""

    at_s: float
    kind: Kind
    value: Any


class Recorder:
    """Writes the file, which is emptied first. A disk that takes no more ends the recording, never the drawing.

    Raises DiskTrouble when the file cannot be made.
    """

    def __init__(self, path: Path, *, limit_bytes: int = LIMIT_BYTES) -> None:
        try:
            self._file = path.open("w", encoding="ascii", buffering=1)
        except OSError as error:
            raise DiskTrouble(f"{path} cannot be written ({error.strerror}): record into another place") from None
        self._left_bytes, self._full = limit_bytes, False

    def opened(self, now: float, settings: dict[str, Any]) -> None:
        """A port is open, and a conversation begins."""
        self._write(now, "open", settings)

    def turned(self, now: float, heard: bytes, said: bytes, events: Sequence[Event]) -> None:
        """One turn of the loop; one in which nothing happened leaves no line."""
        if heard:
            self._write(now, "<", heard.decode("latin-1"))
        for event in events:
            self._write(now, "event", repr(event))
        if said or (events and not heard):
            self._write(now, ">", said.decode("latin-1"))

    def started(self, now: float, lines: Sequence[JobLine]) -> None:
        """A job is begun."""
        self._write(now, "start", [[line.text, line.stroke] for line in lines])

    def asked(self, now: float, kind: Kind, value: int | None = None) -> None:
        """The session is asked to stop, pause, resume, home, change its feeds, or told that it is unplugged."""
        self._write(now, kind, value)

    def close(self) -> None:
        with suppress(OSError):
            self._file.close()

    def _write(self, now: float, kind: Kind, value: object) -> None:
        if self._full:
            return
        line = f"{now!r} {kind} {json.dumps(value)}\n"
        self._left_bytes -= len(line)
        if self._left_bytes < 0:
            self._full, line = True, f"{now!r} full null\n"
        try:
            self._file.write(line)
        except OSError:
            self._full = True


def read_recording(path: Path) -> Iterator[Entry]:
    """The lines of a recording, in order. Raises LinedrawError for what cannot be read, with the number of the line."""
    try:
        with path.open(encoding="ascii") as file:
            for number, line in enumerate(file, 1):
                yield _entry(line, f"{path}, line {number}")
    except (OSError, UnicodeDecodeError) as error:
        raise LinedrawError(f"{path} cannot be read ({error}): give a file that --record has written") from None


def _entry(line: str, place: str) -> Entry:
    try:
        time, kind, value = line.split(" ", 2)
        if kind not in get_args(Kind):
            raise ValueError(f"there is no kind {kind!r}")
        return Entry(float(time), kind, json.loads(value))  # type: ignore[arg-type]
    except ValueError as error:
        raise LinedrawError(f"{place} is no line of a recording ({error}): give a file of --record") from None
