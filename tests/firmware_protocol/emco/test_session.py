"""A plain serial transfer: when it begins, how fast it goes, what holds it, and how it ends."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pytest

from firmware_protocol.emco.session import Control, XonXoffSession
from firmware_protocol.emco.states import State
from firmware_protocol.errors import LocalProtocolError
from firmware_protocol.session import Ended, Event, NotReady, Ready, Sent, Verdict, Waiting
from tests.firmware_protocol.emco.bench import Line

XON, XOFF = b"\x11", b"\x13"
LIFT = ("G0 Z5.0", "M30")
JOB = [Line("%"), *(Line(f"G1 X{x}.0", x // 2) for x in range(8)), Line("M30")]


def ten_seconds_a_line(texts: Sequence[str]) -> list[float]:
    return [10.0 * number for number in range(1, len(texts) + 1)]


class Play:
    """A session, its clock, and all that it has said and told so far."""

    def __init__(self, **options: Any) -> None:
        self.now = 100.0
        usual: dict[str, Any] = {"bytes_per_s": 10.0, "times": ten_seconds_a_line}
        self.session = XonXoffSession(now=self.now, **(usual | options))
        self.events: list[Event] = []
        self.sent = b""

    def start(self, lines: Sequence[Line] = JOB) -> bytes:
        self.session.start(lines, self.now)
        return self.turn()

    def hear(self, data: bytes) -> bytes:
        self.events += self.session.receive(data, self.now)
        return self.turn()

    def turn(self) -> bytes:
        self.events += self.session.expire(self.now)
        data = self.session.data_to_send(self.now)
        self.sent += data
        return data

    def wait(self, seconds: float) -> bytes:
        """Time passes as the loop lets it: from one deadline to the next; returns what was sent meanwhile."""
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


def running(**options: Any) -> Play:
    """A job whose first chunk has been sent."""
    play = Play(**options)
    play.start()
    play.hear(XON)
    play.events.clear()
    return play


def test_it_is_ready_at_once_for_nothing_introduces_itself() -> None:
    play = Play()
    play.turn()
    assert [type(event) for event in play.events] == [Ready]


def test_nothing_is_sent_before_the_first_xon() -> None:
    play = Play()
    assert play.start() == b""
    assert play.wait(1000) == b""
    assert isinstance(play.events[-1], Waiting)
    assert play.hear(XON) != b""


def test_an_xon_from_before_the_job_is_enough() -> None:
    play = Play()
    play.hear(XON)
    assert play.start() != b""


def test_an_xoff_behind_it_takes_it_back() -> None:
    play = Play()
    play.hear(XON + XOFF)
    assert play.start() == b""


def test_where_no_xon_is_awaited_the_job_begins_at_once() -> None:
    assert Play(wait_for_xon=False).start() != b""


def test_chunks_are_short_and_as_fast_as_the_line() -> None:
    play = running(chunk_bytes=16)
    assert len(play.sent) == 16
    assert play.wait(1.59) == b""
    assert len(play.wait(0.02)) == 16


def test_the_whole_program_is_sent_with_its_line_ends() -> None:
    play = running()
    play.wait(100)
    assert play.sent == b"".join(line.text.encode() + b"\n" for line in JOB)


def test_nothing_is_sent_between_xoff_and_xon() -> None:
    play = running()
    play.hear(XOFF)
    assert play.wait(200) == b""
    assert play.hear(XON) != b""


def test_an_xoff_that_lasts_too_long_ends_the_job() -> None:
    play = running(xoff_limit_s=300.0)
    play.hear(XOFF)
    play.wait(299)
    assert play.events == []
    play.wait(1)
    assert (play.ended.verdict, play.session.state) == (Verdict.SILENT, State.LOST)
    assert "XOFF for 300 s" in play.ended.why
    assert play.hear(XON) == b""


def test_a_repeated_xoff_does_not_prolong_the_wait() -> None:
    play = running(xoff_limit_s=300.0)
    play.hear(XOFF)
    play.wait(200)
    play.hear(XOFF)
    play.wait(100)
    assert play.ended.verdict is Verdict.SILENT


def test_sent_comes_when_the_last_byte_is_out_and_the_end_by_the_time_model() -> None:
    play = running()
    play.wait(len(b"".join(line.text.encode() + b"\n" for line in JOB)) / 10 + 0.01)
    (sent,) = play.events
    assert isinstance(sent, Sent)
    assert 80 < sent.drawn_in_s < 110
    play.wait(sent.drawn_in_s - 0.1)
    assert len(play.events) == 1
    play.wait(0.2)
    end = play.ended
    assert (end.verdict, end.strokes_certain, end.strokes_possible, end.estimated) == (Verdict.FINISHED, 0, 4, True)
    assert play.session.state is State.READY


def test_an_xoff_behind_the_last_byte_changes_nothing() -> None:
    play = running()
    play.wait(20)
    play.hear(XOFF)
    play.wait(400)
    assert play.ended.verdict is Verdict.FINISHED


def test_the_next_job_waits_for_the_next_start() -> None:
    play = running()
    play.wait(20)
    play.hear(XON)
    play.wait(400)
    play.events.clear()
    assert play.start() == b""
    assert play.hear(XON) != b""


def test_one_start_is_for_one_job() -> None:
    play = Play()
    play.hear(XON)
    play.start()
    play.wait(400)
    assert play.start() == b""


def test_seven_bits_have_even_parity_both_ways() -> None:
    play = Play(seven_bit=True)
    play.start([Line("%"), Line("M30")])
    assert play.hear(b"\x11") == b"\xa5\x0a\x4d\x33\x30\x0a"
    play = running(seven_bit=True)
    play.hear(b"\x93")
    assert play.session.state is State.HELD


def test_unplugging_ends_the_job() -> None:
    play = running()
    assert [type(event) for event in play.session.unplugged(play.now)] == [Ended]
    with pytest.raises(LocalProtocolError, match="open the port again"):
        play.session.start(JOB, play.now)


def test_unplugging_between_jobs_is_told_too() -> None:
    play = Play()
    play.turn()
    assert [type(event) for event in play.session.unplugged(play.now)] == [NotReady]


def test_a_control_that_takes_more_than_it_holds_is_deaf() -> None:
    play = running(control=Control(holds_bytes=20))
    play.wait(10)
    assert play.ended.verdict is Verdict.SILENT
    assert "no longer reads" in play.ended.why


def test_an_xon_proves_what_must_have_been_drawn() -> None:
    quick = {"times": lambda texts: [0.01 * n for n in range(1, len(texts) + 1)], "chunk_bytes": 1}
    play = running(control=Control(holds_bytes=20), **quick)
    play.wait(6.8)
    play.hear(XOFF)
    play.session.stop(play.now)
    play.turn()
    # 69 bytes are out, of which 20 may be held and 2 be on the wire: 2 + 5 lines of 8 bytes are surely drawn.
    assert (play.ended.strokes_certain, play.ended.strokes_possible) == (2, 4)


def test_two_jobs_at_once_are_refused() -> None:
    play = running()
    with pytest.raises(LocalProtocolError, match="takes no job now"):
        play.session.start(JOB, play.now)


@pytest.mark.parametrize("text", ["G1 X1\x11", "G1 Ä", "G1\nX1"])
def test_a_line_that_would_steer_the_link_is_refused(text: str) -> None:
    with pytest.raises(LocalProtocolError, match="no plain text"):
        Play().start([Line(text)])
    with pytest.raises(LocalProtocolError, match="no plain text"):
        Play(control=Control(on_stop=(text,)))


def test_a_program_without_times_is_refused() -> None:
    with pytest.raises(LocalProtocolError, match="time model"):
        Play(times=lambda texts: []).start()


@pytest.mark.parametrize("options", [{"bytes_per_s": 0}, {"chunk_bytes": 0}])
def test_a_speed_of_nothing_is_refused(options: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="above 0"):
        Play(**options)


def test_an_empty_job_ends_by_itself() -> None:
    play = Play(wait_for_xon=False)
    play.start([])
    play.wait(10)
    assert play.ended.verdict is Verdict.FINISHED
