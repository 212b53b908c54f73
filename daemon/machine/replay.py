"""A recording is fed to a session: the same bytes at the same times, so that it comes to the same events."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any, TypeAlias

from daemon.machine.link import obey
from daemon.machine.recorder import Entry
from daemon.shapes import ProgramLine
from firmware_protocol.errors import LocalProtocolError
from firmware_protocol.session import Event, Session


@dataclass(frozen=True, slots=True)
class Happened:
    """The session says something at a time of the recording. differs: what it sends now, and what it sent then."""

    at_s: float
    events: list[Event]
    differs: tuple[bytes, bytes] | None = None


Begin: TypeAlias = Callable[[dict[str, Any], float], tuple[Session, Callable[[float], None] | None]]
"""Makes the session of these settings at this time, and how it is asked to home, where it can be."""


@dataclass(slots=True)
class _Turn:
    """One turn of the link's loop."""

    at_s: float
    heard: bytes = b""
    said: bytes = b""
    over: bool = False


@dataclass(slots=True)
class Replay:
    """Feeds entries to the session that `begin` makes at each opening of the port."""

    begin: Begin
    _session: Session | None = None
    _home: Callable[[float], None] | None = None
    _turn: _Turn | None = field(default=None)

    def run(self, entries: Iterable[Entry]) -> Iterator[Happened]:
        """What the session says and does otherwise than it did, in order."""
        for entry in entries:
            if self._turn and not _belongs(entry, self._turn):
                yield from self._end_turn()
            if entry.kind in ("<", ">"):
                self._take(entry)
            elif entry.kind != "event":
                yield from self._ask(entry)
        yield from self._end_turn()

    def _take(self, entry: Entry) -> None:
        self._turn = self._turn or _Turn(entry.at_s)
        data = str(entry.value).encode("latin-1")
        if entry.kind == "<":
            self._turn.heard = data
        else:
            self._turn.said, self._turn.over = data, True

    def _end_turn(self) -> Iterator[Happened]:
        turn, self._turn = self._turn, None
        if turn is None or self._session is None:
            return
        session, at_s = self._session, turn.at_s
        events = [*session.receive(turn.heard, at_s), *session.expire(at_s)]
        said = session.data_to_send(at_s)
        differs = None if said == turn.said else (said, turn.said)
        if events or differs:
            yield Happened(at_s, events, differs)

    def _ask(self, entry: Entry) -> Iterator[Happened]:
        at_s = entry.at_s
        if entry.kind == "open":
            self._session, self._home = self.begin(entry.value, at_s)
        elif self._session is not None:
            # What was refused then is refused now.
            with suppress(LocalProtocolError):
                yield from _asked(self._session, entry, self._home)


def _asked(session: Session, entry: Entry, home: Callable[[float], None] | None) -> Iterator[Happened]:
    at_s = entry.at_s
    match entry.kind:
        case "start":
            session.start([ProgramLine(text, stroke) for text, stroke in entry.value], at_s)
        case "stop":
            session.stop(at_s)
        case "pause" | "resume" | "feed":
            obey(session, entry.kind, entry.value, at_s)
        case "home" if home is not None:
            home(at_s)
        case "unplugged":
            yield Happened(at_s, session.unplugged(at_s))


def _belongs(entry: Entry, turn: _Turn) -> bool:
    """Hearing begins a turn, saying ends it; all of it has one time."""
    same = entry.at_s == turn.at_s and not turn.over
    return same and entry.kind in {"event", ">"}
