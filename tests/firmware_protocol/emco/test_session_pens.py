"""A control that stops by itself where another pen is wanted, and a session that sends nothing until then."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from firmware_protocol.emco.blocks import rapid
from firmware_protocol.emco.dialects import DIALECTS, DialectName
from firmware_protocol.emco.simulator.setup import Setup
from firmware_protocol.emco.simulator.simulator import EmcoSimulator
from firmware_protocol.emco.states import State
from firmware_protocol.errors import LocalProtocolError
from firmware_protocol.session import Ended, Paused, Resumed, Verdict
from tests.firmware_protocol.emco.bench import Bench, Line, on_blocks, on_xonxoff, program

LINKS: list[Callable[..., Bench]] = [on_xonxoff, on_blocks]


def in_two_pens(dialect: DialectName) -> list[Line]:
    """Strokes 0 to 2, the pen change, strokes 3 to 5."""
    lines = program(dialect)
    first = next(number for number, line in enumerate(lines) if line.stroke == 3)
    change = [Line(rapid(x=0, y=0), 2), Line(f"M0 {DIALECTS[dialect].note('RED PEN')}", 2)]
    return [*lines[:first], *change, *lines[first:]]


def changing(on: Callable[..., Bench], dialect: DialectName) -> Bench:
    bench = on(EmcoSimulator(Setup(DIALECTS[dialect], "xonxoff" if on is on_xonxoff else "blocks")))
    bench.session.start(in_two_pens(dialect), bench.now)
    wait(bench, State.PAUSED)
    return bench


def wait(bench: Bench, *states: State, within_s: float = 1000.0) -> None:
    limit_s = bench.now + within_s
    while bench.session.state not in states:
        assert bench.now < limit_s, f"still {bench.session.state.value}"
        bench.step(limit_s)


@pytest.mark.parametrize("dialect", DIALECTS)
@pytest.mark.parametrize("on", LINKS)
def test_nothing_of_the_next_pen_is_sent_before_a_person_says_so(
    on: Callable[..., Bench], dialect: DialectName
) -> None:
    bench = changing(on, dialect)
    (paused,) = [event for event in bench.events if isinstance(event, Paused)]
    assert (paused.stroke, paused.change) == (3, True)
    assert "START" in paused.also
    assert (bench.whole, bench.touched, bench.session.strokes_touched) == (3, 3, 3)
    sent = len(bench.sent)
    limit_s = bench.now + 3600
    while bench.now < limit_s:
        bench.step(limit_s)
    assert len(bench.sent) == sent
    assert bench.session.state is State.PAUSED


@pytest.mark.parametrize("dialect", DIALECTS)
@pytest.mark.parametrize("on", LINKS)
def test_it_goes_on_to_the_end(on: Callable[..., Bench], dialect: DialectName) -> None:
    bench = changing(on, dialect)
    bench.session.resume(bench.now)
    wait(bench, State.READY, State.LOST)
    (end,) = bench.ends
    assert (end.verdict, end.estimated, end.strokes_possible) == (Verdict.FINISHED, True, 6)
    assert [type(each) for each in bench.events if isinstance(each, Paused | Resumed)] == [Paused, Resumed]
    assert bench.whole == 6


def test_stopped_at_the_pen_change_nothing_more_is_sent() -> None:
    bench = changing(on_xonxoff, "siemens")
    sent = len(bench.sent)
    bench.session.stop(bench.now)
    bench.step(bench.now + 1)
    (end,) = [each for each in bench.events if isinstance(each, Ended)]
    assert (end.verdict, end.strokes_possible, len(bench.sent)) == (Verdict.STOPPED, 3, sent)
    assert "RESET" in end.why


def test_elsewhere_it_cannot_be_resumed() -> None:
    bench = on_xonxoff(EmcoSimulator(Setup()))
    with pytest.raises(LocalProtocolError, match="pen change"):
        bench.session.resume(bench.now)
