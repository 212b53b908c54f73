"""How far a job is, and what is said of the paper."""

from __future__ import annotations

from firmware_protocol.dobot.job import Job
from firmware_protocol.session import Verdict
from tests.firmware_protocol.dobot.bench import stroke


def job_with(taken: int, executed: int, *, in_flight: bool = False) -> Job:
    """Two strokes of four lines, so far on their way."""
    job = Job([*stroke(0, (200, 0), (210, 0)), *stroke(1, (200, 9), (210, 9))])
    for _ in range(taken):
        job.sends()
        job.takes()
    job.executes(executed)
    if in_flight:
        job.sends()
    job.doom(Verdict.SILENT, "the arm is gone", position_known=False)
    return job


def said(job: Job) -> tuple[int, int]:
    end = job.ended(lifted=False)
    return end.strokes_certain, end.strokes_possible


def test_what_waits_in_the_queue_may_be_drawn() -> None:
    assert said(job_with(taken=0, executed=0)) == (0, 0)
    assert said(job_with(taken=4, executed=3)) == (0, 1)
    assert said(job_with(taken=5, executed=4)) == (1, 2)


def test_a_line_without_acknowledgement_may_be_drawn_too() -> None:
    assert said(job_with(taken=4, executed=4)) == (1, 1)
    assert said(job_with(taken=4, executed=4, in_flight=True)) == (1, 2)


def test_an_emptied_queue_draws_nothing_more() -> None:
    job = job_with(taken=8, executed=2)
    job.stopped_behind(3)
    assert said(job) == (0, 1)


def test_the_stroke_that_was_fed_last_is_ended_before_a_pause() -> None:
    job = job_with(taken=2, executed=0, in_flight=True)
    job.stop_at_stroke_end()
    assert (job.stop_before, job.stroke(4)) == (4, 1)


def test_what_came_before_is_still_told() -> None:
    job = job_with(taken=1, executed=0)
    job.doom(Verdict.ALARM, "then an alarm", position_known=False)
    assert job.ended(lifted=False).why == "then an alarm; before that: the arm is gone"
