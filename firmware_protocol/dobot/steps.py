"""What the scripts of all states have in common: a command put into the queue, and a look at the arm."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

from firmware_protocol.dobot import alarms, commands, sentences
from firmware_protocol.dobot.commands import Command, Value, Values, command, question
from firmware_protocol.dobot.count import Sent
from firmware_protocol.dobot.exchange import Ask, Put
from firmware_protocol.dobot.packet import Packet
from firmware_protocol.dobot.states import Signal
from firmware_protocol.session import Status

if TYPE_CHECKING:
    from firmware_protocol.dobot.conversation import Conversation


@dataclass(frozen=True, slots=True)
class Wait:
    """Say nothing until then."""

    until: float


Script: TypeAlias = Generator[Ask | Put | Wait, Any, None]


class Turn(Exception):
    """The conversation changes its state, and this script is over."""

    def __init__(self, signal: Signal, why: str = "", *, position_known: bool = True) -> None:
        super().__init__(signal, why)
        self.signal, self.why, self.position_known = signal, why, position_known


POLL_S = 0.025
"""Between two questions how far the queue is."""
LOOK_S = 0.4
"""Between two questions for alarms and place."""
TRIES = 4
"""So often the arm is asked to wait before it counts as not counting."""
_SHORTLY = command("WAIT", 1)
"""Done once or several times it changes nothing, and its index tells how many commands the arm has taken before."""


def put(talk: Conversation, written: Command, text: str, number: int | None = None) -> Script:
    """Put it into the queue; number: of its line from 1. Sent again only when it certainly has not been taken."""
    if talk.count.last is None:
        yield from _learn_count(talk)
    if written.kind.name == _SHORTLY.kind.name:
        talk.queue.accept((yield from _wait(talk, written)))
        return
    for _ in range(2):
        sent = talk.count.sends(written.kind.id)
        yield Put(written.packet())
        yield from _find_out(talk, sent)
        if not sent.settled:
            why = sentences.doubtful(number, text) if number else sentences.refused_command(text)
            raise Turn(Signal.DOUBT, why)
        if sent.index is not None:
            talk.queue.accept(sent.index)
            return
    raise Turn(Signal.REFUSED, sentences.refused(number, text) if number else sentences.refused_command(text))


def _find_out(talk: Conversation, sent: Sent) -> Script:
    """Whether a command whose acknowledgement is missing is in the queue: by the indices of commands behind it."""
    for _ in range(TRIES):
        if not sent.settled:
            yield from look_for_alarms()
        if sent.settled:
            return
        shortly = talk.count.sends(_SHORTLY.kind.id)
        yield Put(_SHORTLY.packet())
        if shortly.index is not None:
            talk.queue.accept_wait(shortly.index)


def _wait(talk: Conversation, written: Command) -> Generator[Ask | Put, Any, int]:
    """Have the arm wait, asked again until it says an index, which is returned. It may wait more than once."""
    before = talk.count.top
    for _ in range(TRIES):
        talk.count.sends(written.kind.id)
        yield Put(written.packet())
        top = talk.count.top
        if top is not None and top != before:
            return top
        yield from look_for_alarms()
    raise Turn(Signal.REFUSED, sentences.refused_command(commands.text_of(written)))


def _learn_count(talk: Conversation) -> Script:
    """Where the arm's count stands after its queue was emptied, and until 246 speaks of this queue."""
    talk.progressed()
    late_until = talk.exchange.late_puts_until(talk.now)
    if late_until > talk.now:
        yield Wait(late_until)
    index = yield from _wait(talk, _SHORTLY)
    while talk.queue.begins_anew(index) and not talk.queue.is_told_apart(index):
        index = yield from _wait(talk, _SHORTLY)
    talk.queue.accept_wait(index)
    while talk.queue.stale:
        yield from poll(talk)
        yield Wait(talk.next_poll)


def settle(talk: Conversation) -> Script:
    """Until everything in the queue is executed."""
    while talk.queue.ahead:
        yield from poll(talk)
        yield Wait(talk.next_poll)


def poll(talk: Conversation) -> Script:
    """How far the queue is, and from time to time alarms and place."""
    (index,) = yield Ask(question("CurrentIndex"), late=True)
    talk.read_index(index)
    talk.next_poll = talk.now + POLL_S
    if talk.now >= talk.next_look:
        talk.next_look = talk.now + LOOK_S
        yield from _look(talk)


def _look(talk: Conversation) -> Script:
    yield from look_for_alarms()
    x, y, z, *_ = yield Ask(question("Pose"), late=True)
    talk.seen_at((x, y, z))
    talk.events.append(Status(talk.state.name.capitalize(), talk.on_sheet((x, y, z))))
    talk.check_progress()


def look_for_alarms(*, late: bool = True) -> Generator[Ask, Any, None]:
    """Raises Turn when there are any. late: an answer of before will do."""
    reply: Values = yield Ask(question("Alarms"), late)
    mask: Value = reply[0]
    active = alarms.codes(mask) if isinstance(mask, bytes) else ()
    if alarms.RESET in active:
        raise Turn(Signal.RESTARTED, sentences.RESTARTED, position_known=False)
    if active:
        raise Turn(Signal.ALARM, sentences.alarmed(active), position_known=alarms.recoverable(active))


def at_once(name: str) -> Packet:
    """What is done when it arrives, past the queue."""
    return command(name).packet(queued=False)
