"""What a person asks of the machine between two drawings."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from dataclasses import dataclass
from pathlib import Path
from threading import Lock

from daemon.control import MachineOrderName
from daemon.errors import LinedrawError, MachineFault
from daemon.jobs.moves import Moves, PointMm
from daemon.jobs.open_machine import OpenMachine
from daemon.shapes import Program
from firmware_protocol.session import Ended, Verdict

WITHOUT_MOTION: frozenset[MachineOrderName] = frozenset({"check", "pen up"})
"""These open the port without homing, and close it again where it was closed."""


@dataclass(frozen=True, slots=True)
class MachineOrder:
    """x_mm, y_mm: of a jog. seconds: that the pen stays down. job: whose frame; "" for the next one."""

    name: MachineOrderName
    x_mm: float = 0.0
    y_mm: float = 0.0
    seconds: float = 10.0
    job: str = ""


@dataclass(frozen=True, slots=True)
class Places:
    """Where the orders lead: the park position, the corners of a job's drawing ("": of the next one), and the program
    that comes next (one without lines where none does). homes: the machine knows its origin whenever it is opened.
    """

    park_mm: PointMm
    frame_mm: Callable[[str], Sequence[PointMm]]
    next_program: Callable[[], Program]
    homes: bool = False
    counts_from_home: bool = False
    """Homed, it knows its origin; otherwise that is where a person has put the pen."""


def obey(order: MachineOrder, machine: OpenMachine, moves: Moves, places: Places) -> str:
    """Do it, and say what was done. Raises LinedrawError where it cannot be done, MachineFault where it failed."""
    match order.name:
        case "check":
            return "\n".join(machine.check(places.next_program()))
        case "origin":
            return _origin(machine, moves)
        case "home":
            return _told(machine.home(moves.home()), "the machine is homed")
        case _:
            program, done = _motion(order, machine, moves, places)
            return _moved(machine, program, done)


def _origin(machine: OpenMachine, moves: Moves) -> str:
    at_mm = machine.position_mm()
    if at_mm is None:
        raise LinedrawError(f"{machine.name} does not say where its pen stands: set the origin at its control")
    moves.check_origin(at_mm)
    machine.count_from((at_mm[0], at_mm[1]))
    return "the sheet's corner lies where the pen stands, until the port is closed"


def _motion(order: MachineOrder, machine: OpenMachine, moves: Moves, places: Places) -> tuple[Program, str]:
    """What is sent, and what has been done then."""
    match order.name:
        case "park":
            return moves.travel([places.park_mm]), "the pen is parked"
        case "frame":
            corners = places.frame_mm(order.job)
            return moves.travel([*corners, corners[0]]), f"the pen has gone around {_rectangle(corners)}"
        case "pen up":
            return moves.pen_up(machine.position_mm()), "the pen is up"
        case "pen down":
            done = f"the pen was down for {order.seconds:g} s and is up again"
            return moves.pen_down(order.seconds, machine.position_mm()), done
    by_mm = (order.x_mm, order.y_mm)
    return moves.jog(by_mm, machine.position_mm()), f"the pen has moved by {by_mm[0]:g}, {by_mm[1]:g} mm"


def _moved(machine: OpenMachine, program: Program, done: str) -> str:
    ended = machine.draw(program)
    machine.take_ink()
    return _told(ended, done)


def _told(ended: Ended, done: str) -> str:
    if ended.verdict is Verdict.FINISHED:
        return done
    kept = ended.position_known and ended.verdict in (Verdict.STOPPED, Verdict.REJECTED)
    raise LinedrawError(ended.why) if kept else MachineFault(ended.why)


def _rectangle(corners: Sequence[PointMm]) -> str:
    (left, bottom), (right, top) = corners[0], corners[2]
    return f"x {left:.1f} to {right:.1f}, y {bottom:.1f} to {top:.1f} mm"


def outline_mm(folder: Path) -> Sequence[PointMm]:
    """The corners around a planned job's drawing, counterclockwise from the lower left.

    Raises LinedrawError when the folder holds no plan.
    """
    try:
        strokes = json.loads((folder / "strokes.json").read_text(encoding="utf-8"))["strokes"]
        (a, b, c), (d, e, f) = json.loads((folder / "report.json").read_text(encoding="utf-8"))["from_px"]
        points = [(a * x + b * y + c, d * x + e * y + f) for stroke in strokes for x, y in stroke]
        xs, ys = zip(*points, strict=True)
    except (OSError, ValueError, KeyError) as error:
        raise LinedrawError(f"{folder.name} has no plan that can be read ({error}): wait until it is planned") from None
    return rectangle_mm((min(xs), min(ys)), (max(xs), max(ys)))


def rectangle_mm(low_mm: PointMm, high_mm: PointMm) -> Sequence[PointMm]:
    """Its corners, counterclockwise from the lower left."""
    return [low_mm, (high_mm[0], low_mm[1]), high_mm, (low_mm[0], high_mm[1])]


class Asked:
    """Orders on their way from other threads to the one that draws, which alone speaks to the machine."""

    def __init__(self, wake: Callable[[], None]) -> None:
        self._wake, self._lock = wake, Lock()
        self._waiting: list[tuple[MachineOrder, Future[str]]] = []
        self._refusal = ""

    def ask(self, order: MachineOrder) -> str:
        """Wait until it has been obeyed. Raises LinedrawError when it is refused or fails."""
        answer: Future[str] = Future()
        with self._lock:
            if self._refusal:
                raise LinedrawError(self._refusal)
            self._waiting.append((order, answer))
        self._wake()
        return answer.result()

    def obey_next(self, do: Callable[[MachineOrder], str]) -> bool:
        """Obey the one that has waited longest. False when none waits."""
        with self._lock:
            order, answer = self._waiting.pop(0) if self._waiting else (None, None)
        if order is None or answer is None:
            return False
        try:
            answer.set_result(do(order))
        except LinedrawError as error:
            answer.set_exception(error)
        except BaseException:
            answer.set_exception(LinedrawError("a mistake in linedrawd: please report it with linedrawd.log"))
            raise
        return True

    def refuse(self, words: str) -> None:
        """Those that wait and those that come are refused with these words, until `accept`."""
        with self._lock:
            self._refusal, waiting, self._waiting = words, self._waiting, []
        for _, answer in waiting:
            answer.set_exception(LinedrawError(words))

    def accept(self) -> None:
        with self._lock:
            self._refusal = ""
