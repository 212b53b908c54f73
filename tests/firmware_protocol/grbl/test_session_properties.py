"""What holds for every conversation: chunks do not matter, noise does no harm, time never stands still."""

from __future__ import annotations

import contextlib
import math
from itertools import pairwise

from hypothesis import given, settings
from hypothesis import strategies as st

from firmware_protocol.errors import LocalProtocolError
from firmware_protocol.grbl.states import State
from firmware_protocol.session import Ended, Event
from tests.firmware_protocol.grbl.driver import ALARM, BANNER, HELD, IDLE, LIFT, RUN, Play, ready, two_strokes

LINES = st.sampled_from(
    [
        "",
        "ok",
        "ok",
        "ok",
        "error:20",
        "ALARM:1",
        BANNER,
        IDLE,
        RUN,
        HELD,
        ALARM,
        "[MSG:'$H'|'$X' to unlock]",
        "<Run",
        "x",
    ]
)
SCRIPTS = st.lists(LINES, max_size=20).map(lambda lines: "".join(f"{line}\r\n" for line in lines).encode())


def events_of(chunks: list[bytes]) -> list[Event]:
    play = ready(lift=LIFT)
    play.start(*two_strokes())
    for chunk in chunks:
        play.events += play.session.receive(chunk, play.now)
    return play.events


def cut(data: bytes, places: list[int]) -> list[bytes]:
    at = [0, *sorted(place % (len(data) + 1) for place in places), len(data)]
    return [data[start:end] for start, end in pairwise(at)]


@given(SCRIPTS, st.lists(st.integers(0, 500), max_size=12))
def test_events_do_not_depend_on_how_bytes_are_chunked(script: bytes, places: list[int]) -> None:
    assert events_of(cut(script, places)) == events_of([script])


@settings(max_examples=200)
@given(st.lists(st.one_of(st.binary(max_size=40), SCRIPTS, st.floats(0.0, 7.0)), max_size=12), st.booleans())
def test_noise_raises_nothing_and_a_job_ends_at_most_once(course: list[bytes | float], started: bool) -> None:
    play = ready(lift=LIFT) if started else Play(lift=LIFT)
    if started:
        play.start(*two_strokes())
    for step in course:
        if isinstance(step, bytes):
            play.hear(step)
        else:
            play.wait(step)
    assert sum(isinstance(event, Ended) for event in play.events) <= 1


@given(st.lists(st.one_of(SCRIPTS, st.floats(0.0, 7.0)), max_size=12), st.booleans())
def test_a_deadline_that_was_served_lies_ahead(course: list[bytes | float], stopped: bool) -> None:
    play = ready(lift=LIFT)
    play.start(*two_strokes())
    if stopped:
        play.stop()
    for step in course:
        if isinstance(step, bytes):
            play.hear(step)
        else:
            play.now += step
        play.session.expire(play.now)
        play.send()
        deadline = play.session.deadline()
        assert deadline is None or deadline > play.now


@given(SCRIPTS)
def test_a_job_without_further_words_ends_by_itself(script: bytes) -> None:
    play = ready(lift=LIFT)
    play.start(*two_strokes())
    play.hear(script)
    play.wait(30.0)
    assert play.session.state is State.LOST


WISHES = {
    "stop": lambda play: play.stop(),
    "pause": lambda play: play.session.pause(play.now),
    "halt": lambda play: play.session.pause(play.now, at_once=True),
    "resume": lambda play: play.session.resume(play.now),
    "home": lambda play: play.session.home(play.now),
    "origin": lambda play: play.session.set_origin(play.now),
    "faster": lambda play: play.session.set_feed_percent(150, play.now),
    "start": lambda play: play.start(*two_strokes()),
    "unplug": lambda play: play.events.extend(play.session.unplugged(play.now)),
}
MORE = st.sampled_from(
    ["$1=25", "$10=1", "<Hold:0>", "<Check>", "<Door:1>", "<Idle|Bf:0,100|Ov:50,100,100>", "<Run|Ln:3>"]
)


@settings(max_examples=300)
@given(
    st.lists(
        st.one_of(SCRIPTS, st.lists(MORE, max_size=4), st.floats(0.0, 7.0), st.sampled_from(sorted(WISHES))),
        max_size=30,
    ),
    st.booleans(),
    st.booleans(),
)
def test_whatever_is_wished_and_said_nothing_raises_but_what_is_not_allowed_now(
    course: list[bytes | list[str] | float | str], may_set: bool, dry_run: bool
) -> None:
    play = ready(lift=LIFT, may_set=may_set, dry_run=dry_run, motors_off_after_min=0.1)
    jobs = 0
    for step in course:
        if isinstance(step, bytes):
            play.hear(step)
        elif isinstance(step, list):
            play.say(*step)
        elif isinstance(step, float):
            play.wait(step)
        else:
            with contextlib.suppress(LocalProtocolError):
                WISHES[step](play)
                jobs += step == "start"
        deadline = play.session.deadline()
        assert deadline is None or math.isfinite(deadline)
    assert b"$X" not in play.sent
    assert sum(isinstance(event, Ended) for event in play.events) <= jobs
