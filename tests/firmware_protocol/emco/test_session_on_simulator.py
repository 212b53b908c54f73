"""Sessions and the simulated control talk at the speed of the line, and the ink is compared with what was said."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from firmware_protocol.emco.dialects import DialectName
from firmware_protocol.emco.line_format import FORMATS, FormatName
from firmware_protocol.emco.session import Control
from firmware_protocol.emco.simulator.faults import (
    AlarmInBlock,
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
from firmware_protocol.emco.states import State
from firmware_protocol.session import Accepted, Ended, Sent, Verdict
from tests.firmware_protocol.emco.bench import STROKES, Bench, end_lines, knowing, on_blocks, on_xonxoff, program

BAUDS = (300, 600, 1200, 2400, 4800, 9600)
DIALECT_NAMES: tuple[DialectName, ...] = ("siemens", "fanuc")


def told_truth(bench: Bench, end: Ended) -> bool:
    return end.strokes_certain <= bench.whole and bench.touched <= end.strokes_possible


@pytest.mark.parametrize("dialect", DIALECT_NAMES)
@pytest.mark.parametrize("blocks", [False, True], ids=["xonxoff", "blocks"])
def test_a_program_is_drawn_whole_and_never_said_to_be_before_it_is(dialect: DialectName, blocks: bool) -> None:
    setup = Setup(link="blocks" if blocks else "xonxoff")
    bench = (on_blocks if blocks else on_xonxoff)(EmcoSimulator(setup), control=knowing(setup, dialect))
    end = bench.draw(program(dialect))
    assert (end.verdict, end.strokes_possible, end.estimated) == (Verdict.FINISHED, STROKES, True)
    assert 0 < end.strokes_certain <= STROKES
    assert [[(line[0], line[-1]) for line in bench.sim.ink]] == [
        [((2 * stroke, 0), (2 * stroke, 10)) for stroke in range(STROKES)]
    ]
    assert bench.sim.path[-1][0] <= bench.now
    assert bench.sim.screen == ""


@pytest.mark.parametrize("baud", BAUDS)
@pytest.mark.parametrize("line", list(FORMATS))
def test_nothing_is_lost_at_any_speed_with_the_smallest_buffer(baud: int, line: FormatName) -> None:
    bench = on_xonxoff(EmcoSimulator(Setup(baud=baud, line=FORMATS[line], buffer_bytes=256)))
    end = bench.draw(program("fanuc", strokes=10))
    assert (end.verdict, bench.sim.overruns, bench.sim.unread, bench.whole) == (Verdict.FINISHED, 0, 0, 10)
    assert bench.sim.peak <= 256


def test_the_fastest_line_makes_the_control_hold_the_host() -> None:
    """Otherwise the test above would say nothing."""
    bench = on_xonxoff(EmcoSimulator(Setup(baud=9600, buffer_bytes=256)))
    bench.draw(program("fanuc", strokes=10))
    assert 192 <= bench.sim.peak <= 192 + 32
    assert bench.sim.xons > 2


def test_a_control_that_takes_few_characters_behind_xoff_gets_short_chunks() -> None:
    few = Setup(baud=9600, after_xoff=10)
    bench = on_xonxoff(EmcoSimulator(few), chunk_bytes=4)
    assert bench.draw(program()).verdict is Verdict.FINISHED
    assert bench.sim.overruns == 0
    assert on_overrun(few, chunk_bytes=64) > 0


def on_overrun(setup: Setup, *, chunk_bytes: int) -> int:
    bench = on_xonxoff(EmcoSimulator(setup), chunk_bytes=chunk_bytes)
    bench.draw(program())
    return bench.sim.overruns


@pytest.mark.parametrize("software_parity", [False, True])
def test_parity_in_software_or_in_the_port(software_parity: bool) -> None:
    bench = on_xonxoff(EmcoSimulator(Setup(line=FORMATS["7E1"], software_parity=software_parity)))
    assert bench.draw(program()).verdict is Verdict.FINISHED
    assert bench.whole == STROKES


@pytest.mark.parametrize("blocks", [False, True], ids=["xonxoff", "blocks"])
def test_two_programs_one_behind_the_other(blocks: bool) -> None:
    setup = Setup(link="blocks" if blocks else "xonxoff")
    bench = (on_blocks if blocks else on_xonxoff)(EmcoSimulator(setup))
    bench.draw(program(strokes=2))
    bench.events.clear()
    assert bench.draw(program()).verdict is Verdict.FINISHED
    assert bench.whole == STROKES


def test_text_can_be_the_answer() -> None:
    bench = on_blocks(EmcoSimulator(Setup(link="blocks", ack=b"ok", nak=b"error")))
    assert bench.draw(program()).verdict is Verdict.FINISHED
    assert [e.line for e in bench.events if isinstance(e, Accepted)] == list(range(len(program())))


@given(
    stop_at=st.floats(0.05, 14.0), blocks=st.booleans(), dialect=st.sampled_from(DIALECT_NAMES), ahead=st.integers(1, 5)
)
@settings(max_examples=40, deadline=None)
def test_a_stop_tells_the_truth_at_any_moment(stop_at: float, blocks: bool, dialect: DialectName, ahead: int) -> None:
    setup = Setup(link="blocks" if blocks else "xonxoff", ahead=ahead)
    bench = (on_blocks if blocks else on_xonxoff)(EmcoSimulator(setup), control=knowing(setup, dialect))
    end = bench.draw(program(dialect), stop_at=stop_at)
    bench.sim.advance(bench.now + 100)
    assert told_truth(bench, end)
    assert not end.pen_lifted or bench.sim.position_mm[2] == 5.0


def test_a_stop_lifts_the_pen_and_the_next_job_is_drawn() -> None:
    setup = Setup()
    bench = on_xonxoff(EmcoSimulator(setup), control=knowing(setup))
    end = bench.draw(program(), stop_at=3.0)
    assert (end.verdict, end.pen_lifted, bench.session.state) == (Verdict.STOPPED, True, State.READY)
    assert bench.sim.position_mm[2] == 5.0
    bench.events.clear()
    assert bench.draw(program()).verdict is Verdict.FINISHED
    assert bench.whole == STROKES


@pytest.mark.parametrize("fault", [Stall(5.0), LoseXon(2)])
def test_a_control_that_holds_for_ever_ends_the_job(fault: Stall | LoseXon) -> None:
    setup = Setup()
    bench = on_xonxoff(EmcoSimulator(setup, faults=[fault]), control=knowing(setup), xoff_limit_s=60)
    end = bench.draw(program())
    assert (end.verdict, end.pen_lifted) == (Verdict.SILENT, False)
    assert "XOFF for 60 s" in end.why
    assert told_truth(bench, end)


DEAF = [AlarmInBlock(25), Reset(4.0), PowerCut(4.0), FlipBit(500)]
DEAF_AT_ONCE = [AlarmInBlock(6), Reset(0.15), PowerCut(0.15), FlipBit(100)]
"""Before the control has said its first XOFF."""


def named(fault: object) -> str:
    return type(fault).__name__


@pytest.mark.parametrize("fault", DEAF_AT_ONCE, ids=named)
def test_a_control_that_no_longer_reads_is_noticed_where_its_buffer_is_known(fault: Reset) -> None:
    setup = Setup(line=FORMATS["7E1"])
    bench = on_xonxoff(EmcoSimulator(setup, faults=[fault]), control=knowing(setup))
    end = bench.draw(program())
    assert end.verdict is Verdict.SILENT
    assert "no longer reads" in end.why
    assert told_truth(bench, end)


@pytest.mark.parametrize("fault", DEAF, ids=named)
def test_a_control_that_falls_silent_while_it_holds_is_noticed(fault: Reset) -> None:
    setup = Setup(line=FORMATS["7E1"])
    bench = on_xonxoff(EmcoSimulator(setup, faults=[fault]), control=knowing(setup))
    end = bench.draw(program())
    assert end.verdict is Verdict.SILENT
    assert "XOFF for 300 s" in end.why
    assert told_truth(bench, end)


@pytest.mark.parametrize("fault", DEAF, ids=named)
def test_on_a_line_slower_than_the_pen_nothing_can_be_noticed_and_the_end_is_called_an_estimate(fault: Reset) -> None:
    setup = Setup(line=FORMATS["7E1"], baud=600)
    bench = on_xonxoff(EmcoSimulator(setup, faults=[fault]), control=knowing(setup))
    end = bench.draw(program())
    assert (end.verdict, end.estimated) == (Verdict.FINISHED, True)
    assert "the control does not say so" in end.why
    assert bench.whole < STROKES


@pytest.mark.parametrize("fault", [*DEAF[:3], LoseAck(20)], ids=named)
def test_a_missing_answer_ends_the_job(fault: Reset) -> None:
    setup = Setup(link="blocks")
    bench = on_blocks(EmcoSimulator(setup, faults=[fault]), control=knowing(setup))
    end = bench.draw(program())
    assert end.verdict is Verdict.SILENT
    assert "has not acknowledged block" in end.why
    assert told_truth(bench, end)


def test_a_block_with_wrong_parity_is_repeated() -> None:
    setup = Setup(link="blocks", line=FORMATS["7E1"])
    bench = on_blocks(EmcoSimulator(setup, faults=[FlipBit(500)]))
    assert bench.draw(program()).verdict is Verdict.FINISHED
    assert bench.whole == STROKES
    assert len(bench.sent) > len("".join(f"{line.text}\n" for line in program()))


@pytest.mark.parametrize("blocks", [False, True], ids=["xonxoff", "blocks"])
def test_unplugging_ends_the_job(blocks: bool) -> None:
    setup = Setup(link="blocks" if blocks else "xonxoff")
    simulator = EmcoSimulator(setup, faults=[Unplug(4.0)])
    bench = (on_blocks if blocks else on_xonxoff)(simulator, control=knowing(setup))
    end = bench.draw(program())
    bench.sim.advance(bench.now + 100)
    assert (end.verdict, end.pen_lifted) == (Verdict.UNPLUGGED, False)
    assert told_truth(bench, end)


@pytest.mark.parametrize("acceleration", [600.0, 1000.0, 5000.0])
@pytest.mark.parametrize("ahead", [1, 4])
def test_a_control_that_works_is_never_taken_for_deaf(acceleration: float, ahead: int) -> None:
    setup = Setup(acceleration_mm_s2=acceleration, ahead=ahead)
    bench = on_xonxoff(EmcoSimulator(setup), control=knowing(setup))
    assert bench.draw(program(parts=40)).verdict is Verdict.FINISHED


def test_sent_is_said_before_drawn_and_lies_apart_from_it() -> None:
    bench = on_xonxoff(EmcoSimulator(Setup(buffer_bytes=1024)), control=Control(end_lines("siemens")))
    bench.draw(program())
    (sent,) = [event for event in bench.events if isinstance(event, Sent)]
    assert sent.drawn_in_s > 5.0
    assert bench.events.index(sent) < len(bench.events) - 1
