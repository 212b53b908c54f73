"""Every fault of a simulated Dobot Magician in three moments, and some while it waits for a pen: `rows()`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeAlias

from firmware_protocol.dobot.conversation import CP_BYTES
from firmware_protocol.dobot.simulator.faults import (
    ClosePort,
    CorruptReply,
    CorruptRequest,
    DelayReply,
    DropReply,
    Fault,
    Hang,
    PowerCut,
    RaiseAlarm,
    StopQueue,
    StrayByte,
)
from firmware_protocol.ink import Polyline
from firmware_protocol.session import Ended, Paused, Verdict
from tests.faults.row import Row, outcome_of
from tests.firmware_protocol.dobot.bench import Bench, Line, strokes

STROKES, LINES_A_STROKE = 12, 13
POLL_S = 0.1
"""The same question is asked again only later than this where it was not answered."""
REPLY_S = 0.005
"""So long after a request its reply has passed the wire, if there is one."""
_HARMLESS = "none: nothing of the drawing was lost"


@dataclass(frozen=True, slots=True)
class Moment:
    """A moment of a drawing: when the arm is in the middle of a line, and which line that is."""

    name: str
    at_s: float
    line: int


Made: TypeAlias = Callable[[Moment], tuple[Fault, ...]]
BEFORE = 1
"""Commands for the queue before the first line: the arm is asked to wait."""
FAULTS: dict[str, Made] = {
    "reply dropped": lambda moment: (DropReply(moment.line + BEFORE),),
    "replies to questions dropped": lambda moment: tuple(DropReply(moment.line + k, answers=True) for k in range(4)),
    "reply 2 s late": lambda moment: (DelayReply(moment.line + BEFORE, by_s=2.0),),
    "reply corrupt": lambda moment: (CorruptReply(moment.line + BEFORE),),
    "stray AA": lambda moment: (StrayByte(moment.line + BEFORE),),
    "command corrupt": lambda moment: (CorruptRequest(moment.line + BEFORE),),
    # Between the two the arm is asked to wait, which tells that it has not taken the first.
    "command corrupt twice": lambda moment: tuple(CorruptRequest(moment.line + BEFORE + k) for k in (0, 2)),
    "port closed": lambda moment: (ClosePort(at_s=moment.at_s),),
    "power cut": lambda moment: (PowerCut(at_s=moment.at_s),),
    "hang": lambda moment: (Hang(at_s=moment.at_s),),
    "queue stops": lambda moment: (StopQueue(at_s=moment.at_s),),
    "alarm: lost step": lambda moment: (RaiseAlarm(at_s=moment.at_s, code=0x50),),
    "alarm: out of reach": lambda moment: (RaiseAlarm(at_s=moment.at_s, code=0x21),),
}

AT_A_PEN_CHANGE = ("port closed", "power cut", "hang", "alarm: lost step", "alarm: out of reach")
"""What may happen to an arm that nothing is sent to."""
_SIGNS = {
    "command corrupt twice": "no acknowledgement, and no gap in the indices",
    "port closed": "end of the file",
    "power cut": "no answer, then alarm 0x00",
    "hang": "no answer",
    "queue stops": "246 and the place stand still",
    "alarm: lost step": "alarm 0x50",
    "alarm: out of reach": "alarm 0x21",
}


def rows() -> list[Row]:
    """The table of all faults and moments."""
    bench = Bench()
    moments = _moments(bench)
    whole = _rounded(bench.sim.ink)
    table = [_row(name, moment, whole, _lines()) for name in FAULTS for moment in moments]
    change = _pen_change()
    return [*table, *(_row(name, change, whole, _in_two_pens()) for name in AT_A_PEN_CHANGE)]


def _row(name: str, moment: Moment, whole: list[Polyline], lines: list[Line]) -> Row:
    bench = Bench(arm={"faults": FAULTS[name](moment)})
    end = bench.draw(lines)
    said_s = bench.time_of(Ended)
    bench.drain()
    drawn = _rounded(bench.sim.ink)
    true = sum(line == full for line, full in zip(drawn, whole, strict=False))
    sign = _HARMLESS if end.verdict is Verdict.FINISHED and drawn == whole else _SIGNS.get(name, "")
    seconds = round(said_s - _seen_s(bench, moment, end), 3) if sign != _HARMLESS else 0.0
    stated = {"certainly": end.strokes_certain, "possibly": end.strokes_possible, "true": true}
    outcome = outcome_of(sign=sign, seconds=seconds, **stated)
    limits = "the truth is outside, or the verdict late" if outcome == "wrong" else ""
    return Row("dobot", name, moment.name, sign, end.verdict.value, seconds, **stated, outcome=outcome, limits=limits)


def _seen_s(bench: Bench, moment: Moment, end: Ended) -> float:
    """When the host could see it: at once, where something was said; with the first reply that is missing, else."""
    if end.verdict in {Verdict.REJECTED, Verdict.SILENT} and "stood still" not in end.why:
        return _asked_in_vain_s(bench, moment, end) + REPLY_S
    return moment.at_s


def _asked_in_vain_s(bench: Bench, moment: Moment, end: Ended) -> float:
    """When what had to be sent twice was sent first: a command, or any question where nothing is answered any more."""
    if end.verdict is Verdict.REJECTED:
        sent = [(at, data) for at, data in bench.sent if len(data) == CP_BYTES]
    else:
        sent = [(at, data) for at, data in bench.sent if at >= moment.at_s - REPLY_S]
    return next(at for (at, data), (later, again) in pairwise(sent) if data == again and later > at + POLL_S)


def _lines() -> list[Line]:
    return strokes(STROKES, segments=LINES_A_STROKE - 3, step_mm=2.0)


def _in_two_pens() -> list[Line]:
    """The first half of the strokes with one pen."""
    lines = _lines()
    first = next(number for number, line in enumerate(lines) if line.stroke == STROKES // 2)
    return [*lines[:first], Line("M0", STROKES // 2 - 1), *lines[first:]]


def _pen_change() -> Moment:
    """A minute after the arm has begun to wait for its second pen."""
    bench = Bench().ready().start(_in_two_pens())
    bench.until(lambda: bool(bench.all_of(Paused)))
    return Moment("pen change", bench.now + 60.0, 0)


def _moments(bench: Bench) -> list[Moment]:
    """Half-way: on the travel to a stroke and in the middle of it; and on the last line that draws."""
    middle = STROKES // 2 * LINES_A_STROKE
    wanted = {"travel": middle, "mid stroke": middle + 7, "last line": STROKES * LINES_A_STROKE - 2}
    began: dict[int, float] = {}
    bench.ready().start(_lines())
    while not bench.over:
        # The indices of this arm begin with 1, so so many commands are executed.
        began.setdefault(bench.sim.arm.executed - BEFORE, bench.now)
        bench.turn(bench.now + 1)
    return [Moment(name, _middle_s(began, line), line) for name, line in wanted.items()]


def _middle_s(began: dict[int, float], line: int) -> float:
    return (began[line] + began[line + 1]) / 2


def _rounded(ink: list[Polyline]) -> list[Polyline]:
    return [[(round(x, 3), round(y, 3)) for x, y in line] for line in ink]
