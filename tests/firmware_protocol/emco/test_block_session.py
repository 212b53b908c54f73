"""Acknowledged blocks: one at a time, again when refused, and an end when no answer comes."""

from __future__ import annotations

from typing import Any

import pytest

from firmware_protocol.emco.session import BlockSession, Control
from firmware_protocol.emco.states import State
from firmware_protocol.session import Accepted, Ended, Event, Ready, Sent, Verdict
from tests.firmware_protocol.emco.bench import Line
from tests.firmware_protocol.emco.test_session import JOB, LIFT, ten_seconds_a_line

ACK, NAK = b"\x06", b"\x15"


class Play:
    """A session that has begun a job, its clock, and what it has told."""

    def __init__(self, *, lines: list[Line] = JOB, **options: Any) -> None:
        self.now = 100.0
        self.session = BlockSession(now=self.now, **({"times": ten_seconds_a_line} | options))
        self.session.start(lines, self.now)
        self.events: list[Event] = []
        self.first = self.turn()

    def hear(self, data: bytes) -> bytes:
        self.events += self.session.receive(data, self.now)
        return self.turn()

    def turn(self) -> bytes:
        self.events += self.session.expire(self.now)
        return self.session.data_to_send(self.now)

    def wait(self, seconds: float) -> bytes:
        until, sent = self.now + seconds, self.turn()
        while self.now < until:
            deadline = self.session.deadline()
            self.now = until if deadline is None else min(until, max(self.now, deadline))
            sent += self.turn()
        return sent

    @property
    def ended(self) -> Ended:
        (end,) = [event for event in self.events if isinstance(event, Ended)]
        return end


def test_the_next_block_comes_with_the_answer_to_the_one_before() -> None:
    play = Play()
    assert play.first == b"%\n"
    assert play.wait(5) == b""
    assert play.hear(ACK) == b"G1 X0.0\n"
    assert play.events == [Ready("control without a name (acknowledged blocks)", 0), Accepted(0)]


def test_text_can_be_the_answer() -> None:
    play = Play(ack=b"ok", nak=b"error")
    assert play.hear(b"o") == b""
    assert play.hear(b"k\r\n") == b"G1 X0.0\n"
    assert play.hear(b"error\r\n") == b"G1 X0.0\n"


def test_a_refused_block_is_sent_again_three_times() -> None:
    play = Play()
    assert [play.hear(NAK) for _ in range(3)] == [b"%\n"] * 3
    assert play.hear(NAK) == b""
    assert (play.ended.verdict, play.session.state) == (Verdict.REJECTED, State.LOST)
    assert "block 1 ('%') 4 times" in play.ended.why


def test_refusals_are_counted_for_each_block() -> None:
    play = Play(retries=1)
    for _ in range(4):
        play.hear(NAK)
        play.hear(ACK)
    assert not any(isinstance(event, Ended) for event in play.events)


def test_two_refusals_in_one_chunk_are_one_repetition() -> None:
    play = Play()
    assert play.hear(NAK + NAK) == b"%\n"


def test_an_answer_that_does_not_come_ends_the_job_and_nothing_is_repeated() -> None:
    play = Play(answer_within_s=10.0, times=lambda texts: [0.0] * len(texts))
    play.hear(ACK)
    play.hear(b"alarm 12\r\n")
    assert play.wait(9.9) == b""
    assert not any(isinstance(event, Ended) for event in play.events)
    assert play.wait(0.2) == b""
    assert play.ended.verdict is Verdict.SILENT
    assert "block 2 ('G1 X0.0') within 10 s (it said 'alarm 12')" in play.ended.why


def test_an_answer_may_come_after_the_motion_of_the_block() -> None:
    play = Play(answer_within_s=10.0)
    play.wait(19.9)
    assert play.hear(ACK) == b"G1 X0.0\n"
    # The first block may take 10 s from its answer on, the second 10 s more.
    play.wait(29.9)
    assert not any(isinstance(event, Ended) for event in play.events)
    play.wait(0.2)
    assert play.ended.verdict is Verdict.SILENT


def test_sent_comes_with_the_last_answer_and_the_end_by_the_time_model() -> None:
    play = Play()
    for _ in JOB:
        play.hear(ACK)
    assert isinstance(play.events[-1], Sent)
    assert play.wait(90) == b""
    play.wait(20)
    end = play.ended
    assert (end.verdict, end.strokes_certain, end.strokes_possible, end.estimated) == (Verdict.FINISHED, 0, 4, True)
    assert [event.line for event in play.events if isinstance(event, Accepted)] == list(range(len(JOB)))


def test_an_answer_that_nobody_owes_is_passed_over() -> None:
    play = Play()
    assert play.hear(ACK + ACK) == b"G1 X0.0\n"
    assert [event.line for event in play.events if isinstance(event, Accepted)] == [0]


def test_a_stop_waits_for_its_answer_lifts_and_ends_the_program() -> None:
    play = Play(control=Control(on_stop=LIFT), times=lambda texts: [0.1] * len(texts))
    play.hear(ACK)
    play.session.stop(play.now)
    assert play.turn() == b""
    assert play.hear(ACK) == b"G0 Z5.0\n"
    assert play.hear(ACK) == b"M30\n"
    play.hear(ACK)
    play.wait(10)
    end = play.ended
    assert (end.verdict, end.strokes_possible, end.pen_lifted, end.estimated) == (Verdict.STOPPED, 1, True, True)
    assert [event.line for event in play.events if isinstance(event, Accepted)] == [0, 1]


def test_a_stop_without_answer_is_told_in_time() -> None:
    play = Play(control=Control(on_stop=LIFT))
    play.session.stop(play.now)
    play.wait(26)
    assert (play.ended.verdict, play.ended.pen_lifted) == (Verdict.STOPPED, False)


def test_acknowledged_blocks_that_cannot_be_held_any_more_are_drawn() -> None:
    play = Play(control=Control(holds_blocks=2))
    for _ in range(7):
        play.hear(ACK)
    play.session.stop(play.now)
    play.turn()
    assert (play.ended.strokes_certain, play.ended.strokes_possible) == (2, 4)


def test_unplugging_ends_the_job() -> None:
    play = Play()
    assert [type(event) for event in play.session.unplugged(play.now)] == [Ended]


def test_an_empty_job_ends_by_itself() -> None:
    play = Play(lines=[])
    play.wait(10)
    assert play.ended.verdict is Verdict.FINISHED


@pytest.mark.parametrize("ack", [b"", b"\x15"])
def test_answers_that_cannot_be_told_apart_are_refused(ack: bytes) -> None:
    with pytest.raises(ValueError, match="told apart"):
        Play(ack=ack)
