"""What is told of a machine is true, names it where there are several, and a button says that a new sheet is in."""

from __future__ import annotations

from pathlib import Path

import pytest

from daemon.errors import LinedrawError
from daemon.jobs.orders import MachineOrder
from daemon.jobs.pool import Pool
from daemon.jobs.station import Station
from firmware_protocol.session import Accepted, Paused
from tests.daemon.jobs.bench import Bench


def with_a_second_machine(bench: Bench) -> None:
    Station(bench.desk, "other", show=lambda **values: None, asks_for_sheets=False)


@pytest.mark.parametrize(("event", "state"), [(Accepted(1), "drawing"), (Paused(1), "paused")])
def test_go_during_a_drawing_shows_what_is_drawn(bench: Bench, event: Accepted | Paused, state: str) -> None:
    seen: list[tuple[str, str]] = []

    def drain_and_go() -> None:
        bench.machine.heard(event)
        for give in (bench.runner.drain, bench.runner.go):
            give()
            seen.append((bench.shown["state"], bench.shown["held"]))

    bench.machine.while_drawing = drain_and_go
    bench.planned()
    bench.drawing.turn()
    assert seen == [(state, "a person said drain: nothing more is begun"), (state, "")]
    assert (bench.shown["state"], bench.shown["words"]) == ("idle", "")


def test_how_a_pause_goes_on_is_shown_while_further_jobs_are_held(bench: Bench) -> None:
    seen: list[str] = []

    def pause_and_drain() -> None:
        bench.runner.pause(at_once=False)
        bench.runner.drain()
        seen.append(bench.shown["words"])

    bench.machine.while_drawing = pause_and_drain
    bench.planned()
    bench.drawing.turn()
    assert "`linedrawd resume` goes on" in seen[0]
    assert bench.shown["words"].startswith("no job starts until a person says `linedrawd go`")


def test_what_a_person_is_told_to_type_names_the_machine_where_there_are_several(bench: Bench) -> None:
    with_a_second_machine(bench)
    said: list[str] = []

    def pause() -> None:
        bench.runner.pause("plotter", at_once=False)
        said.append(bench.words())
        with pytest.raises(LinedrawError) as refused:
            bench.runner.move(MachineOrder("park"))
        said.append(str(refused.value))

    bench.machine.while_drawing = pause
    bench.planned()
    bench.drawing.turn()
    with pytest.raises(LinedrawError) as refused:
        bench.runner.resume("plotter")
    said.append(str(refused.value))
    bench.machine.resting = "the motors are off"
    bench.planned()
    bench.drawing.turn()
    said.append(bench.words())
    for words, orders in zip(
        said, [["resume", "stop"], ["stop"], ["stop"], ["machine home", "machine origin"]], strict=True
    ):
        assert all(f"`linedrawd {each} --machine plotter`" in words for each in orders), words


@pytest.mark.parametrize(
    ("asks", "before", "words"),
    [
        (False, lambda bench: None, "no sheet is ever waited for"),
        (True, lambda bench: None, "a new sheet is in already"),
        (True, lambda bench: (bench.planned(), bench.begun()), "a drawing is not over"),
    ],
)
def test_a_press_for_which_nothing_waits_changes_nothing_and_says_so(
    tmp_path: Path, shared_pool: Pool, asks: bool, before: object, words: str
) -> None:
    bench = Bench(tmp_path, asks_for_sheets=asks, pool=shared_pool)
    before(bench)  # type: ignore[operator]
    wanted = bench.station.wants_a_sheet
    bench.station.pressed()
    assert words in bench.sayings()[-1]
    assert (bench.station.wants_a_sheet, "a new sheet is in" in bench.sayings()) == (wanted, False)
    bench.journal.close()


def test_a_press_says_that_a_new_sheet_is_in_and_lets_nothing_go_that_is_held(
    tmp_path: Path, shared_pool: Pool
) -> None:
    bench = Bench(tmp_path, asks_for_sheets=True, pool=shared_pool)
    for name in ("a.png", "b.png"):
        bench.planned(name)
        bench.drawing.turn()
    assert bench.states() == ["done", "waiting"]
    bench.runner.drain()
    bench.station.pressed()
    bench.drawing.turn()
    assert (bench.states(), bench.station.wants_a_sheet) == (["done", "waiting"], False)
    assert bench.sayings()[-2:] == ["a new sheet is in", bench.shown["words"]]
    bench.runner.go()
    bench.drawing.turn()
    assert bench.states() == ["done", "done"]
    bench.journal.close()
