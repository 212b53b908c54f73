"""What holds for every conversation: chunks do not matter, noise does no harm, time never stands still."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_protocol.emco.session import BlockSession, Control, XonXoffSession
from firmware_protocol.session import Ended, Event
from tests.firmware_protocol.emco.test_session import JOB, LIFT, ten_seconds_a_line

Maker = Callable[[], Any]


def xonxoff() -> XonXoffSession:
    return XonXoffSession(
        now=0.0, bytes_per_s=10.0, times=ten_seconds_a_line, xoff_limit_s=30, control=Control(LIFT, holds_bytes=60)
    )


def blocks() -> BlockSession:
    return BlockSession(now=0.0, times=ten_seconds_a_line, ack=b"ok", control=Control(LIFT, holds_blocks=2))


both = pytest.mark.parametrize("make", [xonxoff, blocks])
words = st.sampled_from([b"\x11", b"\x13", b"\x06", b"\x15", b"ok\r\n", b"ok", b"\r\n", b"error\n"])
scripts = st.lists(words | st.binary(max_size=4), max_size=20).map(b"".join)
courses = st.lists(scripts | st.floats(0.0, 40.0), max_size=15)


@both
@given(script=scripts, cuts=st.lists(st.integers(0, 200), max_size=8))
def test_events_do_not_depend_on_how_bytes_are_chunked(make: Maker, script: bytes, cuts: list[int]) -> None:
    def events_of(chunks: list[bytes]) -> list[Event]:
        session = make()
        session.start(JOB, 0.0)
        session.data_to_send(0.0)
        return [event for chunk in chunks for event in session.receive(chunk, 1.0)]

    places = [0, *sorted(cut % (len(script) + 1) for cut in cuts), len(script)]
    assert events_of([script[a:b] for a, b in pairwise(places)]) == events_of([script])


@both
@given(course=courses, stop_at=st.integers(0, 15))
def test_noise_raises_nothing_and_a_job_ends_once_at_most(
    make: Maker, course: list[bytes | float], stop_at: int
) -> None:
    session, now, events = make(), 0.0, list[Event]()
    session.start(JOB, now)
    for index, step in enumerate(course):
        if index == stop_at:
            session.stop(now)
        if isinstance(step, bytes):
            events += session.receive(step, now)
        else:
            now += step
        events += session.expire(now)
        session.data_to_send(now)
    assert sum(isinstance(event, Ended) for event in events) <= 1


@both
@given(course=courses, stop_at=st.integers(0, 15))
def test_a_deadline_that_was_served_lies_ahead(make: Maker, course: list[bytes | float], stop_at: int) -> None:
    session, now = make(), 0.0
    session.start(JOB, now)
    for index, step in enumerate(course):
        if index == stop_at:
            session.stop(now)
        if isinstance(step, bytes):
            session.receive(step, now)
        else:
            now += step
        session.expire(now)
        session.data_to_send(now)
        deadline = session.deadline()
        assert deadline is None or deadline > now


@both
@given(script=scripts)
def test_a_stopped_job_ends_within_half_a_minute(make: Maker, script: bytes) -> None:
    session, now = make(), 0.0
    session.start(JOB, now)
    session.data_to_send(now)
    events = session.receive(script, now)
    session.stop(now)
    while now < 30.0 and not any(isinstance(event, Ended) for event in events):
        events += session.expire(now)
        session.data_to_send(now)
        deadline = session.deadline()
        now = 30.0 if deadline is None else max(now, deadline)
    assert sum(isinstance(event, Ended) for event in events) == 1
