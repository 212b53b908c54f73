"""A toolpath as commands for a Dobot Magician, one a line: `PTP 2 215.000 0.000 10.000 0.000`."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import chain, pairwise
from typing import TypeAlias

from daemon.errors import OutOfReach
from daemon.program.moves import pen_change
from daemon.shapes import Program, ProgramLine, Toolpath
from firmware_protocol.dobot.commands import ABSOLUTE, MOVL_XYZ, Value, command, text_of
from firmware_protocol.dobot.kinematics import SHEET_ORIGIN_MM, Reach

Place: TypeAlias = tuple[float, float]
"""x, y in mm, of the arm."""

CHORD_MM = 5.0
"""No segment is longer, so that what is executed is known as closely, and a stop cuts little."""
COMMANDS_S = 150.0
"""Short segments are drawn slower, so that no more commands a second are needed: the wire takes some 250."""
TRAVEL_MM_S, TRAVEL_MM_S2 = 150.0, 300.0
DRAW_MM_S2 = 100.0


def write_dobot(
    toolpath: Toolpath,
    *,
    sheet_origin_mm: tuple[float, float] = SHEET_ORIGIN_MM,
    up_mm: float,
    down_mm: float,
    draw_mm_s: float,
    straight: str = "CP",
) -> Program:
    """Speeds; for each stroke above its start, down, its points, up; park, also before M0 where the pen is changed.

    sheet_origin_mm: where the sheet's lower left corner lies on the arm, seen from the base axis: the sheet's x is the
    arm's, forward, and its y the arm's, to the left. up_mm, down_mm: heights of the pen on the arm. Within a stroke
    the arm moves by CP, which blends the segments; straight "PTP" makes each a move of its own, which stops between
    them: for an arm that takes no CP. Positions with 3 decimals, in segments of CHORD_MM at most. A stroke of one point
    is a dot. Raises OutOfReach, naming the first stroke that leaves the arm's reach and the largest sheet; ValueError
    for speeds and heights that make no sense.
    """
    if draw_mm_s <= 0 or up_mm <= down_mm or straight not in {"CP", "PTP"}:
        raise ValueError(f"draw_mm_s = {draw_mm_s}, up_mm = {up_mm}, down_mm = {down_mm}, straight = {straight}")
    strokes = [[_on_arm(x, y, sheet_origin_mm) for x, y in stroke.points.tolist()] for stroke in toolpath.strokes]
    park = _on_arm(*toolpath.park_mm, sheet_origin_mm)
    _check_reach(strokes, park, sheet_origin_mm, heights_mm=(down_mm, up_mm))
    speed_mm_s = draw_mm_s if straight == "PTP" else TRAVEL_MM_S
    lines = [ProgramLine(text) for text in _speeds(speed_mm_s, draw_mm_s)]
    for index, places in enumerate(strokes):
        lines += pen_change(toolpath, index, _move(park, up_mm))
        lines += [ProgramLine(text, index) for text in _stroke(places, up_mm, down_mm, draw_mm_s, straight)]
    lines.append(ProgramLine(_move(park, up_mm)))
    return Program(tuple(lines), len(strokes), toolpath.passes)


def _on_arm(x_mm: float, y_mm: float, origin_mm: Place) -> Place:
    return x_mm + origin_mm[0], y_mm + origin_mm[1]


def _speeds(move_mm_s: float, draw_mm_s: float) -> Iterator[str]:
    yield _text("PTPCoordinateParams", move_mm_s, move_mm_s, TRAVEL_MM_S2, TRAVEL_MM_S2)
    yield _text("PTPCommonParams", 100.0, 100.0)
    yield _text("CPParams", DRAW_MM_S2, draw_mm_s, DRAW_MM_S2, 0)


def _stroke(places: Sequence[Place], up_mm: float, down_mm: float, draw_mm_s: float, straight: str) -> Iterator[str]:
    yield _move(places[0], up_mm)
    yield _move(places[0], down_mm)
    for start, end in pairwise(_rounded(chain(places[:1], *(_chords(*pair) for pair in pairwise(places))))):
        if straight == "PTP":
            yield _move(end, down_mm)
        else:
            speed_mm_s = min(draw_mm_s, max(1.0, math.dist(start, end) * COMMANDS_S))
            yield _text("CP", ABSOLUTE, *end, down_mm, speed_mm_s)
    yield _move(places[-1], up_mm)


def _chords(start: Place, end: Place) -> Iterator[Place]:
    """The points of a straight line behind its start, none further than CHORD_MM from the one before."""
    count = max(1, math.ceil(math.dist(start, end) / CHORD_MM))
    for step in range(1, count + 1):
        yield start[0] + (end[0] - start[0]) * step / count, start[1] + (end[1] - start[1]) * step / count


def _rounded(places: Iterator[Place]) -> list[Place]:
    """With 3 decimals, and none twice in a row: an arm alarms at the same point twice."""
    rounded = [(round(x, 3), round(y, 3)) for x, y in places]
    return rounded[:1] + [new for old, new in pairwise(rounded) if new != old]


def _move(place: Place, height_mm: float) -> str:
    return _text("PTP", MOVL_XYZ, *place, height_mm, 0.0)


def _text(name: str, *values: Value) -> str:
    return text_of(command(name, *values))


def _check_reach(strokes: list[list[Place]], park: Place, origin_mm: Place, heights_mm: tuple[float, float]) -> None:
    """Every straight way, also those between the strokes, at every height that the pen takes."""
    reach = Reach.between(*heights_mm)
    if reach is None:
        raise OutOfReach(f"the arm does not reach the heights {heights_mm[0]:g} and {heights_mm[1]:g} mm: change them")
    before: Place | None = None
    for index, places in enumerate(strokes):
        way = places if before is None else [before, *places]
        bad = next((end for start, end in pairwise([way[0], *way]) if not reach.holds(start, end)), None)
        if bad is not None:
            raise OutOfReach(f"stroke {index} {_sentence(bad, strokes, origin_mm, reach)}")
        before = places[-1]
    if not reach.holds(before or park, park):
        raise OutOfReach(f"the way to the park position {_sentence(park, strokes, origin_mm, reach)}")


def _sentence(place: Place, strokes: list[list[Place]], origin_mm: Place, reach: Reach) -> str:
    xs, ys = [[place[axis] - origin_mm[axis] for places in strokes for place in places] for axis in (0, 1)]
    proportion = max(1.0, *xs) / max(1.0, *ys) if xs else 1.0
    width_mm, height_mm = reach.largest_box_mm(origin_mm, proportion)
    fits = (
        f"the largest sheet of its proportions there is {width_mm:.0f} x {height_mm:.0f} mm: make the drawing smaller"
    )
    if not width_mm:
        fits = f"sheet_origin_mm itself is not in reach: set it near ({SHEET_ORIGIN_MM[0]:g}, {SHEET_ORIGIN_MM[1]:g})"
    to_mm = (place[0] - origin_mm[0], place[1] - origin_mm[1])
    return (
        f"leaves the arm's reach on its way to ({to_mm[0]:.1f}, {to_mm[1]:.1f}) mm of the sheet; with its corner at "
        f"({origin_mm[0]:g}, {origin_mm[1]:g}) mm on the arm, which reaches {reach.low_mm:.0f} to {reach.high_mm:.0f} "
        f"mm from its axis at these heights of the pen, {fits}"
    )
