"""The clocks of a conversation."""

from __future__ import annotations

from firmware_protocol.grbl.watch import Watch


def watching(*, every_s: float = 0.2) -> Watch:
    watch = Watch(now=100.0, silent_after_s=5.0)
    watch.begin(100.0, every_s=every_s)
    return watch


def test_asks_at_once_and_then_every_so_often() -> None:
    watch = watching(every_s=0.5)
    assert [watch.ask(now) for now in (100.0, 100.25, 100.5)] == [b"?", b"", b"?"]


def test_silence_counts_from_the_first_question_without_an_answer() -> None:
    watch = watching()
    assert watch.silent_at is None
    watch.ask(100.0)
    watch.ask(104.0)
    assert watch.silent_at == 105.0
    watch.reported(105.0, idle_but_owing=False)
    assert watch.silent_at is None


def test_an_idle_controller_that_owes_answers_is_stuck_after_a_while() -> None:
    watch = watching()
    watch.reported(101.0, idle_but_owing=True)
    watch.reported(103.0, idle_but_owing=True)
    assert watch.stuck_at(dwell_s=1.0) == 107.0


def test_an_answer_or_motion_clears_the_doubt() -> None:
    watch = watching()
    watch.reported(101.0, idle_but_owing=True)
    watch.answered()
    assert watch.stuck_at(dwell_s=0.0) is None
    watch.reported(102.0, idle_but_owing=True)
    watch.reported(103.0, idle_but_owing=False)
    assert watch.stuck_at(dwell_s=0.0) is None


def test_wants_to_be_called_for_the_next_question() -> None:
    watch = watching(every_s=8.0)
    assert watch.ask_at == 100.0
    watch.ask(100.0)
    assert watch.ask_at == 108.0
