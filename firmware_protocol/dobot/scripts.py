"""What is said in each state, request by request, and what the replies lead to."""

from __future__ import annotations

import math
from collections.abc import Generator
from typing import TYPE_CHECKING, Any

from firmware_protocol.dobot import alarms, commands, sentences
from firmware_protocol.dobot.commands import MOVL_XYZ, Command, command, question
from firmware_protocol.dobot.exchange import Ask
from firmware_protocol.dobot.kinematics import GUIDE, reaches
from firmware_protocol.dobot.states import Signal
from firmware_protocol.dobot.steps import (
    Script,
    Turn,
    Wait,
    at_once,
    look_for_alarms,
    poll,
    put,
    settle,
)
from firmware_protocol.ink import Vector
from firmware_protocol.session import Accepted, Verdict

if TYPE_CHECKING:
    from firmware_protocol.dobot.conversation import Conversation


REST_S = 1.0
"""Between two looks at the alarms while nothing is drawn."""
FEEDING_S = 0.075
"""So much later it is asked how far the queue is while there are lines to send and room for them."""
NEAR_MM = 0.05
"""So near to its target the arm has reached it."""


def introduce(talk: Conversation) -> Script:
    """Who is there; alarms read and cleared, the queue cleared and started, its depth read; then the pen is lifted."""
    yield Ask(question("Pose"))
    major, minor, revision = yield Ask(question("DeviceVersion"))
    talk.firmware = f"Dobot Magician {major}.{minor}.{revision}"
    yield Ask(question("Alarms"))
    yield Ask(at_once("Alarms"))
    if active := alarms.codes((yield Ask(question("Alarms")))[0]):
        raise Turn(Signal.ALARM, sentences.still_alarmed(active))
    yield Ask(at_once("Clear"))
    yield Ask(at_once("StartExec"))
    (index,) = yield Ask(question("CurrentIndex"))
    (left,) = yield Ask(question("LeftSpace"))
    talk.renew_queue(before=index, depth=left, cleared=True)
    yield from _lift(talk)
    raise Turn(Signal.HOME if talk.habits.home else Signal.COMPLETE)


def home(talk: Conversation) -> Script:
    """Homing is queued, and ends when it is executed."""
    talk.progressed()
    yield from put(talk, command("HOME", 0), "HOME 0")
    yield from settle(talk)
    raise Turn(Signal.COMPLETE)


def rest(talk: Conversation) -> Script:
    """Nothing is drawn: alarms are looked at."""
    while True:
        yield from look_for_alarms()
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
        may_feed = talk.queue.room(len(talk.count.open)) and not job.fed
        # On a slow way the line that can be sent goes before the question how far the arm is.
        if talk.now >= talk.next_poll + (FEEDING_S if may_feed else 0.0):
            yield from poll(talk)
        elif may_feed:
            yield from _feed(talk)
        else:
            yield Wait(talk.next_poll)
    yield from _lift(talk)
    raise Turn(Signal.COMPLETE if job.taken == len(job) else Signal.STAND)


def hold(talk: Conversation) -> Script:
    """Stop at once; the place of the cut is kept for `draw`."""
    place = yield from _halt(talk)
    talk.cut = place
    talk.job.rewind(talk.job.executed)
    yield Ask(at_once("StartExec"))
    yield from _lift(talk)
    raise Turn(Signal.STAND)


def abort(talk: Conversation) -> Script:
    """Abort the command (242), empty the queue (245), start it (240), lift the pen, unless the arm is lost."""
    job = talk.job
    yield from _halt(talk)
    if not talk.position_known:
        raise Turn(Signal.OVER)
    if job.verdict is Verdict.ALARM:
        yield Ask(at_once("Alarms"))
        yield from look_for_alarms(late=False)
    yield Ask(at_once("StartExec"))
    yield from _lift(talk)
    raise Turn(Signal.COMPLETE if job.verdict in {Verdict.STOPPED, Verdict.REJECTED} else Signal.OVER)


def _halt(talk: Conversation) -> Generator[Ask, Any, Vector]:
    """Returns where the tool is then. What is executed is judged by the place: an aborted command may be counted."""
    job = talk.job
    yield Ask(at_once("ForceStopExec"))
    yield Ask(at_once("Clear"))
    (index,) = yield Ask(question("CurrentIndex"))
    x, y, z, *_ = yield Ask(question("Pose"))
    said = talk.lines_executed(index)
    if said is not None:
        job.stopped_behind(said + 1)
        before = job.executed
        job.executes(said)
        if job.executed > before and not _is_at((x, y, z), job.commands[job.executed - 1]):
            job.executed -= 1
    talk.renew_queue(before=index, cleared=True)
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
    yield from settle(talk)
    talk.lifted = True


def _put_move(talk: Conversation, place: Vector) -> Script:
    move = command("PTP", MOVL_XYZ, *place, 0.0)
    yield from put(talk, move, commands.text_of(move))


def _feed(talk: Conversation) -> Script:
    job, line = talk.job, talk.job.taken
    talk.lifted = False
    job.sends()
    yield from put(talk, job.commands[line], job.text(line), number=line + 1)
    job.takes()
    talk.events.append(Accepted(line))
