"""What is left of a program that was cut: the lines that bring the controller back to the cut and go on from there."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from firmware_protocol.gcode import format_line, format_number
from firmware_protocol.grbl.moves import Arc, Move
from firmware_protocol.grbl.path import Modal, Path, Spot, Step

OVERLAP_MM = 0.3
"""So much of the ink before a cut is drawn again: a pen that is lowered begins to write a little late."""
_PLANE_WORD = re.compile(r"[XY]")


class Part(NamedTuple):
    """A line on its way to the controller. number: of the job's line (from 0) that it is; None for what was added."""

    text: str
    stroke: int | None = None
    number: int | None = None


def from_line(parts: Sequence[Part], path: Path, line: int, *, lifted: Modal) -> list[Part]:
    """The program from the beginning of `line` on.

    parts: the program as it was sent, path: its steps. lifted: the controller's state, the pen being up.
    """
    if line >= len(parts):
        return []
    before = path.steps[line].before
    added = [Part(text) for text in _back_to(before, lifted, before.place[:2])]
    return [*added, *_stated(parts, path, line)]


def from_spot(parts: Sequence[Part], path: Path, spot: Spot, *, lifted: Modal) -> list[Part]:
    """The program from a place on one of its lines on: travel there, lower the pen as the stroke did it, go on drawing.

    A cut outside the drawn part of a stroke begins with the stroke, or behind it when all of it is drawn; the way from
    there to where the pen is changed is its own.
    """
    line, stroke = spot.line, parts[spot.line].stroke
    if stroke is None:
        return from_line(parts, path, line, lifted=lifted)
    mine = [index for index, part in enumerate(parts) if part.stroke == stroke]
    drawing = [index for index in mine if path.steps[index].draws]
    if drawing and line > drawing[-1]:
        travels = (index for index in mine if index >= line and _PLANE_WORD.search(path.steps[index].text.upper()))
        return from_line(parts, path, next(travels, mine[-1] + 1), lifted=lifted)
    ramps = any(_ramps(path.steps[index].move) for index in mine if index <= line)
    if line not in drawing or ramps or path.steps[mine[0]].before.blind:
        return from_line(parts, path, mine[0], lifted=lifted)
    return _from_ink(parts, path, _earlier(spot, path, drawing), mine[0], lifted=lifted)


def _from_ink(parts: Sequence[Part], path: Path, spot: Spot, first: int, *, lifted: Modal) -> list[Part]:
    """first: the line that the stroke begins with."""
    step, before = path.steps[spot.line], path.steps[first].before
    assert step.move is not None
    at = step.move.at(spot.part)
    lines = [*_back_to(before, lifted, at[:2])]
    lines += [_with_motion(each) for each in path.steps[first : spot.line] if not _PLANE_WORD.search(each.text.upper())]
    added = [Part(text, parts[spot.line].stroke) for text in (*lines, "G21 G90")]
    rest = Part(_remainder(step, spot.part), parts[spot.line].stroke, parts[spot.line].number)
    modes = [Part(text) for text in _modes(step.after)]
    return [*added, rest, *modes, *_stated(parts, path, spot.line + 1)]


def _back_to(before: Modal, lifted: Modal, at: Sequence[float | None]) -> Iterator[str]:
    """Lines that bring a controller whose pen is up to the place `at` and into the state `before`."""
    yield "G21 G90"
    if at[0] is not None and at[1] is not None:
        yield format_line([("G", 0), ("X", at[0]), ("Y", at[1])])
    if (before.spindle, before.speed) != (lifted.spindle, lifted.speed):
        yield "M5" if before.spindle == 5 else format_line([("M", before.spindle), ("S", before.speed)])
    height_mm = before.place[2]
    if height_mm is not None and height_mm != lifted.place[2]:
        yield format_line([("G", 0), ("Z", height_mm)])
    if before.feed_mm_min:
        yield format_line([("F", before.feed_mm_min)])
    yield from _modes(before)


def _modes(modal: Modal) -> Iterator[str]:
    """What differs from G21 G90 G17."""
    words = [*["G20"] * modal.inches, *["G91"] * modal.relative, *[f"G{modal.plane}"] * (modal.plane != 17)]
    if words:
        yield " ".join(words)


def _stated(parts: Sequence[Part], path: Path, line: int) -> list[Part]:
    """The parts from `line` on; the first that moves says how, as what it relied on may be forgotten."""
    rest = list(parts[line:])
    for index, step in enumerate(path.steps[line : len(parts)]):
        if step.move is not None or step.astray:
            rest[index] = rest[index]._replace(text=_with_motion(step))
            break
    return rest


def _with_motion(step: Step) -> str:
    plain = step.text.replace(" ", "").upper()
    moves = step.move is not None or step.astray
    if not moves or plain.startswith("$") or step.after.motion != step.before.motion or _says_motion(plain):
        return step.text
    return f"G{step.before.motion}{plain}"


def _says_motion(plain: str) -> bool:
    codes = {code.lstrip("0") or "0" for code in _codes(plain)}
    return bool(codes & {"0", "1", "2", "3", "28", "30", "38.2", "38.3", "38.4", "38.5", "53"})


def _codes(plain: str) -> list[str]:
    found = []
    for piece in plain.split("G")[1:]:
        digits = len(piece) - len(piece.lstrip("0123456789."))
        found.append(piece[:digits])
    return found


def _earlier(spot: Spot, path: Path, drawing: Sequence[int]) -> Spot:
    """The place OVERLAP_MM before `spot`, at most the beginning of the drawn lines without a gap."""
    line, part, left_mm = spot.line, spot.part, OVERLAP_MM
    while True:
        move = path.steps[line].move
        assert move is not None
        if move.length_mm * part >= left_mm:
            return Spot(line, part - left_mm / move.length_mm)
        if line - 1 not in drawing:
            return Spot(line, 0.0)
        left_mm -= move.length_mm * part
        line, part = line - 1, 1.0


def _remainder(step: Step, part: float) -> str:
    move = step.move
    assert move is not None
    at = move.at(part)
    # The overlap keeps the two ends of an arc apart; where they met it would be drawn as a full circle.
    words = [("G", float(step.after.motion)), ("X", move.end[0]), ("Y", move.end[1])]
    if isinstance(move, Arc):
        words += [("I", move.centre[0] - at[0]), ("J", move.centre[1] - at[1])]
    text = format_line(words)
    return f"{text} F{format_number(step.after.feed_mm_min)}" if step.after.feed_mm_min else text


def _ramps(move: Move | None) -> bool:
    return move is not None and _moves_flat(move) and move.start[2] != move.end[2]


def _moves_flat(move: Move) -> bool:
    return isinstance(move, Arc) or move.start[:2] != move.end[:2]
