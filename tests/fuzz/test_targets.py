"""Every target takes its own seeds, and a session that breaks its promise is noticed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress

import pytest

from firmware_protocol.errors import LocalProtocolError
from firmware_protocol.session import Ended, Event, JobLine, Ready, Verdict
from firmware_protocol.session import Session as ASession
from tests.fuzz import targets
from tests.fuzz.conversations import Broken, Conversation, Line, conversation
from tests.fuzz.targets import ALLOWED, TARGETS


@pytest.mark.parametrize("name", TARGETS)
def test_a_target_takes_what_it_begins_from_and_noise(name: str) -> None:
    target = TARGETS[name]
    for seed in target.seeds():
        assert seed
        for data in (seed[:2000], seed[::-1][:300], b"", bytes(range(256))):
            with suppress(*ALLOWED):
                target.take(data)


@pytest.mark.parametrize(
    ("name", "session", "job"),
    [
        ("grbl session", targets._grbl, targets.GRBL_JOB),
        ("emco blocks", targets._blocks, targets.EMCO_JOB),
        ("emco xonxoff", targets._xonxoff, targets.EMCO_JOB),
        ("dobot session", targets._dobot, targets.DOBOT_JOB),
    ],
)
def test_a_seed_begins_a_job(name: str, session: Callable[[], ASession], job: Sequence[Line]) -> None:
    (seed,) = TARGETS[name].seeds()
    talk = Conversation(session(), job)
    talk.run(seed)
    assert (talk.started, len(talk.ends)) == (True, 1)


class Session:
    """Says what it is told to, and keeps no promise."""

    def __init__(self, *events: Event, deadline: float | None = None) -> None:
        self._events, self._deadline = [*events], deadline

    strokes_touched = strokes_certain = 0

    def receive(self, data: bytes, now: float) -> list[Event]:
        events, self._events = self._events, []
        return events

    def expire(self, now: float) -> list[Event]:
        return []

    def deadline(self) -> float | None:
        return self._deadline

    def data_to_send(self, now: float) -> bytes:
        return b""

    def start(self, job: Sequence[JobLine], now: float) -> None:
        if not job:
            raise LocalProtocolError("no job")

    def stop(self, now: float) -> None:
        pass

    def unplugged(self, now: float) -> list[Event]:
        return []


def ended(certain: int, possible: int) -> Ended:
    return Ended(Verdict.FINISHED, certain, possible, True, True, "drawn")


@pytest.mark.parametrize(
    ("session", "sentence"),
    [
        (Session(Ready("x", 9)), "ended 0 times"),
        (Session(Ready("x", 9), ended(1, 1), ended(1, 1)), "ended 2 times"),
        (Session(Ready("x", 9), ended(1, 0)), "of 1 strokes"),
        (Session(Ready("x", 9), ended(2, 2)), "of 1 strokes"),
        (Session(Ready("x", 9), ended(1, 1), deadline=0.0), "wants to be called"),
    ],
)
def test_a_broken_promise_is_noticed(session: Session, sentence: str) -> None:
    with pytest.raises(Broken, match=sentence):
        conversation(lambda: session, [Line("G0", 0)])(b"\x10\x00\xff\xffok")


def test_a_session_that_keeps_its_promise_passes() -> None:
    conversation(lambda: Session(Ready("x", 9), ended(1, 1)), [Line("G0", 0)])(b"\x10\x00\xff\xffok")
