"""Programs of several pens and whatever happens meanwhile: nothing is lost or comes early, and what is said is true."""

from __future__ import annotations

import contextlib
from collections.abc import Callable

from hypothesis import example, given, settings
from hypothesis import strategies as st

from firmware_protocol.errors import LocalProtocolError
from firmware_protocol.session import Ended, Paused, Verdict
from tests.firmware_protocol.grbl.driver import Line
from tests.firmware_protocol.grbl.pair import TOUCHES_MM, Pair, missing_mm, plotter, stroke_lines

APART_MM = 4.0
STROKES = [[(APART_MM * x, 0.0), (APART_MM * x, 5.0)] for x in range(6)]
CHANGES = (2, 5)
PARK_MM = (3.0, 40.0)
WISHES: dict[str, Callable[[Pair], object]] = {
    "stop": lambda pair: pair.session.stop(pair.now),
    "pause": lambda pair: pair.session.pause(pair.now),
    "halt": lambda pair: pair.session.pause(pair.now, at_once=True),
    "resume": lambda pair: pair.session.resume(pair.now),
    "feed hold": lambda pair: pair.sim.receive(b"!", pair.now),
    "cycle start": lambda pair: pair.sim.receive(b"~", pair.now),
    "unplug": lambda pair: pair.events.extend(pair.session.unplugged(pair.now)),
}
TO_THE_END: list[float | str] = ["cycle start", "resume", 30.0] * 6
COURSES = st.lists(st.one_of(st.floats(0.0, 2.0), st.sampled_from(sorted(WISHES))), max_size=14)


def program(first: int, *, change_first: bool) -> list[Line]:
    """From stroke `first` on; change_first: nobody knows whether its pen is in."""
    park = f"G0 X{PARK_MM[0]:g} Y{PARK_MM[1]:g}"
    lines: list[Line] = []
    for line in stroke_lines(STROKES):
        if line.stroke is not None and (not lines or lines[-1].stroke != line.stroke) and line.stroke in CHANGES:
            lines += [Line(park, line.stroke - 1), Line("M0", line.stroke - 1)]
        lines.append(line)
    left = [line for line in lines if line.stroke is None or line.stroke >= first]
    begins = next(number for number, line in enumerate(left) if line.stroke is not None)
    return [*left[:begins], *[Line(park), Line("M0")] * change_first, *left[begins:]]


def whole(pair: Pair, first: int) -> int:
    missing = (n for n in range(first, len(STROKES)) if missing_mm([STROKES[n]], pair.sim.ink) > TOUCHES_MM)
    return next(missing, len(STROKES))


def touched(pair: Pair, first: int) -> int:
    """By lines of ink: the pen, which stands at 0 before all, may leave a dot there."""
    places = (place for line in pair.sim.ink if len(line) > 1 for place in line)
    return max((round(x_mm / APART_MM) + 1 for x_mm, _ in places), default=first)


@settings(max_examples=40, deadline=None)
@given(COURSES, st.integers(0, 5), st.booleans(), st.booleans())
@example(["pause", 5.0, "stop"], 3, False, True)
@example([1.3, "halt", 1.3, "resume", "pause", 1.0, "stop"], 3, False, False)
def test_each_pen_is_waited_for_once_parked_and_the_truth_lies_within(
    course: list[float | str], first: int, change_first: bool, counting: bool
) -> None:
    pair = Pair(plotter(), flow="count" if counting else "line").ready()
    pair.session.start(program(first, change_first=change_first), pair.now)
    awaited = [*[first] * change_first, *(each for each in CHANGES if each > first)]
    changes: list[int | None] = []
    for step in [*course, *TO_THE_END]:
        told = len(pair.events)
        if isinstance(step, float):
            pair.wait(step)
        else:
            with contextlib.suppress(LocalProtocolError):
                WISHES[step](pair)
        if any(isinstance(event, Ended) for event in pair.events):
            break
        for event in pair.events[told:]:
            if isinstance(event, Paused) and event.change:
                changes.append(event.stroke)
                assert pair.sim.position_mm[:2] == PARK_MM
                assert touched(pair, first) <= awaited[len(changes) - 1] == event.stroke
        assert pair.session.strokes_certain <= whole(pair, first)
        assert touched(pair, first) <= pair.session.strokes_touched
    pair.wait(30.0)
    (end,) = [event for event in pair.events if isinstance(event, Ended)]
    assert first <= end.strokes_certain <= whole(pair, first)
    assert touched(pair, first) <= end.strokes_possible
    if end.verdict is Verdict.FINISHED:
        assert changes == awaited
        assert end.strokes_certain == whole(pair, first) == len(STROKES)
