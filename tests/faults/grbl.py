"""Every fault of a simulated GRBL controller in three moments, and some while it waits for a pen: `rows()`."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeAlias

from firmware_protocol.gcode import read_words
from firmware_protocol.grbl.simulator.faults import (
    BrownOut,
    DropByte,
    Fault,
    FlipByte,
    Hang,
    HardLimit,
    LoseOk,
    SlowUsb,
    Unplug,
    UnsaidAlarm,
)
from firmware_protocol.session import Ended, Event, Paused, Status, Verdict, Waiting
from tests.faults.row import Row, outcome_of
from tests.firmware_protocol.grbl.driver import Line
from tests.firmware_protocol.grbl.pair import TOUCHES_MM, Pair, missing_mm, plotter, stroke_lines

STROKES = 12
OFF_MM = 0.04
"""Two reports this far from the programmed path are a sign that somebody without our session could see."""

SHORT_MM = 0.2
DRAWING = [[(2.0 * n, y) for y in (0.0, 5.0, 5.0 + SHORT_MM, 5.0 + 2 * SHORT_MM, 10.0)] for n in range(STROKES)]
LINES = stroke_lines(DRAWING)
_CHANGE = next(number for number, line in enumerate(LINES) if line.stroke == STROKES // 2)
IN_TWO_PENS = [*LINES[:_CHANGE], Line("M0", STROKES // 2 - 1), *LINES[_CHANGE:]]
"""The first half of the strokes with one pen."""
AT_A_PEN_CHANGE = ("hang", "brown-out", "limit switch", "limit switch, alarm unsaid", "unplug")
"""What may happen to a controller that nothing is sent to."""

_UNSEEN = (
    "the controller answers `ok`; a report each 0.2 s and the place at the end are compared with the program, which "
    "leaves deviations of some hundredths of a second, and those of some hundredths of a millimetre"
)


@dataclass(frozen=True, slots=True)
class Moment:
    """A moment of a drawing: when it is, the line that is sent about then, and the first byte and answer of that.

    short: the first byte of the next line that takes only some hundredths of a second.
    """

    name: str
    at_s: float
    line: int
    byte: int
    answer: int
    short: int

    def byte_of(self, character: str) -> int:
        """Where in all that is sent this character of the line lies."""
        return self.byte + f"{LINES[self.line].text}\n".index(character)


Made: TypeAlias = Callable[[Moment], tuple[Fault, ...]]
FAULTS: dict[str, Made] = {
    "lost digit": lambda at: (DropByte(at.byte_of("X") + 1),),
    "lost line end": lambda at: (DropByte(at.byte_of("\n")),),
    "flipped digit": lambda at: (FlipByte(at.byte_of("X") + 1),),
    "flipped tenth": lambda at: (FlipByte(at.byte_of(".") + 1, 0x02),),
    "flipped tenth of a short line": lambda at: (FlipByte(at.short + _SHORT.index(".") + 1, 0x02),),
    "flipped thousandth": lambda at: (FlipByte(at.byte_of("\n") - 1),),
    "flip into a feed hold": lambda at: (FlipByte(at.byte_of("1"), 0x10),),
    "flip into a reset": lambda at: (FlipByte(at.byte_of("X"), 0x40),),
    "flip into a line end": lambda at: (FlipByte(at.byte_of(" "), 0x2A),),
    "lost ok": lambda at: (LoseOk(at.answer),),
    "hang": lambda at: (Hang(at_s=at.at_s),),
    "brown-out": lambda at: (BrownOut(at_s=at.at_s),),
    "limit switch": lambda at: (HardLimit(at_s=at.at_s),),
    "limit switch, alarm unsaid": lambda at: (UnsaidAlarm(), HardLimit(at_s=at.at_s)),
    "unplug": lambda at: (Unplug(at_s=at.at_s),),
    "slow USB": lambda at: (SlowUsb(0.016),),
}

_SHORT = "X12.000 "
"""How a short line of the strokes in question begins."""


class Watched(Pair):
    """A pair whose wire is listened to by somebody who knows the drawing, but not the session."""

    def __init__(self, *faults: Fault) -> None:
        super().__init__(plotter(faults=faults))
        self.heard: list[tuple[float, str]] = []
        self.asked_s: list[float] = []
        self.held_s: float | None = None
        self._rest = b""
        advance = self.sim.advance

        def listening(now: float) -> bytes:
            data = advance(now)
            *lines, self._rest = (self._rest + data).split(b"\n")
            self.heard += [(now, line.decode("latin-1").strip()) for line in lines]
            return data

        self.sim.advance = listening  # type: ignore[method-assign]

    def turn(self, limit_s: float) -> None:
        before = len(self.sent)
        super().turn(limit_s)
        self.asked_s += [self.now] * self.sent.count(b"?", before)
        if self.held_s is None and b"!" in self.sent[before:]:
            self.held_s = self.now

    def first(self, *beginnings: str, since_s: float = 0.0) -> float | None:
        """When a line that begins so was heard."""
        return next((at for at, line in self.heard if at >= since_s and line.startswith(beginnings)), None)


def rows() -> list[Row]:
    """The table of all faults and moments."""
    moments = list(_moments())
    table = [_row(name, moment, made(moment), LINES) for name, made in FAULTS.items() for moment in moments]
    change = _pen_change()
    return [*table, *(_row(name, change, FAULTS[name](change), IN_TWO_PENS) for name in AT_A_PEN_CHANGE)]


def _row(name: str, moment: Moment, faults: tuple[Fault, ...], lines: list[Line]) -> Row:
    pair = Watched(*faults).ready()
    begun_s = pair.now
    pair.session.start(lines, begun_s)
    said_s, verdict, end = _ended(pair)
    sign, seen_s = _sign(pair, end, begun_s)
    whole = _whole(pair)
    if not sign and whole == STROKES and missing_mm(pair.sim.ink, DRAWING) < TOUCHES_MM:
        sign, seen_s = "none: the drawing is as it should be", said_s
    seconds = round(max(0.0, said_s - seen_s), 3) if sign else None
    stated = {"certainly": end.strokes_certain, "possibly": end.strokes_possible, "true": whole}
    outcome = outcome_of(sign=sign, seconds=seconds, **stated)
    limits = _UNSEEN if outcome == "undetectable" else ""
    if outcome == "ok" and _touched(pair) > end.strokes_possible:
        outcome, limits = "wrong", "a stroke that is said not to be touched has ink"
    if outcome == "wrong":
        limits = limits or "the truth is outside, or the verdict late"
    return Row("grbl", name, moment.name, sign, verdict, seconds, **stated, outcome=outcome, limits=limits)


def _ended(pair: Watched) -> tuple[float, str, Ended]:
    """When the verdict was told, in words, and the end; a machine that waits is stopped by a person after a while."""
    first: tuple[float, str] | None = None
    event: Event = _next(pair)
    if isinstance(event, Waiting):
        first = pair.now, "waiting"
        pair.wait(10.0)
        pair.session.stop(pair.now)
        event = pair.until(Ended)
    assert isinstance(event, Ended)
    said_s, verdict = first or (pair.now, event.verdict.value)
    return said_s, verdict if first is None else f"{verdict}, {event.verdict.value}", event


def _next(pair: Watched) -> Waiting | Ended:
    while True:
        for event in pair.events:
            if isinstance(event, Waiting | Ended):
                return event
        pair.turn(pair.now + 1.0)


def _sign(pair: Watched, end: Ended, begun_s: float) -> tuple[str, float]:
    """What can first be seen on the wire, and when; an empty sign where nothing can."""
    signs = {
        "error": pair.first("error:", since_s=begun_s),
        "alarm": pair.first("ALARM:", "<Alarm", since_s=begun_s),
        "Hold that nobody asked for": None if b"!" in pair.sent else pair.first("<Hold", since_s=begun_s),
        "banner": None if b"\x18" in pair.sent else pair.first("Grbl", since_s=begun_s),
        "off its path": _off_path(pair, begun_s),
        "Idle with answers missing": None,
        "an answer too many": None,
        "end of the file": None,
        "no answer": None,
    }
    if any(isinstance(event, Waiting) for event in pair.events):
        signs["Hold that nobody asked for"] = pair.first("<Hold", since_s=begun_s)
    if end.verdict is Verdict.RESTARTED:
        signs["banner"] = pair.first("Grbl", since_s=begun_s)
    if end.verdict is Verdict.UNPLUGGED:
        signs["end of the file"] = pair.now
    if end.verdict is Verdict.SILENT and pair.sim.advance(pair.now) == b"" and not end.position_known:
        last_s = pair.heard[-1][0]
        signs["no answer"] = next(at for at in pair.asked_s if at > last_s)
    if "more lines than were sent" in end.why:
        signs["an answer too many"] = [at for at, line in pair.heard if line == "ok" and at <= _held_s(pair)][-1]
    if end.verdict is Verdict.SILENT and end.position_known:
        last_ok_s = [at for at, line in pair.heard if line == "ok" and at < pair.now - 3.0][-1]
        signs["Idle with answers missing"] = pair.first("<Idle", since_s=last_ok_s)
    seen = [(at, sign) for sign, at in signs.items() if at is not None]
    return (min(seen)[1], min(seen)[0]) if seen else ("", 0.0)


def _held_s(pair: Watched) -> float:
    """When the session asked for a feed hold."""
    return pair.told_at[-1][0] if pair.held_s is None else pair.held_s


def _off_path(pair: Watched, begun_s: float) -> float | None:
    """When the first of two reports in motion, one behind the other, said a place off the programmed path."""
    reports = [(at, event) for at, event in pair.told_at if at >= begun_s and isinstance(event, Status)]
    off = [(at, event.state != "Idle" and _off_mm(event) > OFF_MM) for at, event in reports]
    return next((at for (at, first), (_, second) in pairwise(off) if first and second), None)


def _program_path() -> list[tuple[float, float, float]]:
    place = {"X": 0.0, "Y": 0.0, "Z": 0.0}
    places = [(0.0, 0.0, 0.0)]
    for line in LINES:
        place |= {word.letter: word.value for word in read_words(line.text.replace(" ", "")) if word.letter in "XYZ"}
        places.append((place["X"], place["Y"], place["Z"]))
    return [*places, (0.0, 0.0, 5.0)]


def _off_mm(report: Status) -> float:
    return min(_distance(report.position_mm, a, b) for a, b in pairwise(_PATH))


def _distance(p: tuple[float, ...], a: tuple[float, ...], b: tuple[float, ...]) -> float:
    along = [end - start for start, end in zip(a, b, strict=True)]
    square = sum(each * each for each in along)
    dot = sum(each * (at - start) for each, at, start in zip(along, p, a, strict=True))
    part = min(1.0, max(0.0, dot / square)) if square else 0.0
    return math.dist(p, [start + each * part for start, each in zip(a, along, strict=True)])


_PATH = _program_path()


def _whole(pair: Pair) -> int:
    """The first so many strokes are on the sheet as they should be."""
    for number, stroke in enumerate(DRAWING):
        if missing_mm([stroke], pair.sim.ink) > TOUCHES_MM:
            return number
    return STROKES


def _touched(pair: Pair) -> int:
    """No stroke from this number on has ink at its beginning."""
    starts = [line[0] for line in pair.sim.ink]
    touched = [n for n, stroke in enumerate(DRAWING) if any(math.dist(stroke[0], start) < OFF_MM for start in starts)]
    return max(touched, default=-1) + 1


def _moments() -> Iterator[Moment]:
    """Half-way: on the travel to a stroke and in the middle of it; and the last line that draws."""
    middle = STROKES // 2
    for name, line, place in (
        ("travel", _line(f"G0 X{2 * middle:.3f} Y0.000"), (2.0 * middle - 1.0, 5.0, 5.0)),
        ("mid stroke", _line(f"G1 X{2 * middle:.3f} Y5.000 F1500"), (2.0 * middle, 2.5, 0.0)),
        ("last line", _line(f"X{2 * (STROKES - 1):.3f} Y10.000"), (2.0 * (STROKES - 1), 7.5, 0.0)),
    ):
        yield _moment(name, line, place)


def _pen_change() -> Moment:
    """A minute after the machine has begun to wait for its second pen."""
    pair = Pair(plotter()).ready()
    pair.session.start(IN_TWO_PENS, pair.now)
    pair.until(Paused)
    return Moment("pen change", pair.now + 60.0, 0, 0, 0, 0)


def _line(text: str) -> int:
    return next(number for number, line in enumerate(LINES) if line.text == text)


def _moment(name: str, line: int, place: tuple[float, float, float]) -> Moment:
    """The moment when the pen comes nearest to this place, and the answer to the line that leads there."""
    pair = Pair(plotter()).ready()
    begun, oks, nearest, at_s = len(pair.sent), pair.sim.oks, math.inf, 0.0
    pair.session.start(LINES, pair.now)
    while not any(isinstance(event, Ended) for event in pair.events):
        pair.turn(pair.now + 0.01)
        if (off := math.dist(pair.sim.position_mm, place)) < nearest:
            nearest, at_s = off, pair.now
    short = next(n for n in range(min(line, len(LINES) - 5), len(LINES)) if f"Y{5 + SHORT_MM:.3f}" in LINES[n].text)
    return Moment(name, at_s, line, _byte(pair.sent, begun, line), oks + line, _byte(pair.sent, begun, short))


def _byte(sent: bytes, begun: int, line: int) -> int:
    """Where the line begins in all that was sent: questions stand between lines and are no part of them."""
    at = begun
    for number in range(line):
        at = sent.index(f"{LINES[number].text}\n".encode(), at) + len(LINES[number].text) + 1
    return sent.index(f"{LINES[line].text}\n".encode(), at)
