"""What holds for every conversation: chunks do not matter, noise does no harm, time never stands still."""

from __future__ import annotations

from itertools import pairwise

from hypothesis import example, given, settings
from hypothesis import strategies as st

from firmware_protocol.dobot.packet import Packet
from firmware_protocol.dobot.session import DobotSession
from firmware_protocol.dobot.simulator.arm import Build
from firmware_protocol.dobot.simulator.faults import CorruptReply, CorruptRequest, DelayReply, DropReply, StrayByte
from firmware_protocol.dobot.states import State
from firmware_protocol.session import Ended, Event, Verdict
from tests.firmware_protocol.dobot.bench import UP_MM, Bench, strokes
from tests.firmware_protocol.dobot.test_session_job import rounded, whole

LINES = strokes(2, segments=4)
WHOLE = whole(2, segments=4)
PACKETS = st.sampled_from(
    [
        Packet(10, 0, bytes(12) + b"\0\0\x48\x42" + bytes(16)),
        Packet(10, 0, bytes(32)),
        Packet(2, 0, b"\3\7\0"),
        Packet(20, 0, bytes(16)),
        Packet(20, 0, bytes(6) + b"\1" + bytes(9)),
        Packet(20, 1),
        Packet(240, 1),
        Packet(242, 1),
        Packet(245, 1),
        *(Packet(246, 0, index.to_bytes(8, "little")) for index in (0, 1, 2, 9, 2**64 - 1)),
        Packet(247, 0, (32).to_bytes(4, "little")),
        Packet(247, 0, (0).to_bytes(8, "little")),
        *(Packet(number, 3, index.to_bytes(8, "little")) for number in (84, 91) for index in (1, 2, 3)),
        Packet(84, 3, b"\1"),
    ]
)
SCRIPTS = st.lists(st.one_of(PACKETS.map(Packet.encode), st.binary(max_size=6)), max_size=25).map(b"".join)


def events_of(chunks: list[bytes]) -> list[Event]:
    bench = Bench().ready().start(LINES)
    return [event for chunk in chunks for event in bench.session.receive(chunk, bench.now)]


@settings(max_examples=60, deadline=None)
@given(SCRIPTS, st.lists(st.integers(0, 500), max_size=12))
def test_events_do_not_depend_on_how_bytes_are_chunked(script: bytes, places: list[int]) -> None:
    at = [0, *sorted(place % (len(script) + 1) for place in places), len(script)]
    assert events_of([script[start:end] for start, end in pairwise(at)]) == events_of([script])


@settings(max_examples=150, deadline=None)
@given(st.lists(st.one_of(SCRIPTS, st.floats(0.0, 3.0)), max_size=15), st.booleans())
def test_noise_raises_nothing_and_a_job_ends_at_most_once(course: list[bytes | float], started: bool) -> None:
    if started:
        bench = Bench().ready().start(LINES)
        session, now = bench.session, bench.now
    else:
        session, now = DobotSession(now=0.0, home=False, up_mm=UP_MM), 0.0
    events: list[Event] = []
    for step in course:
        if isinstance(step, bytes):
            events += session.receive(step, now)
        else:
            now += step
        events += session.expire(now)
        session.data_to_send(now)
        deadline = session.deadline()
        assert deadline is None or deadline > now or events
    assert sum(isinstance(event, Ended) for event in events) <= 1


@settings(max_examples=40, deadline=None)
@given(SCRIPTS)
def test_a_job_without_further_words_ends_by_itself(script: bytes) -> None:
    bench = Bench().ready().start(LINES)
    bench.session.receive(script, bench.now)
    bench.sim.dead = True
    bench.wait(30.0)
    assert bench.session.state is State.LOST


FAULTS = st.one_of(
    st.builds(DropReply, st.integers(0, 16), st.booleans()),
    st.builds(CorruptReply, st.integers(0, 16), st.booleans(), st.integers(1, 255)),
    st.builds(StrayByte, st.integers(0, 16), st.booleans()),
    st.builds(DelayReply, st.integers(0, 16), st.booleans(), st.floats(0.0, 1.5)),
    st.builds(CorruptRequest, st.integers(0, 20)),
)
BUILDS = st.builds(Build, first_index=st.integers(1, 3), left_holds_running=st.booleans(), clear_resets=st.booleans())


@settings(max_examples=100, deadline=None)
@given(st.lists(FAULTS, max_size=4), BUILDS)
@example([DropReply(0), DropReply(0), CorruptRequest(12), DelayReply(10, by_s=0.404581714)], Build())
@example([DropReply(1), DropReply(1), CorruptRequest(13), DelayReply(11, by_s=0.404581714)], Build())
def test_whatever_the_wire_does_finished_means_whole_and_the_truth_lies_within(
    faults: list[object], build: Build
) -> None:
    bench = Bench(arm={"faults": faults, "build": build})
    end = bench.draw(LINES)
    said_when_told = rounded(bench.sim.ink)
    bench.drain()
    drawn, wanted = rounded(bench.sim.ink), WHOLE
    complete = sum(line == full for line, full in zip(drawn, wanted, strict=False))
    assert end.strokes_certain <= complete
    assert len(drawn) <= end.strokes_possible
    if end.verdict is Verdict.FINISHED:
        assert said_when_told == wanted
