"""Orders for the machine itself are obeyed by the drawing thread, between two drawings."""

from __future__ import annotations

import json
from pathlib import Path
from threading import Thread

import pytest

from daemon.config import GrblMachine
from daemon.control import MachineOrderName
from daemon.errors import LinedrawError
from daemon.jobs.moves import GrblMoves
from daemon.jobs.orders import MachineOrder, outline_mm
from firmware_protocol.session import Verdict
from tests.daemon.jobs.bench import Bench, fault

LIFT = ["G21 G90", "G0 Z5.000"]


def order(bench: Bench, name: MachineOrderName, **figures: float) -> str:
    """Given in another thread, as it is in the daemon, and obeyed by turns of this one."""
    said: list[str] = []

    def give() -> None:
        try:
            said.append(bench.runner.move(MachineOrder(name, **figures)))
        except LinedrawError as error:
            said.append(f"refused: {error}")

    giver = Thread(target=give)
    giver.start()
    while giver.is_alive():
        bench.drawing.turn()
        giver.join(0.001)
    return said[0]


@pytest.mark.parametrize(
    ("name", "figures", "program"),
    [
        ("park", {}, [*LIFT, "G0 X1.000 Y2.000"]),
        ("jog", {"x_mm": -3.0, "y_mm": 0.5}, [*LIFT, "G91 G0 X-3.000 Y0.500", "G90"]),
        ("pen up", {}, LIFT),
        ("pen down", {"seconds": 4.0}, [*LIFT, "G1 Z0.000 F600", "G4 P4.00"]),
        (
            "frame",
            {},
            [*LIFT, *(f"G0 X{x}.000 Y{y}.000" for x, y in [(0, 0), (10, 0), (10, 20), (0, 20), (0, 0)])],
        ),
    ],
)
def test_each_order_is_a_program_without_strokes(
    bench: Bench, name: MachineOrderName, figures: dict[str, float], program: list[str]
) -> None:
    assert not order(bench, name, **figures).startswith("refused")
    assert bench.machine.programs == [program]


def test_the_origin_is_where_the_pen_stands(bench: Bench) -> None:
    assert order(bench, "origin").startswith("the sheet's corner lies where the pen stands")
    assert bench.machine.corner_mm == (3.0, 4.0)


def test_the_machine_tells_who_it_is(bench: Bench) -> None:
    assert order(bench, "check") == "port: instant\nfirmware: Instant 1"


@pytest.mark.parametrize(("name", "still", "closed"), [("check", True, 1), ("pen up", True, 1), ("park", False, 0)])
def test_while_held_a_port_is_opened_for_an_order_and_homed_only_to_move(
    bench: Bench, name: MachineOrderName, still: bool, closed: int
) -> None:
    bench.runner.stop()
    assert not order(bench, name).startswith("refused")
    assert (bench.machine.opened, bench.machine.still, bench.machine.closed) == (1, still, closed)
    assert bench.station.held


def test_an_order_while_a_picture_is_drawn_is_refused_with_its_name(bench: Bench) -> None:
    refusals: list[str] = []

    def ask() -> None:
        with pytest.raises(LinedrawError) as refused:
            bench.runner.move(MachineOrder("park"))
        refusals.append(str(refused.value))

    bench.machine.while_drawing = ask
    bench.planned("cat.png")
    bench.drawing.turn()
    assert refusals == ["cat.png is being drawn: wait for its end, or say `linedrawd stop`"]
    assert bench.machine.drawn == 1
    bench.machine.while_drawing = lambda: None
    assert order(bench, "park") == "the pen is parked"


def test_a_move_that_fails_is_said_and_gives_the_port_back(bench: Bench) -> None:
    bench.machine.endings = [fault(Verdict.ALARM)]
    assert order(bench, "park") == "refused: alarm at line 7: look at it"
    assert bench.machine.closed == 1


def test_a_move_that_is_stopped_keeps_the_port(bench: Bench) -> None:
    bench.machine.endings = [fault(Verdict.REJECTED)]
    assert order(bench, "jog") == "refused: rejected at line 7: look at it"
    assert bench.machine.closed == 0


def test_orders_after_the_end_are_refused(bench: Bench) -> None:
    bench.drawing.end()
    with pytest.raises(LinedrawError, match="linedrawd is ending"):
        bench.runner.move(MachineOrder("park"))


def test_pause_and_resume_need_a_drawing(bench: Bench) -> None:
    with pytest.raises(LinedrawError, match="nothing is being drawn"):
        bench.runner.pause(at_once=False)
    bench.machine.while_drawing = lambda: print(bench.runner.pause(at_once=True), bench.runner.resume())
    bench.planned()
    bench.drawing.turn()
    assert any(words.startswith("paused before stroke 1, the pen is up") for words in bench.sayings())
    assert bench.states() == ["done"]


def test_a_machine_that_rests_takes_no_job_until_it_has_an_origin(bench: Bench) -> None:
    bench.drawing.turn()
    bench.machine.resting = "the motors are off: home the machine"
    bench.planned()
    bench.drawing.turn()
    why = "the motors are off: home the machine (`linedrawd machine home`, `linedrawd machine origin`)"
    assert (bench.states(), bench.words()) == (["waiting"], why)
    order(bench, "origin")
    assert bench.machine.closed == 1
    bench.drawing.turn()
    assert bench.states() == ["done"]


def test_a_homed_machine_has_its_origin_in_the_settings() -> None:
    homed = GrblMoves(GrblMachine(home="start"))
    assert [line.text for line in homed.home().lines] == ["$H"]
    with pytest.raises(LinedrawError, match=r"write origin_mm = \[3, 4.5\]"):
        homed.check_origin((3.0, 4.5, 0.0))
    with pytest.raises(LinedrawError, match="say home = 'start'"):
        GrblMoves(GrblMachine()).home()


def test_the_outline_of_a_job_is_in_machine_mm(tmp_path: Path) -> None:
    (tmp_path / "strokes.json").write_text(json.dumps({"strokes": [[[0, 0], [10, 4]], [[2, 20]]]}))
    (tmp_path / "report.json").write_text(json.dumps({"from_px": [[0.5, 0, 1], [0, -0.5, 30]]}))
    assert outline_mm(tmp_path) == [(1, 20), (6, 20), (6, 30), (1, 30)]
    (tmp_path / "report.json").unlink()
    with pytest.raises(LinedrawError, match="has no plan that can be read"):
        outline_mm(tmp_path)


def test_a_mistake_of_ours_answers_too(bench: Bench) -> None:
    def mistake() -> tuple[float, float, float]:
        raise KeyError("a mistake")

    bench.machine.position_mm = mistake  # type: ignore[method-assign]
    said: list[str] = []

    def give() -> None:
        with pytest.raises(LinedrawError) as refused:
            bench.runner.move(MachineOrder("origin"))
        said.append(str(refused.value))

    giver = Thread(target=give)
    giver.start()
    bench.wait_for(lambda: bench.drawing.asked._waiting)
    with pytest.raises(KeyError):
        bench.drawing.turn()
    giver.join(5)
    assert said == ["a mistake in linedrawd: please report it with linedrawd.log"]
