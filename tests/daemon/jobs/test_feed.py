"""The feed of a running drawing; and what a `go` may hurry, and what it may not."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from daemon.errors import LinedrawError, MachineFault, NoMachine
from daemon.jobs.orders import MachineOrder
from tests.daemon.jobs.bench import Bench


def test_a_running_drawing_gets_another_feed_and_the_next_one_does_not(bench: Bench) -> None:
    bench.planned()
    shown: list[int] = []

    def slower() -> None:
        assert bench.runner.feed(percent=80) == "the rest of this drawing is drawn at 80 % of its speed"
        shown.append(bench.shown["feed_percent"])

    bench.machine.while_drawing = slower
    bench.drawing.turn()
    assert (bench.machine.feeds, shown, bench.shown["feed_percent"]) == ([80], [80], 100)


def test_without_a_drawing_there_is_no_feed_to_change(bench: Bench) -> None:
    bench.drawing.turn()
    with pytest.raises(LinedrawError, match="nothing is being drawn: draw_mm_s in the settings"):
        bench.runner.feed(percent=80)
    assert bench.machine.feeds == []


@pytest.mark.parametrize(
    "says",
    [lambda after: after.runner.go(), lambda after: after.drawing.obey(MachineOrder("park"))],
    ids=["go", "park"],
)
def test_a_pen_that_was_left_down_is_lifted_whatever_is_said_first(
    bench: Bench, says: Callable[[Bench], object]
) -> None:
    bench.planned("a.png")
    bench.planned("b.png")
    bench.begun()
    after = bench.restarted()
    says(after)
    after.drawing.turn()
    assert after.sayings().count("the last drawing was cut off: the pen has been lifted, and nothing else moves") == 1
    assert (after.machine.lifted, after.machine.opened, after.machine.drawn) == (1, 2, 1)
    after.journal.close()


def test_no_order_moves_a_machine_whose_pen_may_be_down(bench: Bench) -> None:
    bench.planned()
    bench.begun()
    after = bench.restarted()
    after.machine.missing = NoMachine("no adapter: plug it in")
    with pytest.raises(LinedrawError, match="may still be down since the last drawing was cut off: no adapter"):
        after.drawing.obey(MachineOrder("park"))
    after.journal.close()


def test_a_go_looks_for_the_machine_at_once(bench: Bench) -> None:
    bench.machine.missing = MachineFault("the controller is locked: unlock it")
    assert bench.drawing.turn() == 30.0
    bench.machine.missing = None
    assert bench.drawing.turn() == 30.0
    bench.runner.go()
    bench.drawing.turn()
    assert bench.machine.opened == 1
