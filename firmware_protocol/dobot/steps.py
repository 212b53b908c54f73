"""What the scripts of all states have in common: a command put into the queue, and a look at the arm."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

from firmware_protocol.dobot import alarms, commands, sentences
from firmware_protocol.dobot.commands import Command, Value, Values, command, question
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
SAMPLES = 6


def put(talk: Conversation, written: Command, text: str, number: int | None = None) -> Script:
    """Put it into the queue; number: of its line from 1. Sent again only when it certainly has not been taken."""
    for _ in range(2):
        reply: tuple[int] | None = yield Put(written.packet())
        if reply is not None:
            talk.queue.accept(reply[0])
            return
        taken = yield from _was_taken(talk, harmless=_is_harmless(written))
        if taken is None:
            why = sentences.doubtful(number, text) if number else sentences.refused_command(text)
            raise Turn(Signal.DOUBT, why)
        if taken:
            return
    raise Turn(Signal.REFUSED, sentences.refused(number, text) if number else sentences.refused_command(text))


def _is_harmless(written: Command) -> bool:
    """Done twice it does the same as done once: a setting, or a move to a place that it states."""
    mode = written.values[0] if written.values else None
    relative = (written.kind.name == "CP" and mode != commands.ABSOLUTE) or (
        written.kind.name == "PTP" and mode not in commands.PTP_TO_A_PLACE
    )
    return not relative and written.kind.name != "WAIT"


def _was_taken(talk: Conversation, *, harmless: bool) -> Generator[Ask, Any, bool | None]:
    """Whether a command whose acknowledgement is missing is in the queue, by 247 and 246, twice; None: not clear.

    Before it is known whether this arm counts the running command, only what is harmless is taken for missing.
    """
    talk.late_index = None
    talk.doubting = True
    yield from look_for_alarms()
    more = []
    for _ in range(2):
        more.append((yield from _left_over(talk)))
    talk.doubting = False
    if talk.late_index is not None:
        talk.queue.accept(talk.late_index)
        return True
    usual = talk.usually_left_over
    if more[0] is None or more[0] != more[1]:
        return None
    if more[0] == (usual or 0) + 1:
        talk.queue.accept(None)
        return True
    return False if more[0] == usual or (usual is None and harmless and more[0] in {-1, 0}) else None


def _left_over(talk: Conversation) -> Generator[Ask, Any, int | None]:
    """Commands in the queue beyond those that are known; None when it never stood still while that was asked."""
    for _ in range(SAMPLES):
        (before,) = yield Ask(question("CurrentIndex"))
        (left,) = yield Ask(question("LeftSpace"))
        (after,) = yield Ask(question("CurrentIndex"))
        talk.read_index(after)
        if before == after:
            return talk.queue.left_over(left)
    return None


def settle(talk: Conversation) -> Script:
    """Until everything in the queue is executed."""
    while talk.queue.ahead:
        yield from poll(talk)
        yield Wait(talk.next_poll)


def poll(talk: Conversation) -> Script:
    """How far the queue is, and from time to time alarms and place."""
    (index,) = yield Ask(question("CurrentIndex"))
    talk.read_index(index)
    talk.next_poll = talk.now + POLL_S
    if talk.now >= talk.next_look:
        talk.next_look = talk.now + LOOK_S
        yield from _look(talk)


def _look(talk: Conversation) -> Script:
    yield from look_for_alarms()
    x, y, z, *_ = yield Ask(question("Pose"))
    talk.seen_at((x, y, z))
    talk.events.append(Status(talk.state.name.capitalize(), talk.on_sheet((x, y, z))))
    talk.check_progress()
    yield from learn_left_over(talk)


def learn_left_over(talk: Conversation) -> Script:
    """By how much 247 differs from what is known while something runs: some arms count the running command."""
    left_over = yield from _left_over(talk)
    if left_over is not None and talk.queue.ahead and not talk.queue.unknown:
        talk.usually_left_over = left_over


def look_for_alarms() -> Generator[Ask, Any, None]:
    """Raises Turn when there are any."""
    reply: Values = yield Ask(question("Alarms"))
    mask: Value = reply[0]
    active = alarms.codes(mask) if isinstance(mask, bytes) else ()
    if alarms.RESET in active:
        raise Turn(Signal.RESTARTED, sentences.RESTARTED, position_known=False)
    if active:
        raise Turn(Signal.ALARM, sentences.alarmed(active), position_known=alarms.recoverable(active))


def at_once(name: str) -> Packet:
    """What is done when it arrives, past the queue."""
    return command(name).packet(queued=False)
