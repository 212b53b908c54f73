"""One request at a time and the reply to it: what is owed, since when, and when to ask again."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from firmware_protocol.dobot import commands
from firmware_protocol.dobot.commands import KINDS, Values
from firmware_protocol.dobot.packet import Packet
from firmware_protocol.errors import RemoteProtocolError


@dataclass(frozen=True, slots=True)
class Ask:
    """A question, or something that is done at once: asked again until it is answered, for that does no harm."""

    packet: Packet


@dataclass(frozen=True, slots=True)
class Put:
    """A command for the queue: never sent again by itself, because an arm that has taken it would do it twice."""

    packet: Packet


Request: TypeAlias = Ask | Put


class Exchange:
    """answer_within_s: later than that a reply counts as lost. silent_after_s: so long may all replies fail to come."""

    def __init__(self, *, answer_within_s: float, silent_after_s: float) -> None:
        self._answer_within_s, self._silent_after_s = answer_within_s, silent_after_s
        self.pending: Request | None = None
        self._due: float | None = None
        self._unheard_since: float | None = None

    def begin(self, request: Request | None) -> None:
        """This is to be said next; what was owed before is not waited for any more."""
        self.pending, self._due = request, None

    def forget(self) -> None:
        """Nothing is owed and nothing will be said any more."""
        self.begin(None)
        self._unheard_since = None

    @property
    def unsent(self) -> bool:
        """There is something to be said."""
        return self.pending is not None and self._due is None

    def take(self, now: float) -> bytes:
        """The bytes of the request, once."""
        if self.pending is None or self._due is not None:
            return b""
        self._due = now + self._answer_within_s
        self._unheard_since = now if self._unheard_since is None else self._unheard_since
        return self.pending.packet.encode()

    def hear(self, packet: Packet) -> Values | None:
        """What the packet says in reply to the request; None when it is none, or holds too little."""
        self._unheard_since = None
        request = self.pending
        if request is None or (packet.id, packet.ctrl) != (request.packet.id, request.packet.ctrl):
            return None
        try:
            values = _values(request, packet)
        except RemoteProtocolError:
            return None
        self.begin(None)
        return values

    def overdue(self, now: float) -> bool:
        """The reply should have come by now."""
        return self._due is not None and now >= self._due

    def silent(self, now: float) -> bool:
        """Nothing has come for too long."""
        return self._unheard_since is not None and now >= self._unheard_since + self._silent_after_s

    def deadline(self) -> float | None:
        """When `overdue` or `silent` may become true."""
        times = [] if self._due is None else [self._due]
        times += [] if self._unheard_since is None else [self._unheard_since + self._silent_after_s]
        return min(times, default=None)


def _values(request: Request, packet: Packet) -> Values:
    if isinstance(request, Put):
        return (commands.index_of(packet),)
    return () if packet.write else commands.answer(packet)


def acknowledged(packet: Packet) -> int | None:
    """The index that a packet acknowledges; None when it is no acknowledgement."""
    if not (packet.write and packet.queued and packet.id in KINDS):
        return None
    try:
        return commands.index_of(packet)
    except RemoteProtocolError:
        return None
