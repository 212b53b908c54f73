"""What is said in each state, request by request, and what the replies lead to."""

from __future__ import annotations

import math
from collections.abc import Generator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

from firmware_protocol.dobot import alarms, commands, sentences
from firmware_protocol.dobot.commands import MOVL_XYZ, Command, Value, Values, command, question
from firmware_protocol.dobot.exchange import Ask, Put
from firmware_protocol.dobot.kinematics import GUIDE, reaches
from firmware_protocol.dobot.packet import Packet
from firmware_protocol.dobot.states import Signal
from firmware_protocol.ink import Vector
from firmware_protocol.session import Accepted, Status, Verdict

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
REST_S = 1.0
"""The same while nothing is drawn."""
NEAR_MM = 0.05
"""So near to its target the arm has reached it."""
SAMPLES = 6


def introduce(talk: Conversation) -> Script:
    """Who is there; alarms read and cleared, the queue cleared and started, its depth read; then the pen is lifted."""
    yield Ask(question("Pose"))
    major, minor, revision = yield Ask(question("DeviceVersion"))
    talk.firmware = f"Dobot Magician {major}.{minor}.{revision}"
    yield Ask(question("Alarms"))
    yield Ask(_at_once("Alarms"))
    if active := alarms.codes((yield Ask(question("Alarms")))[0]):
        raise Turn(Signal.ALARM, sentences.still_alarmed(active))
    yield Ask(_at_once("Clear"))
    yield Ask(_at_once("StartExec"))
    (index,) = yield Ask(question("CurrentIndex"))
    (left,) = yield Ask(question("LeftSpace"))
    talk.renew_queue(before=index, depth=left)
    yield from _lift(talk)
    raise Turn(Signal.HOME if talk.habits.home else Signal.COMPLETE)


def home(talk: Conversation) -> Script:
    """Homing is queued, and ends when it is executed."""
    talk.progressed()
    yield from _put(talk, command("HOME", 0), "HOME 0")
    yield from _settle(talk)
    raise Turn(Signal.COMPLETE)


def rest(talk: Conversation) -> Script:
    """Nothing is drawn: alarms are looked at."""
    while True:
        yield from _look_for_alarms()
        yield Wait(talk.now + REST_S)


def draw(talk: Conversation) -> Script:
    """The queue is kept full until the last line is executed, or the one before which the arm is to stand still."""
    job = talk.job
    if talk.cut is None:
        (index,) = yield Ask(question("CurrentIndex"))
        talk.renew_queue(before=index)
    yield from _lift(talk)
    yield from _back_to_the_cut(talk)
    talk.first_line = job.taken - talk.queue.accepted
    talk.progressed()
    while not (job.fed and talk.queue.ahead == 0):
        if talk.poll_due:
            yield from _poll(talk)
        elif not job.fed and talk.queue.room:
            yield from _feed(talk)
        else:
            yield Wait(talk.next_poll)
    while talk.queue.unknown and (yield Ask(question("LeftSpace")))[0] < talk.queue.depth:
        # Which command the last acknowledgement belongs to is not certain: done is what leaves the queue empty.
        yield from _poll(talk)
        yield Wait(talk.next_poll)
    yield from _lift(talk)
    raise Turn(Signal.COMPLETE if job.taken == len(job) else Signal.STAND)


def hold(talk: Conversation) -> Script:
    """Stop at once; the place of the cut is kept for `draw`."""
    place = yield from _halt(talk)
    talk.cut = place
    talk.job.rewind(talk.job.executed)
    yield Ask(_at_once("StartExec"))
    yield from _lift(talk)
    raise Turn(Signal.STAND)


def abort(talk: Conversation) -> Script:
    """Abort the command (242), empty the queue (245), start it (240), lift the pen, unless the arm is lost."""
    job = talk.job
    yield from _halt(talk)
    if not talk.position_known:
        raise Turn(Signal.OVER)
    if job.verdict is Verdict.ALARM:
        yield Ask(_at_once("Alarms"))
        yield from _look_for_alarms()
    yield Ask(_at_once("StartExec"))
    yield from _lift(talk)
    raise Turn(Signal.COMPLETE if job.verdict in {Verdict.STOPPED, Verdict.REJECTED} else Signal.OVER)


def _halt(talk: Conversation) -> Generator[Ask, Any, Vector]:
    """Returns where the tool is then. What is executed is judged by the place: an aborted command may be counted."""
    job = talk.job
    yield Ask(_at_once("ForceStopExec"))
    yield Ask(_at_once("Clear"))
    (index,) = yield Ask(question("CurrentIndex"))
    x, y, z, *_ = yield Ask(question("Pose"))
    said = talk.lines_executed(index)
    if said is not None:
        job.stopped_behind(said + 1)
        before = job.executed
        job.executes(said)
        if job.executed > before and not _is_at((x, y, z), job.commands[job.executed - 1]):
            job.executed -= 1
    talk.renew_queue(before=index)
    return x, y, z


def _is_at(place: Vector, reached: Command) -> bool:
    if reached.kind.name not in {"CP", "PTP"}:
        return True
    target = [float(value) for value in reached.values[1:4]]
    return math.dist(place, target) <= NEAR_MM


def _back_to_the_cut(talk: Conversation) -> Script:
    """Above the place where a stroke was cut, and down to it."""
    cut, talk.cut = talk.cut, None
    if cut is not None:
        for z_mm in (max(cut[2], talk.habits.up_mm), cut[2]):
            yield from _put_move(talk, (cut[0], cut[1], z_mm))


def _lift(talk: Conversation) -> Script:
    """Straight up from wherever the pen is, and wait until it is there."""
    x, y, z, *_ = yield Ask(question("Pose"))
    up_mm = talk.habits.up_mm
    talk.lifted = z >= up_mm - NEAR_MM
    if talk.lifted or not reaches((x, y, up_mm), GUIDE):
        return
    talk.progressed()
    yield from _put_move(talk, (x, y, up_mm))
    yield from _settle(talk)
    talk.lifted = True


def _put_move(talk: Conversation, place: Vector) -> Script:
    move = command("PTP", MOVL_XYZ, *place, 0.0)
    yield from _put(talk, move, commands.text_of(move))


def _feed(talk: Conversation) -> Script:
    job, line = talk.job, talk.job.taken
    talk.lifted = False
    job.sends()
    yield from _put(talk, job.commands[line], job.text(line), number=line + 1)
    job.takes()
    talk.events.append(Accepted(line))


def _put(talk: Conversation, written: Command, text: str, number: int | None = None) -> Script:
    """Put it into the queue; number: of its line from 1. Sent again only when it certainly has not been taken."""
    for _ in range(2):
        reply: tuple[int] | None = yield Put(written.packet())
        if reply is not None:
            talk.queue.accept(reply[0])
            return
        taken = yield from _was_taken(talk)
        if taken is None:
            why = sentences.doubtful(number, text) if number else sentences.refused_command(text)
            raise Turn(Signal.DOUBT, why)
        if taken:
            return
    raise Turn(Signal.REFUSED, sentences.refused(number, text) if number else sentences.refused_command(text))


def _was_taken(talk: Conversation) -> Generator[Ask, Any, bool | None]:
    """Whether a command whose acknowledgement is missing is in the queue, by 247 and 246, twice; None: not clear."""
    talk.late_index = None
    talk.doubting = True
    more = []
    for _ in range(2):
        more.append((yield from _left_over(talk)))
    talk.doubting = False
    if talk.late_index is not None:
        talk.queue.accept(talk.late_index)
        return True
    first, second = (None if left is None else left - talk.usually_left_over for left in more)
    if first == second == 1:
        talk.queue.accept(None)
        return True
    return False if first == second == 0 else None


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


def _settle(talk: Conversation) -> Script:
    """Until everything in the queue is executed."""
    while talk.queue.ahead:
        yield from _poll(talk)
        yield Wait(talk.next_poll)


def _poll(talk: Conversation) -> Script:
    (index,) = yield Ask(question("CurrentIndex"))
    talk.read_index(index)
    talk.next_poll = talk.now + POLL_S
    if talk.now >= talk.next_look:
        talk.next_look = talk.now + LOOK_S
        yield from _look(talk)


def _look(talk: Conversation) -> Script:
    yield from _look_for_alarms()
    x, y, z, *_ = yield Ask(question("Pose"))
    talk.seen_at((x, y, z))
    talk.events.append(Status(talk.state.name.capitalize(), talk.on_sheet((x, y, z))))
    talk.check_progress()
    if talk.queue.ahead and not talk.queue.unknown:
        left_over = yield from _left_over(talk)
        talk.usually_left_over = talk.usually_left_over if left_over is None else left_over


def _look_for_alarms() -> Generator[Ask, Any, None]:
    reply: Values = yield Ask(question("Alarms"))
    mask: Value = reply[0]
    active = alarms.codes(mask) if isinstance(mask, bytes) else ()
    if alarms.RESET in active:
        raise Turn(Signal.RESTARTED, sentences.RESTARTED, position_known=False)
    if active:
        raise Turn(Signal.ALARM, sentences.alarmed(active), position_known=alarms.recoverable(active))


def _at_once(name: str) -> Packet:
    return command(name).packet(queued=False)
