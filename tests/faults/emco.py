"""Every fault of a simulated EMCO control in three moments, on each of its links: `rows()`."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TypeAlias

from firmware_protocol.emco.line_format import FORMATS
from firmware_protocol.emco.session import Control
from firmware_protocol.emco.simulator.faults import (
    AlarmInBlock,
    Fault,
    FlipBit,
    LoseAck,
    LoseXon,
    PowerCut,
    Reset,
    Stall,
    Unplug,
)
from firmware_protocol.emco.simulator.setup import Setup
from firmware_protocol.emco.simulator.simulator import EmcoSimulator
from firmware_protocol.session import Ended, Verdict
from tests.faults.row import Row, outcome_of
from tests.firmware_protocol.emco.bench import Bench, Line, knowing, on_blocks, on_xonxoff, program

STROKES = 12
DRAWN_BY_THEN_S = 100.0
"""After the verdict: whatever the control still holds has been drawn."""

_UNSEEN = (
    "this link says nothing of it: the end is called an estimate, the control's screen shows it; "
    "acknowledged blocks show it until the last answer"
)
_HARMLESS = "nothing of the drawing was lost"


@dataclass(frozen=True, slots=True)
class Moment:
    """A moment of a drawing: when it is, at which block and byte the control is, and how many XONs it has said."""

    name: str
    at_s: float
    block: int
    byte: int
    xons: int


@dataclass(frozen=True, slots=True)
class Link:
    """A link and how to set up both its ends."""

    name: str
    setup: Setup
    bench: Callable[..., Bench]
    lost_answer: Callable[[Moment], Fault]

    def begun(self, *faults: Fault) -> Bench:
        control: Control = knowing(self.setup)
        return self.bench(EmcoSimulator(self.setup, faults=faults), control=control)


def _lost_xon(moment: Moment) -> Fault:
    return LoseXon(moment.xons)


def _lost_ack(moment: Moment) -> Fault:
    return LoseAck(moment.block - 1)


LINKS = (
    Link("XON/XOFF", Setup(line=FORMATS["7E1"]), on_xonxoff, _lost_xon),
    Link("XON/XOFF at 600 baud", Setup(line=FORMATS["7E1"], baud=600), on_xonxoff, _lost_xon),
    Link("blocks", Setup(link="blocks", line=FORMATS["7E1"]), on_blocks, _lost_ack),
)
Made: TypeAlias = Callable[[Moment], Fault]
FAULTS: dict[str, Made] = {
    "XOFF for ever": lambda moment: Stall(moment.at_s),
    "parity": lambda moment: FlipBit(moment.byte),
    "alarm in a block": lambda moment: AlarmInBlock(moment.block),
    "operator's RESET": lambda moment: Reset(moment.at_s),
    "power cut": lambda moment: PowerCut(moment.at_s),
    "unplug": lambda moment: Unplug(moment.at_s),
}


def rows() -> list[Row]:
    """The table of all links, faults and moments."""
    return [row for link in LINKS for row in _rows_of(link)]


def _rows_of(link: Link) -> Iterator[Row]:
    moments = _moments(link)
    for name, made in (*FAULTS.items(), ("lost XON" if "XON" in link.name else "lost ACK", link.lost_answer)):
        for moment in moments:
            yield _row(link, name, moment, made(moment))


def _row(link: Link, name: str, moment: Moment, fault: Fault) -> Row:
    bench, due_s = link.begun(fault), 0.0
    bench.session.start(_lines(), bench.now)
    while not bench.ends:
        due_s = bench.session.deadline() or bench.now
        bench.step(bench.now + 1000)
    (end,) = bench.ends
    said_s = bench.now
    bench.sim.advance(bench.now + DRAWN_BY_THEN_S)
    sign, seen_s = _sign(end, whole=bench.whole, due_s=due_s, now=said_s)
    seconds = round(said_s - seen_s, 3) if sign else None
    stated = {"certainly": end.strokes_certain, "possibly": end.strokes_possible, "true": bench.whole}
    outcome = outcome_of(sign=sign, seconds=seconds, **stated)
    limits = {"ok": "", "wrong": "the truth is outside, or the verdict late", "undetectable": _UNSEEN}[outcome]
    verdict = end.verdict.value + (" (estimated)" if end.estimated else "")
    return Row(
        "emco", f"{link.name}: {name}", moment.name, sign, verdict, seconds, **stated, outcome=outcome, limits=limits
    )


def _sign(end: Ended, *, whole: int, due_s: float, now: float) -> tuple[str, float]:
    """What the host sees first, and when. Silence is a sign when its limit is over: `due_s` is the session's."""
    if end.verdict is Verdict.UNPLUGGED:
        return "end of the file", now
    if end.verdict is Verdict.SILENT:
        signs = {"XOFF": "XOFF for 300 s", "no longer reads": "more taken than it holds", "acknowledged": "no answer"}
        return next(sign for words, sign in signs.items() if words in end.why), due_s
    return (f"none: {_HARMLESS}", now) if whole == STROKES else ("", now)


def _lines() -> list[Line]:
    return program(strokes=STROKES)


def _moments(link: Link) -> list[Moment]:
    """Half-way: on the travel to a stroke and in the middle of it; and in the last block that draws."""
    bench, xons = link.begun(), list[tuple[float, int]]()
    bench.session.start(_lines(), bench.now)
    while not bench.ends:
        bench.step(bench.now + 1000)
        xons.append((bench.now, bench.sim.xons))
    middle = STROKES // 2
    places = [(2 * middle, 0, 5), (2 * middle, 5, 0), (2 * (STROKES - 1), 10, 0)]
    names = ("travel", "mid stroke", "last line")
    return [_moment(name, bench, place, xons) for name, place in zip(names, places, strict=True)]


def _moment(name: str, bench: Bench, place: tuple[float, float, float], xons: list[tuple[float, int]]) -> Moment:
    """Shortly before the pen gets to this place."""
    at_s = next(at_s for at_s, position in bench.sim.path if position == place) - 0.01
    x, y, z = place
    texts = [line.text for line in _lines()]
    words = (f"G0 X{x:.1f} Y{y:.1f}",) if z else (f"G1 X{x:.1f} Y{y:.1f} F600.0", f"G1 X{x:.1f} Y{y:.1f}")
    index = next(index for index, text in enumerate(texts) if text in words)
    byte = sum(len(text) + 1 for text in texts[:index]) + 4
    until_then = max(count for now, count in xons if now <= at_s)
    return Moment(name, at_s, index + 1, byte, min(until_then, xons[-1][1] - 1))
