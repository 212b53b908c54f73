"""One request at a time and the reply to it: what is owed, since when, and when to ask again."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from firmware_protocol.dobot import commands
from firmware_protocol.dobot.commands import KINDS, Values
from firmware_protocol.dobot.packet import Packet, ctrl
from firmware_protocol.errors import RemoteProtocolError

LATEST_S = 3.0
"""Later than this after its request no reply comes: so long the maker's own library waits for one."""


@dataclass(frozen=True, slots=True)
class Ask:
    """A question, or something that is done at once: asked again until it is answered, for that does no harm.

    late: the reply to the same question of before will do as well. Otherwise it is not asked while such a reply may
    still come: nothing in a reply tells to which of two equal requests it belongs.
    """

    packet: Packet
    late: bool = False


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
        self.sure = True
        """The last reply can only have belonged to the request that it was taken for."""
        self._due: float | None = None
        self._unheard_since: float | None = None
        self._not_before: float | None = None
        self._unanswered: dict[tuple[int, int], list[float]] = {}
        """When each kind of packet was sent, as often as it was not replied to."""

    def begin(self, request: Request | None, now: float) -> None:
        """This is to be said next; what was owed before is not waited for any more."""
        self.pending, self._due = request, None
        waits = isinstance(request, Ask) and not request.late
        self._not_before = self._owed_until(_key(request.packet), now) if request is not None and waits else None

    def again(self) -> None:
        """What is pending is to be said once more."""
        self._due = None

    def forget(self) -> None:
        """Nothing is owed and nothing will be said any more."""
        self.pending = self._due = self._unheard_since = self._not_before = None

    def late_puts_until(self, now: float) -> float:
        """Until then a command of before may be acknowledged."""
        puts = [key for key in self._unanswered if key[1] == ctrl(write=True, queued=True)]
        times = [self._owed_until(key, now) for key in puts]
        return max((at for at in times if at is not None), default=now)

    @property
    def awaits_put(self) -> bool:
        """A command for the queue was sent and is waited for."""
        return isinstance(self.pending, Put) and self._due is not None

    def take(self, now: float) -> bytes:
        """The bytes of the request, once."""
        if self.pending is None or self._due is not None or self._is_held(now):
            return b""
        self._due, self._not_before = now + self._answer_within_s, None
        self._unheard_since = now if self._unheard_since is None else self._unheard_since
        self._unanswered.setdefault(_key(self.pending.packet), []).append(now)
        return self.pending.packet.encode()

    def hear(self, packet: Packet, now: float) -> Values | None:
        """What the packet says in reply to a question; None when it is none of these, or holds too little."""
        self._unheard_since = None
        key, pending = _key(packet), self.pending
        self._pay(key, now)
        if pending is None or key != _key(pending.packet):
            return None
        if self._due is None:
            self._not_before = self._owed_until(key, now)
            return None
        if isinstance(pending, Put):
            return None
        try:
            values = () if packet.write else commands.answer(packet)
        except RemoteProtocolError:
            return None
        self.pending = self._due = None
        return values

    def overdue(self, now: float) -> bool:
        """The reply should have come by now."""
        return self._due is not None and now >= self._due

    def silent(self, now: float) -> bool:
        """Nothing has come for too long."""
        return self._unheard_since is not None and now >= self._unheard_since + self._silent_after_s

    def deadline(self, now: float) -> float | None:
        """When `take` has something, or `overdue` or `silent` may become true."""
        times = [] if self._due is None else [self._due]
        times += [] if self._unheard_since is None else [self._unheard_since + self._silent_after_s]
        if self.pending is not None and self._due is None:
            times.append(now if self._not_before is None else max(now, self._not_before))
        return min(times, default=None)

    def _is_held(self, now: float) -> bool:
        return self._not_before is not None and now < self._not_before

    def _pay(self, key: tuple[int, int], now: float) -> None:
        self._owed_until(key, now)
        unanswered = self._unanswered[key]
        self.sure = len(unanswered) == 1
        del unanswered[:1]

    def _owed_until(self, key: tuple[int, int], now: float) -> float | None:
        """When the last of the replies that did not come is out of the question; None when all came."""
        times = [at for at in self._unanswered.get(key, []) if now < at + LATEST_S]
        self._unanswered[key] = times
        return times[-1] + LATEST_S if times else None


def _key(packet: Packet) -> tuple[int, int]:
    """A reply repeats both."""
    return packet.id, packet.ctrl


def acknowledged(packet: Packet) -> int | None:
    """The index that a packet acknowledges; None when it is no acknowledgement."""
    if not (packet.write and packet.queued and packet.id in KINDS):
        return None
    try:
        return commands.index_of(packet)
    except RemoteProtocolError:
        return None
