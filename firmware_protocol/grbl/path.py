"""Where a program leads the pen: the modal state before and after each line, and the move that the line makes."""

from __future__ import annotations

import itertools
import re
from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

from firmware_protocol.grbl.moves import Arc, Move, Straight
from firmware_protocol.grbl.replies import Triple

MM_PER_INCH = 25.4

Place: TypeAlias = tuple[float | None, float | None, float | None]
"""x, y, z in mm, as G-code speaks of them; None where nobody knows."""
NOWHERE: Place = (None, None, None)

_WORD = re.compile(r"([A-Z])([-+.\d]+)")
_RETURNS = {280, 300, 382, 383, 384, 385, 530}
"""G28, G30, probing and G53, times ten: the controller alone knows where they lead."""
_SHIFTS = {100, 431, 550, 560, 570, 580, 590, 920, 921, 922, 923}
"""G10, G43.1, G55 to G59 and G92, times ten: reports speak of other coordinates behind them."""
_AXES, _MODES = set("XYZ"), set("GMFS")
_MOTIONS = {0, 10, 20, 30, 800}


class Modal(NamedTuple):
    """What a controller keeps from line to line; as it is after a reset where nothing is stated.

    blind: coordinates have been shifted, so reports and program can no longer be compared and no place is known.
    """

    place: Place = NOWHERE
    motion: int = 0
    inches: bool = False
    relative: bool = False
    plane: int = 17
    feed_mm_min: float = 0.0
    spindle: int = 5
    speed: float = 0.0
    blind: bool = False

    @property
    def at(self) -> Triple | None:
        """The place where all of it is known."""
        x, y, z = self.place
        return None if x is None or y is None or z is None else (x, y, z)


class Step(NamedTuple):
    """One line of a program. astray: it moves, and where is not known; draws: it moves in X or Y other than by G0."""

    text: str
    before: Modal
    after: Modal
    move: Move | None = None
    astray: bool = False

    @property
    def draws(self) -> bool:
        if self.move is None or self.after.motion == 0:
            return False
        return isinstance(self.move, Arc) or self.move.start[:2] != self.move.end[:2]


class Spot(NamedTuple):
    """A place on the path: the line, and the part of its move that has been made (0 to 1)."""

    line: int
    part: float


class Path:
    """The steps of a program, line by line. steps_mm: motor steps a mm of each axis, by which GRBL drops tiny moves."""

    def __init__(self, texts: Sequence[str], start: Modal, *, steps_mm: Triple) -> None:
        self.steps: list[Step] = []
        self._start, self._steps_mm = start, steps_mm
        self._extend(texts)

    @property
    def end(self) -> Modal:
        """The state behind the last line."""
        return self.steps[-1].after if self.steps else self._start

    def replace_from(self, line: int, texts: Sequence[str]) -> None:
        """From `line` on the program goes on in another way."""
        del self.steps[line:]
        self._extend(texts)

    def back_from(self, line: int, moves: int) -> int:
        """The line before which all lines are done when so many moves before `line` may still wait in the planner."""
        while line > 0 and moves > 0:
            line -= 1
            moves -= self._takes_block(self.steps[line])
        return line

    def spots(self, place: Triple, first: int, behind: int, *, within_mm: float) -> list[Spot] | None:
        """Where on the lines from `first` up to `behind` the pen may be; None where the path itself is not known."""
        spots = []
        for line in range(max(first, 0), min(behind, len(self.steps))):
            step = self.steps[line]
            if step.astray or step.before.blind or (step.move is None and step.before.at is None):
                return None
            move = step.move or _standing(step)
            off_mm, part = move.nearest(place)
            if off_mm <= within_mm + (move.off_circle_mm if isinstance(move, Arc) else 0.0):
                spots.append(Spot(line, part))
        return spots

    def _extend(self, texts: Sequence[str]) -> None:
        modal = self.end
        for text in texts:
            step = _step(text, modal)
            self.steps.append(step)
            modal = step.after

    def _takes_block(self, step: Step) -> bool:
        if step.move is None:
            return False
        if isinstance(step.move, Arc):
            return True
        ends = zip(step.move.start, step.move.end, self._steps_mm, strict=True)
        return any(round(a * steps) != round(b * steps) for a, b, steps in ends)


def _standing(step: Step) -> Move:
    at = step.before.at
    assert at is not None
    return Straight(at, at)


def _step(text: str, modal: Modal) -> Step:
    plain = text.replace(" ", "").upper()
    if plain.startswith("$"):
        homes = plain.startswith("$H")
        return Step(text, modal, modal._replace(place=NOWHERE) if homes else modal, astray=homes)
    try:
        words = [(letter, float(number)) for letter, number in _WORD.findall(plain)]
    except ValueError:
        return Step(text, modal, modal)  # it will be refused
    values = dict(words)
    after, codes = modal, set[int]()
    if values.keys() & _MODES:
        codes = {round(value * 10) for letter, value in words if letter == "G"}
        after = _modes(modal, codes, {int(value) for letter, value in words if letter == "M"}, values)
    if codes & _RETURNS:
        return Step(text, modal, after._replace(place=NOWHERE), astray=True)
    if after.blind or not values.keys() & _AXES or after.motion == 80:
        return Step(text, modal, after)
    return _moved(text, modal, after, values)


def _modes(modal: Modal, codes: set[int], machine: set[int], values: dict[str, float]) -> Modal:
    inches = 200 in codes or (modal.inches and 210 not in codes)
    motion = next((code // 10 for code in codes if code in _MOTIONS), modal.motion)
    spindle = next((word for word in machine if word in (3, 4, 5)), modal.spindle)
    feed = values["F"] * (MM_PER_INCH if inches else 1.0) if "F" in values else modal.feed_mm_min
    after = Modal(
        place=NOWHERE if codes & _SHIFTS else modal.place,
        motion=motion,
        inches=inches,
        relative=910 in codes or (modal.relative and 900 not in codes),
        plane=next((code // 10 for code in codes if code in (170, 180, 190)), modal.plane),
        feed_mm_min=feed,
        spindle=spindle,
        speed=values.get("S", modal.speed),
        blind=modal.blind or bool(codes & _SHIFTS),
    )
    if machine & {2, 30}:
        return after._replace(motion=1, plane=17, relative=False, spindle=5)
    return after


def _moved(text: str, before: Modal, modal: Modal, values: dict[str, float]) -> Step:
    unit_mm = MM_PER_INCH if modal.inches else 1.0
    x, y, z = modal.place
    place = (
        _axis(values.get("X"), x, unit_mm, relative=modal.relative),
        _axis(values.get("Y"), y, unit_mm, relative=modal.relative),
        _axis(values.get("Z"), z, unit_mm, relative=modal.relative),
    )
    after = modal._replace(place=place)
    start, end = before.at, after.at
    if start is None or end is None:
        return Step(text, before, after, astray=True)
    if modal.motion in (0, 1):
        return Step(text, before, after, Straight(start, end))
    if modal.plane != 17 or not values.keys() & {"I", "J"}:
        return Step(text, before, after, astray=True)
    centre = start[0] + values.get("I", 0.0) * unit_mm, start[1] + values.get("J", 0.0) * unit_mm
    return Step(text, before, after, Arc(start, end, centre, clockwise=modal.motion == 2))


def _axis(value: float | None, old: float | None, unit_mm: float, *, relative: bool) -> float | None:
    if value is None:
        return old
    if not relative:
        return value * unit_mm
    return None if old is None else old + value * unit_mm


def extent_mm(path: Path) -> tuple[Triple, Triple] | None:
    """The lowest and the highest place of all moves whose place is known; None when there is none.

    Where the pen stands before the first of them counts on an axis only if no move leads away from there.
    """
    places = [place for step in path.steps if step.move for place in step.move.corners]
    places += [step.after.at for step in path.steps if step.astray and step.after.at]
    if not places:
        return None
    x, y, z = (_reached([place[axis] for place in places]) for axis in range(3))
    return (x[0], y[0], z[0]), (x[1], y[1], z[1])


def _reached(along: list[float]) -> tuple[float, float]:
    led_to = list(itertools.dropwhile(lambda value: value == along[0], along)) or along
    return min(led_to), max(led_to)
