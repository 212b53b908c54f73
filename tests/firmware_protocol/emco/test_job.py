"""What a control has of a program, what it must have drawn of it, and when."""

from __future__ import annotations

from firmware_protocol.emco.job import FASTEST, Job
from firmware_protocol.session import Verdict
from tests.firmware_protocol.emco.bench import Line


def job() -> Job:
    """Four blocks of five bytes in two strokes, 8 s each."""
    lines = [Line("G0X0", 0), Line("G1X1", 0), Line("G0X2", 1), Line("G1X3", 1)]
    return Job(lines, times=lambda texts: [8.0 * n for n in range(1, len(texts) + 1)], line_end=b"\n")


def test_a_block_begins_with_its_first_byte_and_arrives_with_its_last() -> None:
    drawn = job()
    assert drawn.take(7) == b"G0X0\nG1"
    drawn.arrived(100.0)
    assert (drawn.begun, drawn.handed, drawn.drawn_at) == (2, 1, 108.0)
    drawn.take(3)
    drawn.arrived(101.0)
    assert (drawn.begun, drawn.handed, drawn.drawn_at) == (2, 2, 116.0)


def test_a_control_that_waits_for_blocks_draws_from_their_arrival() -> None:
    drawn = job()
    drawn.take(5)
    drawn.arrived(100.0)
    drawn.take(5)
    drawn.arrived(150.0)
    assert drawn.drawn_at == 158.0


def test_what_a_control_must_still_hold_falls_as_fast_as_it_could_draw() -> None:
    drawn = job()
    drawn.take(10)
    drawn.arrived(100.0)
    a_block_s = 8.0 / FASTEST
    assert [drawn.held_by_control(100 + a_block_s * blocks + 0.01) for blocks in (0, 1, 2)] == [10, 5, 0]


def test_what_cannot_be_held_is_proven() -> None:
    drawn = job()
    drawn.take(18)
    drawn.prove(bytes_held=5)
    assert drawn.proven == 2
    drawn.prove(bytes_held=9)
    assert drawn.proven == 2
    end = drawn.ended(Verdict.SILENT, "")
    assert (end.strokes_certain, end.strokes_possible) == (1, 2)


def test_a_closed_job_finishes_its_block_and_then_the_lines_of_the_end() -> None:
    drawn = job()
    drawn.take(7)
    drawn.close(["M30"])
    assert drawn.take(100) == b"X1\nM30\n"
    assert drawn.empty
    assert len(drawn) == 2
    drawn.arrived(100.0)
    assert drawn.drawn_at == 116.0
    drawn.prove(bytes_held=0)
    end = drawn.ended(Verdict.STOPPED, "", estimated=True)
    assert (end.strokes_certain, end.strokes_possible) == (1, 1)
